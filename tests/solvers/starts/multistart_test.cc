// auto and multistart: what they promise beyond what every solver does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "model/objective/gauge.h"
#include "solvers/starts/minima.h"
#include "solvers/starts/start_elimination.h"
#include "tests/error_of.h"
#include "tests/solvers/iterations.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

// Iterations after which `auto` has gone on with all its starts, and then with the best.
constexpr int kWholeRace = 14;

// Three lobes of a GGX-like width each, with noise: data with more than one minimum.
Objective NoisyObjective(const ModelSpec& spec, int num_threads = 1) {
  FactorModel truth = RandomModel(ModelSpec::SharedFactors(3, kGrid), 2, 0.7);
  BrdfTable table = TableOf(truth, kGrid);
  Random random(3);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(0.1);
  }
  return MakeObjective(table, spec, "compressive", num_threads);
}

std::vector<std::string> Names(const SolverSummary& summary) {
  std::vector<std::string> names;
  for (const StartResult& start : summary.starts) names.push_back(start.name);
  return names;
}

class Multistart : public testing::TestWithParam<const char*> {
 protected:
  static SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                             FactorModel* model) {
    return MakeSolver(GetParam())->Solve(objective, options, model);
  }
};

// Without progress, a run of a thousand starts would say nothing for a minute.
TEST_P(Multistart, TellsHowFarTheStartsAre) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(3, kGrid), 2);
  FactorModel model = FindInitialModel("constant").make(objective, 1);
  SolverOptions options = Iterations(kWholeRace);
  options.starts = 10;
  std::vector<StartProgress> told;
  std::vector<StartResult> ended;
  options.on_start = [&](const StartProgress& progress) {
    if (progress.start) {
      EXPECT_LE(progress.lowest, progress.start->objective);
      ended.push_back(*progress.start);
    } else {
      told.push_back(progress);
    }
  };
  const SolverSummary summary = Solve(objective, options, &model);
  ASSERT_GE(told.size(), summary.starts.size());
  double before = 0;
  for (const StartProgress& progress : told) {
    EXPECT_GE(progress.ended, 1);
    EXPECT_LE(progress.ended, progress.starts);
    EXPECT_LE(progress.round, progress.rounds);
    EXPECT_GT(progress.share, before);
    before = progress.share;
  }
  EXPECT_NEAR(before, 1, 1e-12);
  EXPECT_EQ(told.back().ended, told.back().starts);
  EXPECT_EQ(told.back().round, told.back().rounds);
  EXPECT_EQ(summary.given.on_start, nullptr);
  // Each with its minimum, by the solver that tells them apart.
  if (GetParam() == std::string("multistart")) {
    EXPECT_EQ(ended.size(), summary.starts.size());
    EXPECT_TRUE(std::ranges::all_of(ended, [](const auto& start) { return start.minimum > 0; }));
  } else {
    EXPECT_TRUE(ended.empty());
  }
}

TEST_P(Multistart, NamesTheStartsBestFirst) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(3, kGrid));
  FactorModel model = FindInitialModel("constant").make(objective, 1);
  SolverOptions options = Iterations(kWholeRace);
  options.starts = 10;
  options.seed = 7;
  const SolverSummary summary = Solve(objective, options, &model);
  // `auto` tries as few as agree, which the first three do here.
  std::vector<std::string> expected = {"given", "wide", "narrow"};
  if (GetParam() == std::string("multistart")) {
    expected.insert(expected.end(), {"highlight", "middle", "analytic", "roughness/7", "swept",
                                     "dogleg/8", "roughness/9"});
  }
  EXPECT_THAT(Names(summary), testing::UnorderedElementsAreArray(expected));
  EXPECT_TRUE(std::ranges::is_sorted(summary.starts, {}, &StartResult::objective));
  EXPECT_LT(summary.starts.front().objective, summary.starts.back().objective);
  // These few samples are not thinned: E is that of all.
  double least = summary.initial_objective;
  for (const IterationRecord& record : summary.trace) least = std::min(least, record.objective);
  EXPECT_LE(least, summary.starts.front().objective * (1 + 1e-12));
}

// A start that there is not, or that is the given one, does not run.
TEST_P(Multistart, LeavesOutWhatIsNoStartOfItsOwn) {
  SolverOptions options = Iterations(kWholeRace);
  const Objective one_lobe = NoisyObjective(ModelSpec::SharedFactors(1, kGrid));
  FactorModel model = FindInitialModel("analytic").make(one_lobe, 1);
  EXPECT_THAT(Names(Solve(one_lobe, options, &model)),
              testing::AllOf(testing::Contains("given"), testing::Contains("narrow"),
                             testing::Not(testing::Contains("analytic"))));
}

