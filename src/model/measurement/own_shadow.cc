#include "model/measurement/own_shadow.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

constexpr int kShadowedDegrees = 5;                // theta_d where a shadow is looked for
constexpr int kLitDegrees = 20, kEndDegrees = 30;  // theta_d that it is held against
constexpr int kStepsPerDegree = 10;                // of theta_h
constexpr int kSteps = 2 * kStepsPerDegree;        // the highlight's
constexpr int kFurther = 5;                        // steps further out: held against for a shadow
constexpr int kAround = 2;                         // steps in and out: held against for its end
constexpr size_t kFewest = 10;                     // samples that tell of a shadow, or of its end
constexpr size_t kFewestLit = 3;                   // samples that tell how bright a window is
constexpr double kDark = 0.25, kBright = 0.5;      // ratios
constexpr double kBrightShare = 0.8;               // of the samples, where the shadow has ended

constexpr double kStepRounding = 1e-6;  // of degrees that became radians and back

// The quantile of a share, interpolated linearly; 0 if there are no values.
double InterpolatedQuantile(double share, std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const double position = share * static_cast<double>(values.size() - 1);
  const auto k = static_cast<size_t>(position);
  const double t = position - static_cast<double>(k);
  return k + 1 < values.size() ? (1 - t) * values[k] + t * values[k + 1] : values[k];
}

int WholeSteps(double angle, double per_degree) {
  return static_cast<int>(RadiansToDegrees(angle) * per_degree + kStepRounding);
}

using LitSamples = std::array<std::vector<double>, kSteps + kFurther>;  // by steps of theta_h

// The median light of steps `first` to `last`; 0 if too little is known.
double Brightness(const LitSamples& lit, int first, int last) {
  std::vector<double> values;
  for (int step = std::max(first, 0); step <= last; ++step) {
    values.insert(values.end(), lit[step].begin(), lit[step].end());
  }
  return values.size() < kFewestLit ? 0 : InterpolatedQuantile(0.5, std::move(values));
}

}  // namespace

OwnShadow FindOwnShadow(const BrdfSamples& samples) {
  struct Sample {
    int degree, step;
    double value;
  };
  std::vector<Sample> highlight;
  LitSamples lit;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles at = samples.Angles(j);
    const int degree = WholeSteps(at.theta_d, 1), step = WholeSteps(at.theta_h, kStepsPerDegree);
    if (degree >= kEndDegrees || step >= kSteps + kFurther) continue;
    const Rgb& rho = samples.rho[j];
    const double value = rho[0] / kChannels + rho[1] / kChannels + rho[2] / kChannels;
    if (degree >= kLitDegrees) {
      lit[step].push_back(value);
    } else if (step < kSteps) {
      highlight.push_back({degree, step, value});
    }
  }

  std::array<double, kSteps> further, around;
  for (int step = 0; step < kSteps; ++step) {
    further[step] = Brightness(lit, step, step + kFurther);
    around[step] = Brightness(lit, step - kAround, step + kAround);
  }

  // Brightness of the centre relative to the light further out. A highlight decreases with theta_h,
  // so one that is narrow relative to the samples' steps is not a shadow.
  std::vector<double> middle;
  for (const auto& [degree, step, value] : highlight) {
    if (degree < kShadowedDegrees && further[step] > 0) middle.push_back(value / further[step]);
  }
  if (middle.size() < kFewest) return {};
  const double ratio = InterpolatedQuantile(0.5, middle);
  if (!(ratio < kDark)) return {};

  // Highlight relative to the light at the same theta_h, by theta_d.
  std::array<std::vector<double>, kLitDegrees> ratios;
  for (const auto& [degree, step, value] : highlight) {
    const double bright = around[step] > 0 ? around[step] : further[step];
    if (bright > 0) ratios[degree].push_back(value / bright);
  }
  // The samples just below `end`, over enough degrees for a sufficient number.
  const auto below = [&](int end) {
    std::vector<double> found;
    while (end > 0 && found.size() < kFewest) {
      --end;
      found.insert(found.end(), ratios[end].begin(), ratios[end].end());
    }
    return found;
  };
  int end = kLitDegrees;
  while (end > kShadowedDegrees && InterpolatedQuantile(1 - kBrightShare, below(end)) > kBright) {
    --end;
  }
  constexpr double kMost = 1000;  // where nothing is left of it
  return {.theta_d_deg = static_cast<double>(end),
          .darker = std::min(kMost, 1 / std::max(ratio, 1 / kMost))};
}

}  // namespace trilobe
