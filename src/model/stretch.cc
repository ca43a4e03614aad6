#include "trilobe/model/stretch.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// At theta_d = 90 degrees there is no highlight; avoids infinite factors.
constexpr double kMinCosine = 1e-4;

}  // namespace

Stretch::Place::Place(const Cosines& cosines)
    : log_cosine(std::log(std::max(cosines.theta_d, kMinCosine))),
      cos2_phi(cosines.phi_d * cosines.phi_d) {}

double Stretch::Factor(const Place& place) const {
  if (!any()) return 1;
  const double along2 = std::exp(2 * along * place.log_cosine);
  const double across2 = std::exp(2 * across * place.log_cosine);
  return std::sqrt(place.cos2_phi * along2 + (1 - place.cos2_phi) * across2);
}

double Stretch::ThetaH(double theta_h, const Place& place) const {
  return any() ? std::min(theta_h * Factor(place), kPi / 2) : theta_h;
}

void CheckStretch(const Stretch& stretch) {
  for (const double exponent : {stretch.along, stretch.across}) {
    if (exponent >= -kMaxStretch && exponent <= kMaxStretch) continue;
    std::ostringstream message;
    message << "a stretch of highlights by the exponent " << exponent << "; it must be from "
            << -kMaxStretch << " to " << kMaxStretch;
    throw Error(ErrorKind::kRange, message.str()).About("stretch", exponent);
  }
}

Stretches::Stretches(const Stretch& of_all) : distinct_({of_all}) {}

Stretches::Stretches(const std::vector<Stretch>& of_lobes) {
  for (const Stretch& stretch : of_lobes) {
    const auto known = std::ranges::find(distinct_, stretch);
    index_.push_back(static_cast<int>(known - distinct_.begin()));
    if (known == distinct_.end()) distinct_.push_back(stretch);
  }
  if (distinct_.empty()) distinct_.emplace_back();
  if (!several()) index_.clear();
}

Stretches Stretches::Select(const std::vector<int>& lobes) const {
  if (!several()) return *this;
  std::vector<Stretch> of_lobes;
  for (const int lobe : lobes) of_lobes.push_back(of(lobe));
  return Stretches(of_lobes);
}

void Stretches::Check(int lobes) const {
  for (const Stretch& stretch : distinct_) CheckStretch(stretch);
  const int count = static_cast<int>(index_.size());
  if (!several() || count == lobes) return;
  throw Error(ErrorKind::kMismatch, "there are stretches of " + std::to_string(count) +
                                        " lobes, but " + std::to_string(lobes) +
                                        " lobes; give one a lobe, or one for all")
      .About("stretches", count);
}

}  // namespace trilobe