// Two that agree must be the best: of rubber, two of the first three end 21 % above the third.
TEST(Auto, TriesNoMoreStartsWhereTwoAgree) {
  constexpr MerlGrid kFine{.theta_h = 16, .theta_d = 16, .phi_d = 32};
  std::vector<size_t> counts;
  for (const char* const material : {"plastic", "rubber"}) {
    const Objective objective =
        MakeObjective(Synthesize(FindSynthMaterial(material), 0.05, 1, kFine),
                      ModelSpec::SharedFactors(2, kFine), "appearance");
    FactorModel model = FindInitialModel("analytic").make(objective, 1);
    const SolverSummary summary =
        MakeSolver("auto")->Solve(objective, Iterations(kWholeRace), &model);
    EXPECT_EQ(summary.notes.back(), std::to_string(CountAgreeing(summary.starts)) + " of " +
                                        std::to_string(summary.starts.size()) + " starts agree")
        << material;
    if (summary.starts.size() == 3) {
      EXPECT_GE(CountAgreeing(summary.starts), 2) << material;
    }
    counts.push_back(summary.starts.size());
  }
  EXPECT_THAT(counts, testing::ElementsAre(3, 5));
}

TEST_P(Multistart, IsNeverWorseThanAnyStart) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const Objective objective = NoisyObjective(spec);
    FactorModel model = RandomModel(spec, 4);
    SolverOptions options = Iterations(kWholeRace);
    options.starts = 9;
    const SolverSummary summary = Solve(objective, options, &model);
    const double E = objective.Value(model);
    EXPECT_EQ(E, summary.final_objective) << name;
    EXPECT_LE(E, summary.initial_objective) << name;
    // On thinned samples, E of a start is an estimate.
    const int stride = StartElimination::StrideFor(objective, StartElimination::kThinned);
    const double most = 1 + (stride > 1 ? 0.05 : 1e-12);
    for (const StartResult& start : summary.starts) {
      EXPECT_LE(E, start.objective * most) << name << ", " << start.name;
    }
    for (const char* const init : {"highlight", "analytic", "roughness"}) {
      for (const uint64_t seed : {1, 2, 3}) {
        const FactorModel start = FindInitialModel(init).make(objective, seed);
        EXPECT_LE(E, objective.Value(start)) << name << ", " << init << "/" << seed;
      }
    }
  }
}

// In data without any order there are about as many minima as starts.
TEST_P(Multistart, KeepsAGivenStartThatIsTheBest) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 8), ModelSpec::SharedFactors(5, kGrid));
  FactorModel best = RandomModel(objective.spec(), 1);
  SolverOptions many = Iterations(40);
  many.starts = 40;
  many.seed = 100;
  const double E = MakeSolver("multistart")->Solve(objective, many, &best).final_objective;
  FactorModel model = best;
  Random random(3);
  for (double& x : model.parameters()) x *= random.LogNormal(1e-3);
  const SolverSummary summary = Solve(objective, Iterations(40), &model);
  const auto is_given = [](const StartResult& start) {
    return start.name == "given" || start.name == "swept";  // which goes on from the given one
  };
  ASSERT_GE(summary.starts.size(), 3U);
  EXPECT_TRUE(is_given(summary.starts.front()));
  const auto given = std::ranges::find(summary.starts, "given", &StartResult::name);
  ASSERT_NE(given, summary.starts.end());
  EXPECT_LE(given->objective, E * (1 + 1e-9));
  const auto other = std::ranges::find_if_not(summary.starts, is_given);
  EXPECT_GT(other->objective, summary.starts.front().objective * (1 + 1e-3));
  EXPECT_LE(summary.final_objective, E * (1 + 1e-9));
}

TEST_P(Multistart, GivesTheSameBitsForAnyThreads) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  SolverSummary one;
  FactorModel model_of_one;
  for (const int threads : {1, 2}) {
    const Objective objective = NoisyObjective(spec, threads);
    FactorModel model = FindInitialModel("random").make(objective, 3);
    SolverOptions options = Iterations(kWholeRace);
    options.starts = 12;  // some of them by dogleg steps
    const SolverSummary summary = Solve(objective, options, &model);
    if (threads == 1) {
      one = summary;
      model_of_one = model;
    }
    EXPECT_TRUE(std::ranges::equal(model.parameters(), model_of_one.parameters()));
    EXPECT_EQ(Names(summary), Names(one));
    EXPECT_TRUE(std::ranges::equal(summary.starts, one.starts, {}, &StartResult::objective,
                                   &StartResult::objective));
    EXPECT_TRUE(std::ranges::equal(summary.trace, one.trace, {}, &IterationRecord::objective,
                                   &IterationRecord::objective));
  }
}

