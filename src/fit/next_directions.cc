#include "fit/next_directions.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "fit/seen_design.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit.h"

namespace trilobe {
namespace {

void CheckMeasured(const Measurement& measurement) {
  const auto refuse = [&](ErrorKind kind, const std::string& what) {
    throw ErrorIn(kind, measurement.source, what).About("next");
  };
  if (measurement.table) {
    refuse(ErrorKind::kUnsupported,
           "--next is for scattered samples; a " + measurement.kind + " is measured everywhere");
  }
  if (measurement.anisotropic) {
    refuse(ErrorKind::kUnsupported,
           "--next is for isotropic materials; this is measured at several azimuths of the light");
  }
  CheckDirections(measurement);
  if (const int count = measurement.samples.size(); count < kLeastMeasured) {
    refuse(ErrorKind::kData, "--next needs at least " + std::to_string(kLeastMeasured) +
                                 " samples, and there are " + std::to_string(count) +
                                 "; begin with trilobe measure --directions=20");
  }
}

// How Delta E falls with the number of directions in the median of materials
// (experiments/directions).
double ExpectedFall(int measured, int more) {
  constexpr double kPower = 0.25;
  return std::pow(static_cast<double>(measured) / (measured + more), kPower);
}

}  // namespace

const char* NameOf(NextBy by) {
  return by == NextBy::kPlan ? "plan" : by == NextBy::kDesign ? "design" : "both";
}

NextBy FindNextBy(std::string_view name) {
  for (const NextBy by : {NextBy::kPlan, NextBy::kDesign, NextBy::kBoth}) {
    if (name == NameOf(by)) return by;
  }
  throw Error(ErrorKind::kUnknown, "--by=" + std::string(name) + "; give plan, design or both")
      .About("by", name);
}

NextDirections NextDirectionsToMeasure(const Measurement& measurement, int count, NextBy by,
                                       const Goniometer& device, const FitOptions& options) {
  constexpr int kCandidates = 600;
  if (count < 1 || count > kMostNext) {
    throw Error(ErrorKind::kRange, "--next=" + std::to_string(count) + "; give 1 to " +
                                       std::to_string(kMostNext) + " directions")
        .About("next", count);
  }
  CheckMeasured(measurement);
  const BrdfSamples& samples = measurement.samples;
  std::vector<SphericalAngles> left =
      DirectionsLeft(std::max(kCandidates, count), device, samples.directions);
  if (std::ssize(left) < count) {
    throw Error(ErrorKind::kRange, "the device reaches " + std::to_string(left.size()) +
                                       " more directions than are measured, not " +
                                       std::to_string(count) + "; ask for fewer")
        .About("next", count);
  }
  const FitResult fit = Fit(measurement, options);
  NextDirections next{.directions = {}, .measured = samples.size(), .now = fit.whole};
  if (fit.interrupted) return next;
  if (next.now) {
    next.expected_delta_e = ExpectedFall(next.measured, count) * next.now->mean_delta_e;
  }
  if (by == NextBy::kPlan) {
    left.resize(count);
    next.directions = std::move(left);
    return next;
  }
  GreedyDesign design = SeenDesign(ProblemFor(measurement, options, fit.model().spec()),
                                   fit.model(), left, options.appearance);
  while (std::ssize(next.directions) < count) {
    const bool by_plan = by == NextBy::kBoth && next.directions.size() % 2 == 1;
    const int chosen = by_plan ? design.First() : design.Best();
    design.Measure(chosen);
    next.directions.push_back(left[chosen]);
  }
  return next;
}

}  // namespace trilobe
