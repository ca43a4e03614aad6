// No corruption of a measurement, however strong, makes a fit fail but by one clear line, nor
// raises E in AWLS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/corruption.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// AWLS for some sweeps.
FitOptions Quick() {
  FitOptions options;
  options.solver = "awls";
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 4, .relative_decrease_tolerance = 0, .diagnose = false};
  };
  options.compare = false;
  return options;
}

void ExpectSoundFit(const Measurement& measured, const std::string& name) {
  const FitResult fit = Fit(measured, Quick());
  for (const double x : fit.model().parameters()) {
    ASSERT_TRUE(std::isfinite(x) && x >= 0) << name;
  }
  EXPECT_TRUE(std::isfinite(fit.score.objective)) << name;
  const auto& trace = fit.summary.trace;
  ASSERT_FALSE(trace.empty()) << name;
  for (size_t k = 1; k < trace.size(); ++k) {
    EXPECT_LE(trace[k].objective, trace[k - 1].objective * (1 + 1e-12)) << name << ", sweep " << k;
  }
}

class CorruptedFit : public testing::TestWithParam<CorruptionKind> {};

TEST_P(CorruptedFit, IsSoundOrOneLine) {
  const CorruptionKind& kind = GetParam();
  // Strengths from almost nothing to the greatest.
  const std::vector<double> shares = {0.001, 0.03, 0.3, 1}, ends = {kind.min, kind.max};
  for (const double& share : shares) {
    for (const double& end : ends) {
      const bool is_picked = IsOneIn(2, {NumberOf(share, shares), NumberOf(end, ends)});
      if (share < 1 && !is_picked) continue;
      const double strength = kind.nothing + share * (end - kind.nothing);
      const std::string name = kind.name + " " + std::to_string(strength);
      Measurement measured = LoadMeasurement("synth:plastic@12x12x16");
      try {
        Corrupt({{.kind = &kind, .strength = strength}}, 1, 1, &measured);
        LeaveOutOutliers(1, &measured);
        ExpectSoundFit(measured, name);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kData) << name << ": " << error.what();
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, CorruptedFit, testing::ValuesIn(CorruptionKinds()),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
