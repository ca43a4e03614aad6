// The solvers that others are compared with make the models that they have always made: AWLS as it
// was published, and Levenberg-Marquardt on the condensed and on the plain problem. Solvers of our
// own are not here, since they are to get better. recorded_models.json was written by this test,
// with TRILOBE_RECORD naming the file, before the solvers came to work on samples of any kind.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/paths.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using Json = nlohmann::ordered_json;

constexpr MerlGrid kGrid{12, 12, 16};
constexpr const char* kReferenceSolvers[] = {"awls", "lm", "lm_plain"};
constexpr const char* kMaterials[] = {"plastic", "copper", "felt", "car-paint", "chrome", "rubber"};

// A model in few numbers: its projections on fixed directions, in units of each part's largest
// number.
std::vector<double> Fingerprint(const FactorModel& model) {
  std::vector<double> sums(4, 0.0);
  Random random(1);
  for (const auto [begin, size] : model.Parts()) {
    const auto part = model.parameters().subspan(begin, size);
    const double largest = std::max(std::ranges::max(part), 1e-300);
    for (const double x : part) {
      for (double& sum : sums) sum += random.Uniform() * x / largest;
    }
  }
  return sums;
}

TEST(RecordedModels, AreMadeAgain) {
  const char* const record = std::getenv("TRILOBE_RECORD");
  Json recorded = Json::object();
  if (record == nullptr) {
    std::ifstream(InRepository("tests/solvers/recorded_models.json")) >> recorded;
    ASSERT_EQ(recorded.size(), std::size(kMaterials));
  }
  for (const char* const material : kMaterials) {
    if (kSanitized && material != kMaterials[0]) continue;
    const BrdfTable table = Synthesize(FindSynthMaterial(material), 0.05, 1, kGrid);
    const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
    const Objective objective(ValidSamples(table), spec, FindWeighting("appearance"), 1);
    ASSERT_EQ(record == nullptr ? recorded[material].size() : std::size(kReferenceSolvers),
              std::size(kReferenceSolvers));
    for (const char* const name : kReferenceSolvers) {
      FactorModel model = FindInitialModel("analytic").make(objective, 1);
      const SolverSummary summary =
          MakeSolver(name)->Solve(objective, {.max_iterations = 6, .diagnose = false}, &model);
      const std::vector<double> fingerprint = Fingerprint(model);
      Json& entry = recorded[material][name];
      if (record != nullptr) {
        entry = {{"objective", summary.final_objective}, {"fingerprint", fingerprint}};
        continue;
      }
      // Other processors' linear algebra rounds otherwise, and six steps carry that on.
      const double E = entry.at("objective");
      EXPECT_NEAR(summary.final_objective / E, 1, 1e-6) << material << ' ' << name;
      for (size_t k = 0; k < fingerprint.size(); ++k) {
        const double expected = entry.at("fingerprint")[k];
        EXPECT_NEAR(fingerprint[k] / expected, 1, 1e-4) << material << ' ' << name;
      }
    }
  }
  if (record != nullptr) std::ofstream(record) << recorded.dump(1) << '\n';
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