// Whichever start wins, what no sample reads is the caller's.
TEST_P(Multistart, LeavesUnobservedBinsToTheCaller) {
  BrdfTable table = RandomTable(kGrid, 2);
  InvalidateThetaH(4, 2, &table);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(table, spec);
  const std::vector<bool> unobserved = UnobservedParameters(objective.coverage());
  ASSERT_GE(std::ranges::count(unobserved, true), spec.lobes);
  const FactorModel start = RandomModel(spec, 3, 2);  // so bad that another one wins
  FactorModel model = start;
  const SolverSummary summary = Solve(objective, Iterations(kWholeRace), &model);
  EXPECT_NE(summary.starts.front().name, "given");
  for (int k = 0; k < spec.num_parameters(); ++k) {
    if (!unobserved[k]) continue;
    EXPECT_EQ(model.parameters()[k], start.parameters()[k]) << "parameter " << k;
  }
}

// Thinning leaves most of these samples out; a few of them hold most of E, so that it has to look
// at
// more.
TEST_P(Multistart, FitsWhatItRacedWithoutAsWell) {
  constexpr MerlGrid kFine{.theta_h = 8, .theta_d = 8, .phi_d = 96};
  const ModelSpec spec = ModelSpec::SharedFactors(1, kFine);
  for (const bool spiky : {false, true}) {
    BrdfTable table = RandomTable(kFine, 5, 0, 0.3);
    for (int bin = 0; spiky && bin < kFine.size(); bin += 97) table.stored[1][bin] *= 1e4;
    FactorModel one;
    for (const int threads : {1, 2, 3}) {
      const Objective objective = MakeObjective(table, spec, "uniform", threads);
      FactorModel model = FindInitialModel("analytic").make(objective, 1);
      const SolverSummary summary = Solve(objective, Iterations(30), &model);
      EXPECT_TRUE(std::ranges::is_sorted(summary.trace, std::ranges::greater(),
                                         &IterationRecord::objective));
      EXPECT_EQ(summary.final_objective, objective.Value(model));
      EXPECT_LT(summary.final_objective, summary.initial_objective);
      if (threads == 1) one = model;
      EXPECT_TRUE(std::ranges::equal(model.parameters(), one.parameters())) << threads;
    }
  }
}

TEST_P(Multistart, EndsAtAnyIteration) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(2, kGrid));
  FactorModel whole = RandomModel(objective.spec(), 1);
  const int most = Solve(objective, Iterations(kWholeRace), &whole).iterations;
  EXPECT_GT(most, 4);
  for (int count = 1; count <= most; ++count) {
    FactorModel model = RandomModel(objective.spec(), 1);
    const SolverSummary summary = Solve(objective, Iterations(count), &model);
    EXPECT_EQ(summary.iterations, count);
    EXPECT_EQ(summary.final_objective, objective.Value(model));

    // An interrupt after as many does the same.
    SolverOptions interrupted = Iterations(100);
    interrupted.on_iteration = [count](const IterationRecord& record, const FactorModel&) {
      return record.iteration < count;
    };
    FactorModel other = RandomModel(objective.spec(), 1);
    EXPECT_EQ(Solve(objective, interrupted, &other).iterations, count);
    EXPECT_TRUE(std::ranges::equal(model.parameters(), other.parameters()));
  }
}

// A round may take a minute.
TEST_P(Multistart, EndsInTheMidstOfALeg) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(2, kGrid));
  FactorModel model = RandomModel(objective.spec(), 1);
  SolverOptions options = Iterations(100);
  std::atomic<int> asked = 0;
  options.stop = [&asked] { return ++asked > 5; };
  const SolverSummary summary = Solve(objective, options, &model);
  EXPECT_EQ(summary.stop_reason, StopReason::kInterrupted);
  EXPECT_LE(summary.iterations, 1);
  EXPECT_LT(asked, 100);
  EXPECT_EQ(summary.final_objective, objective.Value(model));
}

TEST_P(Multistart, TriesNoStartWhereNoIterationIsAskedFor) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(2, kGrid));
  const FactorModel start = RandomModel(objective.spec(), 1);
  SolverOptions no_time = Iterations(10);
  no_time.max_seconds = 0;
  for (const SolverOptions& options : {Iterations(0), no_time}) {
    FactorModel model = start;
    const SolverSummary summary = Solve(objective, options, &model);
    EXPECT_EQ(summary.iterations, 0);
    EXPECT_TRUE(summary.starts.empty());
    EXPECT_TRUE(summary.notes.empty());
    EXPECT_TRUE(std::ranges::equal(model.parameters(), start.parameters()));
  }
}

