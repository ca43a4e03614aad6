// Invalid arguments to a solver give an Error of one line, the model as it was, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "solvers/diagnosis.h"
#include "solvers/gaussian_filter.h"
#include "tests/error_of.h"
#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class SolverArguments : public testing::TestWithParam<std::string> {
 protected:
  // Checks that the model stays as it was, too.
  std::optional<Error> ErrorFrom(const FactorModel& start,
                                 const SolverOptions& options = {}) const {
    FactorModel model = start;
    auto error = ErrorOf([&] { MakeSolver(GetParam())->Solve(objective_, options, &model); });
    const auto same = [](double a, double b) { return a == b || (a != a && b != b); };
    EXPECT_TRUE(std::ranges::equal(model.parameters(), start.parameters(), same));
    return error;
  }

  const ModelSpec spec_ = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective_ = MakeObjective(RandomTable(kGrid, 1), spec_);
};

TEST_P(SolverArguments, StartsThatAreNoModel) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, -1.0, -1e-300}) {
    for (const size_t k : {size_t{0}, size_t{5}, size_t{12}}) {
      FactorModel model = RandomModel(spec_, 1);
      model.parameters()[k] = bad;
      EXPECT_THAT(ErrorFrom(model),
                  IsError(ErrorKind::kData, {.key = "parameter " + std::to_string(k)}))
          << bad;
    }
  }
  for (const NamedSpec& other : TestSpecs(kGrid)) {
    if (other.spec == spec_) continue;
    EXPECT_THAT(ErrorFrom(RandomModel(other.spec, 1)),
                IsError(ErrorKind::kMismatch, {.key = "spec"}))
        << other.name;
  }
  FactorModel huge(spec_);
  std::ranges::fill(huge.parameters(), 1e100);
  EXPECT_THAT(ErrorFrom(huge), IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
  EXPECT_THAT(ErrorOf([&] { MakeSolver(GetParam())->Solve(objective_, {}, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model to start from"}));
}

TEST_P(SolverArguments, OptionsOutOfTheirRange) {
  const FactorModel start = RandomModel(spec_, 1);
  const auto error = [&](const auto& change) {
    SolverOptions options;
    change(&options);
    return ErrorFrom(start, options);
  };
  EXPECT_THAT(error([](SolverOptions* changed) { changed->max_iterations = -1; }),
              IsError(ErrorKind::kRange, {.key = "max_iterations", .value = "-1"}));
  EXPECT_THAT(error([](SolverOptions* changed) { changed->max_seconds = -1; }),
              IsError(ErrorKind::kRange, {.key = "max_seconds", .value = "-1"}));
  EXPECT_THAT(error([](SolverOptions* changed) { changed->max_seconds = kNaN; }),
              IsError(ErrorKind::kRange, {.key = "max_seconds", .value = "nan"}));
  EXPECT_THAT(error([](SolverOptions* changed) { changed->relative_decrease_tolerance = kNaN; }),
              IsError(ErrorKind::kRange, {.key = "relative_decrease_tolerance", .value = "nan"}));
  for (const double bad : {-1.0, kNaN}) {
    EXPECT_THAT(error([&](SolverOptions* changed) { changed->optimality_tolerance = bad; }),
                IsError(ErrorKind::kRange, {.key = "optimality_tolerance"}));
  }
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_THAT(error([&](SolverOptions* changed) { changed->g_filter_sigma = bad; }),
                IsError(ErrorKind::kRange, {.key = "g_filter_sigma"}));
  }
  EXPECT_THAT(error([](SolverOptions* changed) { changed->memory = -1; }),
              IsError(ErrorKind::kRange, {.key = "memory", .value = "-1"}));
  EXPECT_THAT(error([](SolverOptions* changed) { changed->starts = 0; }),
              IsError(ErrorKind::kRange, {.key = "starts", .value = "0"}));
}

std::vector<std::string> SolverNames() {
  std::vector<std::string> names;
  for (const SolverEntry& solver : kLibrarySolvers) names.push_back(solver.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverArguments, testing::ValuesIn(SolverNames()),
                         [](const auto& param) { return param.param; });

TEST(RegisterSolver, NeedsANameAndSomethingToMakeIt) {
  const size_t before = Solvers().size();
  SolverEntry entry = FindSolver("awls");
  entry.name = "";
  EXPECT_THAT(ErrorOf([&] { RegisterSolver(entry); }),
              IsError(ErrorKind::kMissing, {.key = "name"}));
  entry.name = "own";
  entry.make = nullptr;
  EXPECT_THAT(ErrorOf([&] { RegisterSolver(entry); }),
              IsError(ErrorKind::kMissing, {.key = "make", .value = "own"}));
  EXPECT_EQ(Solvers().size(), before);
  // This can be told no sooner than when it is asked for.
  entry.make = [] { return nullptr; };
  RegisterSolver(entry);
  EXPECT_THAT(ErrorOf([] { MakeSolver("own"); }),
              IsError(ErrorKind::kMissing, {.key = "solver", .value = "own"}));
}

TEST(SolverRoom, NullsAndEmptyFunctions) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 1);
  EXPECT_THAT(ErrorOf([&] { trilobe::Run("own", objective, {}, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  trilobe::Run run("own", objective, {}, &model);
  EXPECT_THAT(ErrorOf([&] { RepeatSweeps(nullptr, objective, model, &run); }),
              IsError(ErrorKind::kMissing, {.key = "sweep"}));
  EXPECT_THAT(ErrorOf([&] { RepeatSweeps([](FactorModel*) {}, objective, model, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the run"}));
  EXPECT_THAT(ErrorOf([&] { SmoothG(1, objective.coverage(), nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(
      ErrorOf([&] { NormalEquations(objective).Evaluate(model, Hessian::kNewton, nullptr); }),
      IsError(ErrorKind::kMissing, {.key = "the result"}));
}

TEST(SolverRoom, NumbersOutOfTheirRange) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 1);
  for (const double bad : {0.0, -1.0, kNaN}) {
    EXPECT_THAT(ErrorOf([&] { SmoothG(bad, objective.coverage(), &model); }),
                IsError(ErrorKind::kRange, {.key = "sigma"}));
  }
  EXPECT_THAT(ErrorOf([&] { SmoothG(1, std::vector<double>(3), &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "3"}));
  const std::vector<double> x(3);
  EXPECT_THAT(ErrorOf([&] { ScaledProjectedGradient(QuadraticModel(), x); }),
              IsError(ErrorKind::kMismatch, {.key = "the gradient", .value = "0"}));
}

TEST(SolverRoom, ModelsOfAnotherSpec) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid));
  const FactorModel other(ModelSpec::SharedFactors(1, kGrid));
  EXPECT_THAT(ErrorOf([&] { Diagnose(objective, other); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
