#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/quantile.h"
#include "model/measurement/sample_symptoms.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/brdf_samples.h"

// Symptoms in scans of the plane of incidence.
namespace trilobe {
namespace {

constexpr double kSameInPlane = 1e-5;  // [rad]

// A scan of the plane of incidence: mean values by angle from the normal [rad], above 0 on the side
// of the mirror direction.
class PlaneScan {
 public:
  explicit PlaneScan(double theta_i) : theta_i_(theta_i) {}

  void Add(double theta, double value) { values_.emplace_back(theta, value); }
  // In the order of the angles, of which each counts once, by the darkest: the normal is measured
  // at each azimuth.
  void Sort() {
    std::ranges::sort(values_);
    const auto is_same = [](const auto& a, const auto& b) {
      return std::abs(a.first - b.first) < kSameInPlane;
    };
    values_.erase(std::unique(values_.begin(), values_.end(), is_same), values_.end());
  }
  double theta_i() const { return theta_i_; }
  size_t size() const { return values_.size(); }

  // A lower estimate of the albedo if both sides were scanned; else 0.
  double Albedo() const {
    constexpr size_t kFewestSamples = 8;
    if (values_.size() < kFewestSamples || !(values_.front().first < 0)) return 0;
    if (!(values_.back().first > 0)) return 0;
    return std::max(AlbedoAbout(0), std::cos(theta_i_) * AlbedoAbout(theta_i_));
  }

  // By linear interpolation between samples no more than `gap` apart; none beyond them.
  std::optional<double> At(double theta, double gap) const {
    constexpr double kRounding = 1e-6;
    const auto next = std::ranges::lower_bound(values_, std::pair(theta - kRounding, 0.0));
    if (next == values_.end() || (next == values_.begin() && next->first > theta + kRounding)) {
      return std::nullopt;
    }
    if (next == values_.begin() || next->first < theta + kRounding) return next->second;
    const auto& [low, at_low] = *std::prev(next);
    const auto& [high, at_high] = *next;
    if (high - low > gap) return std::nullopt;
    return at_low + (theta - low) / (high - low) * (at_high - at_low);
  }

 private:
  double AlbedoAbout(double centre) const {
    std::vector<double> steps;
    for (size_t k = 1; k < values_.size(); ++k) {
      steps.push_back(values_[k].first - values_[k - 1].first);
    }
    const double step = std::max(UpperMedian(std::move(steps)), DegreesToRadians(0.1));
    const double gap = 2.5 * step;  // further apart, nobody knows what is between
    double sum = 0;
    for (double ring = step; centre + ring < kPi / 2; ring += step) {
      const double darker =
          std::min(At(centre - ring, gap).value_or(0), At(centre + ring, gap).value_or(0));
      sum += darker * std::cos(centre + ring) * 2 * kPi * (std::cos(ring - step) - std::cos(ring));
    }
    return sum;
  }

  double theta_i_;
  std::vector<std::pair<double, double>> values_;
};

// By the direction of light.
std::vector<PlaneScan> PlaneScansOf(const BrdfSamples& samples) {
  constexpr double kInPlane = 0.02, kSame = 1e-5;  // [rad]
  std::map<std::pair<int64_t, int64_t>, PlaneScan> scans;
  for (int j = 0; j < samples.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    const double azimuth = at.phi_o - at.phi_i;
    if (at.theta_o > kSame && std::abs(std::sin(azimuth)) > kInPlane) continue;
    const std::pair light(std::llround(at.theta_i / kSame), std::llround(at.phi_i / kSame));
    const auto [scan, is_new] = scans.try_emplace(light, at.theta_i);
    scan->second.Add(std::copysign(at.theta_o, -std::cos(azimuth)), Mean(samples.rho[j]));
  }
  std::vector<PlaneScan> sorted;
  for (auto& [light, scan] : scans) {
    scan.Sort();
    sorted.push_back(std::move(scan));
  }
  return sorted;
}

// |log(f / f exchanged)| of two scans, on both sides, where theta_o is counted from the normal or,
// if `from_mirror`, from the mirror direction.
void AddExchanged(const PlaneScan& a, const PlaneScan& b, bool from_mirror,
                  std::vector<double>* logarithms) {
  const double gap = DegreesToRadians(12);
  for (const int side : {-1, 1}) {
    const auto at = [&](const PlaneScan& scan, double theta) {
      return scan.At(side * theta - (from_mirror ? scan.theta_i() : 0), gap);
    };
    const std::optional<double> first = at(a, b.theta_i()), second = at(b, a.theta_i());
    if (first && second && *first > 0 && *second > 0) {
      logarithms->push_back(std::log(*first / *second));
    }
  }
}

}  // namespace

double ReflectedLightOfScans(const BrdfSamples& samples) {
  std::vector<double> albedos;
  for (const PlaneScan& scan : PlaneScansOf(samples)) {
    if (const double albedo = scan.Albedo(); albedo > 0) albedos.push_back(albedo);
  }
  return albedos.empty() ? 0 : UpperMedian(std::move(albedos));
}

FromMirrorSymptom FromMirrorOf(const BrdfSamples& samples) {
  constexpr size_t kFewestValues = 5, kMostScans = 40, kFewestPairs = 4;
  const double apart = DegreesToRadians(4);
  std::vector<PlaneScan> scans = PlaneScansOf(samples);
  std::erase_if(scans, [](const PlaneScan& scan) { return scan.size() < kFewestValues; });
  if (scans.size() > kMostScans) return {};
  std::vector<double> as_read, from_mirror, cosines;
  for (size_t a = 0; a < scans.size(); ++a) {
    for (size_t b = a + 1; b < scans.size(); ++b) {
      if (std::abs(scans[a].theta_i() - scans[b].theta_i()) < apart) continue;
      AddExchanged(scans[a], scans[b], /*from_mirror=*/false, &as_read);
      AddExchanged(scans[a], scans[b], /*from_mirror=*/true, &from_mirror);
      cosines.resize(as_read.size(),
                     std::log(std::cos(scans[a].theta_i()) / std::cos(scans[b].theta_i())));
    }
  }
  if (as_read.size() < kFewestPairs || from_mirror.size() < kFewestPairs) return {};
  // A cosine too many or too few may explain the differences, too.
  const auto error = [](const std::vector<double>& logarithms, const std::vector<double>& cosine,
                        double exponent) {
    std::vector<double> errors(logarithms.size());
    for (size_t k = 0; k < errors.size(); ++k) {
      errors[k] = std::abs(logarithms[k] - (cosine.empty() ? 0 : exponent * cosine[k]));
    }
    return Quantile(&errors, 0.5);
  };
  return {.is_decided = true,
          .error = std::min({error(as_read, cosines, 0), error(as_read, cosines, 1),
                             error(as_read, cosines, -1)}),
          .error_from_mirror = error(from_mirror, {}, 0)};
}

}  // namespace trilobe