TEST_P(Multistart, FitsScatteredSamples) {
  constexpr MerlGrid kSmall{.theta_h = 5, .theta_d = 5, .phi_d = 8};
  const ModelSpec spec = ModelSpec::SharedFactors(2, kSmall);
  const Objective objective(Scattered(ValidSamples(RandomTable(kSmall, 1))), spec,
                            FindWeighting("compressive"));
  FactorModel model = RandomModel(spec, 1);
  SolverOptions options = Iterations(8);
  options.starts = 10;
  const SolverSummary summary = Solve(objective, options, &model);
  EXPECT_THAT(Names(summary), testing::Contains("given"));
  if (GetParam() == std::string("multistart")) {
    EXPECT_THAT(Names(summary), testing::Contains("swept"));
  }
  EXPECT_EQ(summary.iterations, 8);
  EXPECT_LT(summary.final_objective, summary.initial_objective);
  EXPECT_EQ(objective.Value(model), summary.final_objective);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Multistart, testing::Values("auto", "multistart"),
                         [](const auto& param) { return param.param; });

TEST(MultistartOnly, TriesAsManyAsAskedFor) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(2, kGrid));
  for (const int starts : {1, 2, 5}) {
    FactorModel model = RandomModel(objective.spec(), 1);
    SolverOptions options = Iterations(5);
    options.starts = starts;
    const SolverSummary summary = MakeSolver("multistart")->Solve(objective, options, &model);
    EXPECT_EQ(summary.starts.size(), starts);
    EXPECT_THAT(Names(summary), testing::Contains("given"));
  }
  FactorModel model = RandomModel(objective.spec(), 1);
  SolverOptions options;
  options.starts = 0;
  EXPECT_THAT(ErrorOf([&] { MakeSolver("multistart")->Solve(objective, options, &model); }),
              IsError(ErrorKind::kRange, {.key = "starts", .value = "0"}));
}

// A joint step on all samples gains more than an iteration of others, and costs more.
TEST(AutoOnly, EndsAtTenTimesTheTolerance) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(2, kGrid));
  for (const double tolerance : {1e-5, 1e-3, 0.5}) {
    FactorModel model = RandomModel(objective.spec(), 1);
    SolverOptions options = Iterations(100);
    options.relative_decrease_tolerance = tolerance;
    const SolverSummary summary = MakeSolver("auto")->Solve(objective, options, &model);
    EXPECT_EQ(summary.given.relative_decrease_tolerance, tolerance);
    EXPECT_EQ(summary.used.relative_decrease_tolerance, 10 * tolerance);
    ASSERT_EQ(summary.stop_reason, StopReason::kConverged) << tolerance;
    ASSERT_GE(summary.trace.size(), 2U);
    const double before = summary.trace[summary.trace.size() - 2].objective;
    EXPECT_GT(summary.trace.back().objective, (1 - 10 * tolerance) * before) << tolerance;
  }
}

TEST(MultistartOnly, SaysHowManyStartsAgree) {
  const Objective objective = NoisyObjective(ModelSpec::SharedFactors(3, kGrid));
  FactorModel model = RandomModel(objective.spec(), 1);
  SolverOptions options = Iterations(5);
  options.starts = 6;
  const SolverSummary summary = MakeSolver("multistart")->Solve(objective, options, &model);
  const Minima minima{.starts = summary.starts};
  EXPECT_EQ(minima.starts.front().minimum, 1);
  EXPECT_THAT(summary.notes, testing::ElementsAre(minima.Describe()));
}

// Each start of the same small problem leads to the one minimum that it has.
TEST(MultistartOnly, EndsWhereRandomStartsAgree) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const FactorModel truth = RandomModel(spec, 2, 0.5);
  BrdfTable table = TableOf(truth, kGrid);
  Random random(3);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(0.01);
  }
  const Objective objective = MakeObjective(table, spec, "compressive");
  FactorModel model = RandomModel(spec, 1);
  SolverOptions options = Iterations(100);
  options.starts = 100;
  const SolverSummary summary = MakeSolver("multistart")->Solve(objective, options, &model);
  EXPECT_EQ(summary.starts.size(), 16U);  // eight of them are random
  EXPECT_TRUE((Minima{.starts = summary.starts}.Enough()));
  EXPECT_THAT(Names(summary), testing::Contains(testing::StartsWith("dogleg/")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
