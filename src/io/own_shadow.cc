#include "trilobe/io/own_shadow.h"

#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "trilobe/brdf/directions.h"

namespace trilobe {
namespace {

constexpr int kShadowedDegrees = 5;                // theta_d where a shadow is looked for
constexpr int kLitDegrees = 20, kEndDegrees = 30;  // theta_d that it is held against
constexpr int kClasses = 4;                        // of theta_h, half a degree each
constexpr size_t kFewest = 10;                     // samples that tell of a shadow
constexpr size_t kFewestLit = 3;                   // samples that tell how bright a class is
constexpr double kDark = 0.25, kBright = 0.5;      // ratios
constexpr double kBrightShare = 0.8;               // of the samples, where the shadow has ended

// The value below which this share of them lies.
double Quantile(double share, std::vector<double> values) {
  std::ranges::sort(values);
  return gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), share);
}

}  // namespace

OwnShadow FindOwnShadow(const BrdfSamples& samples) {
  struct Sample {
    int degree, theta_h_class;
    double value;
  };
  std::vector<Sample> highlight;
  std::array<std::vector<double>, kClasses> lit;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles at = samples.Angles(j);
    const int degree = static_cast<int>(RadiansToDegrees(at.theta_d));
    const int theta_h_class = static_cast<int>(RadiansToDegrees(at.theta_h) * 2);
    if (degree >= kEndDegrees || theta_h_class >= kClasses) continue;
    const Rgb& rho = samples.rho[j];
    const double value = std::accumulate(rho.begin(), rho.end(), 0.0);
    highlight.push_back({degree, theta_h_class, value});
    if (degree >= kLitDegrees) lit[theta_h_class].push_back(value);
  }

  std::array<double, kClasses> bright{};  // 0 where too few samples tell
  for (int k = 0; k < kClasses; ++k) {
    if (lit[k].size() >= kFewestLit) bright[k] = Quantile(0.5, std::move(lit[k]));
  }

  // By theta_d: how bright the highlight is, 1 as where it is lit.
  std::array<std::vector<double>, kLitDegrees> ratios;
  for (const auto& [degree, theta_h_class, value] : highlight) {
    if (degree >= kLitDegrees || !(bright[theta_h_class] > 0)) continue;
    ratios[degree].push_back(value / bright[theta_h_class]);
  }
  std::vector<double> middle;
  for (int degree = 0; degree < kShadowedDegrees; ++degree) {
    middle.insert(middle.end(), ratios[degree].begin(), ratios[degree].end());
  }
  if (middle.size() < kFewest) return {};
  const double ratio = Quantile(0.5, middle);
  if (!(ratio < kDark)) return {};
  int end = kLitDegrees;
  while (end > kShadowedDegrees &&
         (ratios[end - 1].empty() || Quantile(1 - kBrightShare, ratios[end - 1]) > kBright)) {
    --end;
  }
  constexpr double kMost = 1000;  // where nothing is left of it
  return {.theta_d_deg = static_cast<double>(end),
          .darker = std::min(kMost, 1 / std::max(ratio, 1 / kMost))};
}

}  // namespace trilobe
