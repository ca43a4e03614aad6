#include "fit/prune/model_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "model/objective/gauge.h"
#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kPlenty = 10000;

// Smooth tables, which differ by lobe and by channel as far as the spec lets them.
FactorModel Material(const ModelSpec& spec) {
  FactorModel model(spec);
  std::ranges::fill(model.d(), 0.1);
  constexpr double kWidths[] = {1.5, 5};
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const int D = spec.table(Factor::kD, m, c), F = spec.table(Factor::kF, m, c),
                G = spec.table(Factor::kG, m, c);
      const double width = kWidths[m % 2] * (spec.D.per_channel ? 1 + 0.4 * c : 1);
      const double grazing = spec.F.per_channel ? 1 + c : 2;
      model.s(m)[c] = m + 1;
      for (int k = 0; k < spec.d_axis.size; ++k) {
        model.table(Factor::kD, D)[k] = std::exp(-std::pow(k / width, 2)) / width;
      }
      for (int k = 0; k < spec.f_axis.size; ++k) {
        const double t = (k + 0.5) / spec.f_axis.size;
        // One lobe rises towards grazing angles, the other falls.
        const bool falls = spec.F.per_lobe && m % 2 == 1;
        model.table(Factor::kF, F)[k] = falls ? 1.3 - t : 0.3 + grazing * t * t;
      }
      for (int k = 0; k < spec.g_axis.size; ++k) {
        model.table(Factor::kG, G)[k] = std::cos((k + 0.5) / spec.g_axis.size * (0.3 + 0.5 * m));
      }
    }
  }
  return model;
}

ModelSpec Spec(int lobes) { return ModelSpec::SharedFactors(lobes, kGrid); }

ModelSpec FByLobe() {
  ModelSpec spec = Spec(2);
  spec.F.per_lobe = true;
  return spec;
}

ModelSpec DByChannel() {
  ModelSpec spec = Spec(2);
  spec.D.per_channel = true;
  return spec;
}

BrdfTable Noisy(BrdfTable table, double sigma) {
  Random random(1);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(sigma);
  }
  return table;
}

double ScoreOf(double E) { return -10 * std::log10(E); }  // [dB]

// A measurement, and a model fitted to it.
struct Fit {
  Fit(const BrdfTable& measured, const ModelSpec& spec, int iterations = 20, int num_threads = 1)
      : objective(MakeObjective(measured, spec, "compressive", num_threads)),
        model(InitialModels().front().make(objective, 1)) {
    MakeSolver("varpro")->Solve(objective, {.max_iterations = iterations, .diagnose = false},
                                &model);
    Canonicalize(objective.coverage(), &model);
  }
  double E() const { return objective.Value(model); }
  // The lowest E wins.
  ModelChoiceOptions ByE(int max_parameters) const {
    return {.max_parameters = max_parameters, .judge = [this](const FactorModel& candidate) {
              return ScoreOf(Objective(objective, candidate.spec()).Value(candidate));
            }};
  }
  ChosenModel Choose(int max_parameters) const {
    return ChooseModel(objective, model, ByE(max_parameters));
  }

  Objective objective;
  FactorModel model;
};

Fit MakeFit() { return {Noisy(TableOf(Material(FByLobe()), kGrid), 0.01), Spec(2)}; }

// Checks that hold for any choice.
void ExpectConsistent(const Fit& fit, const ChosenModel& result, int max_parameters) {
  ASSERT_FALSE(result.candidates.empty());
  const Candidate& first = result.candidates[0];
  EXPECT_EQ(first.name, "as fitted");
  const ModelSpec& own = fit.model.spec();
  EXPECT_EQ(first.num_parameters, TableLayout::Full(own).num_parameters(own));
  EXPECT_EQ(first.E, fit.E());
  for (const Candidate& candidate : result.candidates) {
    EXPECT_GE(candidate.seconds, 0) << candidate.name;
    EXPECT_GT(candidate.num_parameters, 0) << candidate.name;
  }
  ASSERT_GE(result.chosen, 0);
  ASSERT_LT(result.chosen, static_cast<int>(result.candidates.size()));
  const Candidate& chosen = result.candidates[result.chosen];
  EXPECT_LE(chosen.num_parameters, max_parameters);
  CheckLayout(result.layout, result.model.spec());
  EXPECT_EQ(chosen.num_parameters, result.layout.num_parameters(result.model.spec()));
  EXPECT_NEAR(chosen.E, Objective(fit.objective, result.model.spec()).Value(result.model),
              1e-11 * chosen.E);
  // The model is what its stored parameters say.
  FactorModel expanded = result.model;
  ExpandStored(result.layout, &expanded);
  EXPECT_TRUE(std::ranges::equal(expanded.parameters(), result.model.parameters()));
}

// If the judge decides, no stored candidate within the budget has a higher score.
void ExpectBestOfThoseWithin(const ChosenModel& result, int max_parameters) {
  for (const Candidate& candidate : result.candidates) {
    // One that was only fitted is not stored yet: its ends are not tied, its scale is not fixed.
    const bool stored = candidate.name.starts_with("as fitted") ||
                        candidate.name.ends_with(", thinned") ||
                        candidate.name.ends_with(", finished");
    if (!stored || candidate.num_parameters > max_parameters) continue;
    EXPECT_GE(result.candidates[result.chosen].score, candidate.score) << candidate.name;
  }
}

TEST(ModelChoice, NeverExceedsTheBudget) {
  const Fit fit = MakeFit();
  const int own = fit.model.spec().num_parameters();
  double E = 0;
  for (const int parameters : {kPlenty, own + 8, own, own - 1, 50, 25, 12, 5, 1}) {
    SCOPED_TRACE(parameters);
    const ChosenModel result = fit.Choose(parameters);
    ExpectConsistent(fit, result, parameters);
    ExpectBestOfThoseWithin(result, parameters);
    const Candidate& chosen = result.candidates[result.chosen];
    EXPECT_NEAR(chosen.score, ScoreOf(chosen.E), 1e-9);  // E of stretched ones is summed otherwise
    EXPECT_GE(chosen.E, E);                              // fewer parameters reach no less
    E = 0.98 * chosen.E;                                 // but for where each thinning ends
  }
}

TEST(ModelChoice, TheJudgeDecides) {
  const Fit fit = MakeFit();
  // One that likes lobes more than E, though E is worse.
  ModelChoiceOptions options = {.max_parameters = kPlenty, .judge = [](const FactorModel& model) {
                                  return model.spec().lobes;
                                }};
  options.stop = nullptr;  // a null function never stops
  EXPECT_EQ(ChooseModel(fit.objective, fit.model, options).model.spec().lobes, 3);
  // If the judge sees no difference, the fitted model is good enough.
  options.judge = [](const FactorModel&) { return 1.0; };
  ChosenModel result = ChooseModel(fit.objective, fit.model, options);
  EXPECT_EQ(result.chosen, 0);
  EXPECT_TRUE(std::ranges::equal(result.model.parameters(), fit.model.parameters()));
  // The judge says NaN for some.
  options.judge = [](const FactorModel& model) {
    return model.spec().D.per_channel ? 2.0 : std::nan("");
  };
  result = ChooseModel(fit.objective, fit.model, options);
  EXPECT_TRUE(result.model.spec().D.per_channel);
  EXPECT_EQ(result.candidates[0].score, -kInfinity);
  // The judge says NaN for all.
  options.judge = [](const FactorModel&) { return std::nan(""); };
  EXPECT_EQ(ChooseModel(fit.objective, fit.model, options).chosen, 0);
  // A judge is required.
  options.judge = nullptr;
  EXPECT_THAT(ErrorOf([&] { ChooseModel(fit.objective, fit.model, options); }),
              IsError(ErrorKind::kMissing, {.key = "judge"}));
}

TEST(ModelChoice, FindsWhatTheDataDoNotShare) {
  for (const ModelSpec& truth : {FByLobe(), DByChannel()}) {
    SCOPED_TRACE(truth.F.per_lobe ? "F by lobe" : "D by channel");
    const Fit fit(Noisy(TableOf(Material(truth), kGrid), 1e-3), Spec(2));
    const ChosenModel all = fit.Choose(kPlenty);
    ExpectConsistent(fit, all, kPlenty);
    EXPECT_TRUE(all.model.spec().F.per_lobe && all.model.spec().D.per_channel);
    EXPECT_LT(all.candidates[all.chosen].E, 0.1 * fit.E());
    // No more parameters than the fitted model has.
    const int parameters = fit.model.spec().num_parameters();
    const ChosenModel same = fit.Choose(parameters);
    ExpectConsistent(fit, same, parameters);
    EXPECT_LT(same.candidates[same.chosen].E, 0.5 * fit.E());
  }
}

// The best candidate, be it the fit or a form of it, is tried with one more lobe.
TEST(ModelChoice, TheBestGetsALobeMore) {
  const Fit fit = MakeFit();
  for (const bool likes_sharing : {true, false}) {
    ModelChoiceOptions options = {
        .max_parameters = kPlenty, .judge = [likes_sharing](const FactorModel& model) {
          const ModelSpec& spec = model.spec();
          return spec.lobes == 2 && spec.D.per_channel != likes_sharing ? 1 : 0;
        }};
    const ChosenModel result = ChooseModel(fit.objective, fit.model, options);
    std::vector<std::string> with_a_lobe_more;
    for (const Candidate& candidate : result.candidates) {
      if (candidate.name.ends_with("a lobe more")) with_a_lobe_more.push_back(candidate.name);
    }
    EXPECT_THAT(
        with_a_lobe_more,
        ElementsAre(likes_sharing ? "a lobe more" : "F by lobe, D by channel, a lobe more"));
  }
}

// A form that is stored as a whole is in canonical form, and well behaved at the edge of the data.
TEST(ModelChoice, FinishesWhatItDoesNotThin) {
  const MerlGrid grid{.theta_h = 16, .theta_d = 18, .phi_d = 20};
  const ModelSpec spec = ModelSpec::SharedFactors(2, grid);
  BrdfTable measured = Noisy(TableOf(Material(spec), grid), 0.02);
  LimitAngles(DegreesToRadians(75), Unmeasured::kBeyondMaxAngle, &measured);
  const Fit fit(measured, spec);
  const ModelChoiceOptions options = {
      .max_parameters = kPlenty,
      .judge = [](const FactorModel& model) { return model.spec().D.per_channel ? 1.0 : 0.0; }};
  const ChosenModel result = ChooseModel(fit.objective, fit.model, options);
  ASSERT_EQ(result.candidates[result.chosen].name, "F by lobe, D by channel, finished");

  const Objective objective(fit.objective, result.model.spec());
  FactorModel canonical = result.model;
  Canonicalize(objective.coverage(), &canonical);
  for (size_t k = 0; k < canonical.parameters().size(); ++k) {
    const double x = result.model.parameters()[k];
    EXPECT_NEAR(canonical.parameters()[k], x, 1e-12 * x) << k;
  }
  for (int t = 0; t < result.model.spec().num_tables(Factor::kG); ++t) {
    const auto G = result.model.table(Factor::kG, t);
    int last = spec.g_axis.size - 1;
    while (objective.coverage()[result.model.TableOffset(Factor::kG, t) + last] == 0) --last;
    ASSERT_LT(last, spec.g_axis.size - 1);
    EXPECT_EQ(G[last], G[last - 1]) << t;
  }
}

// A candidate that looks better may lose where no data are: 3 dB, or half of its gain if that is
// more.
TEST(ModelChoice, WhatRunsWildBeyondTheDataIsNotTaken) {
  const Fit fit = MakeFit();
  struct Case {
    double gain, loss;
    bool fails_beyond;
  };
  for (const auto& [gain, loss, fails_beyond] :
       {Case{1, 2.9, false}, Case{1, 3.1, true}, Case{8, 3.9, false}, Case{8, 4.1, true}}) {
    const ModelChoiceOptions options = {
        .max_parameters = kPlenty,
        .judge = [gain = gain](
                     const FactorModel& model) { return model.spec().D.per_channel ? gain : 0.0; },
        .judge_beyond =
            [loss = loss](const FactorModel& model) {
              return model.spec().D.per_channel ? 20 - loss : 20.0;
            }};
    const ChosenModel result = ChooseModel(fit.objective, fit.model, options);
    EXPECT_EQ(result.candidates.back().fails_beyond, fails_beyond)
        << gain << " dB more, " << loss << " less";
    EXPECT_EQ(result.model.spec().D.per_channel, !fails_beyond);
  }
}

// Rings rule a candidate out, whatever its score. Here the data have the ring: no smoother form
// fits.
TEST(ModelChoice, WhatHasRingsUnderEvenLightIsNotTaken) {
  constexpr MerlGrid kFine{.theta_h = 8, .theta_d = 30, .phi_d = 8};
  FactorModel material(ModelSpec::SharedFactors(1, kFine));
  std::ranges::fill(material.parameters(), 1.0);
  std::ranges::fill(material.d(), 0.01);
  for (int k = 0; k < 8; ++k) material.table(Factor::kD, 0)[k] = std::exp(-k);
  for (const double share : {1.0, 2.0}) {
    material.table(Factor::kG, 0)[15] = share;
    const Fit fit(TableOf(material, kFine), material.spec());
    const auto by_channel = [](const FactorModel& model) {
      return model.spec().D.per_channel ? 20.0 : 0.0;
    };
    const ChosenModel result =
        ChooseModel(fit.objective, fit.model, {.max_parameters = kPlenty, .judge = by_channel});
    EXPECT_EQ(result.candidates.back().has_rings, share > 1);
    EXPECT_EQ(result.model.spec().D.per_channel, share == 1);
  }
}

// Pictures interpolate between entries that samples read and neighbours that none reads.
TEST(ModelChoice, JudgesFormsWithWhatNoSampleReadsContinued) {
  BrdfTable measured = Noisy(TableOf(Material(FByLobe()), kGrid), 0.01);
  LimitAngles(DegreesToRadians(50), Unmeasured::kBeyondMaxAngle, &measured);
  const Fit fit(measured, Spec(2));
  FactorModel start = fit.model;
  for (size_t k = 0; k < start.parameters().size(); ++k) {
    if (!(fit.objective.coverage()[k] > 0)) start.parameters()[k] = 1e3;
  }
  int judged = 0;
  const ModelChoiceOptions options = {
      .max_parameters = kPlenty, .judge = [&](const FactorModel& model) {
        if (++judged == 1) return 0.0;  // the start, as it was given
        const Objective objective(fit.objective, model.spec());
        FactorModel canonical = model;
        Canonicalize(objective.coverage(), &canonical);
        for (size_t k = 0; k < model.parameters().size(); ++k) {
          EXPECT_NEAR(model.parameters()[k], canonical.parameters()[k],
                      1e-6 * canonical.parameters()[k])
              << "candidate " << judged << ", parameter " << k;
        }
        return 0.0;
      }};
  ChooseModel(fit.objective, start, options);
  EXPECT_GT(judged, 3);
}

// The mean log error where nothing was measured of what was.
double ErrorBeyond(const FactorModel& model, const BrdfTable& measured) {
  const BrdfTable said = Reconstruct(model, "model", measured.grid);
  const std::vector<bool> above = BinsAboveSurface(measured.grid);
  double sum = 0;
  int count = 0;
  for (int bin = 0; bin < measured.grid.size(); ++bin) {
    if (!above[bin] || ReasonOf(measured, bin) == Unmeasured::kNo) continue;
    const Cosines cosines = ToCosines(measured.grid.Center(bin));
    for (int c = 0; c < kChannels; ++c, ++count) {
      const auto log = [&](double rho) { return std::log(rho * cosines.i * cosines.o + 1e-3); };
      sum += std::abs(log(said.Value(c, bin)) - log(measured.Value(c, bin)));
    }
  }
  return sum / count;
}

// Beyond the data, a form and its thinned version continue about as the fit does: neither fails
// there where tables are constant beyond the last node of a thinned table, or few samples read an
// entry.
TEST(ModelChoice, FormsGoOnBeyondTheData) {
  BrdfTable measured = Noisy(TableOf(Material(FByLobe()), kGrid), 0.01);
  LimitAngles(DegreesToRadians(50), Unmeasured::kBeyondMaxAngle, &measured);
  const Fit fit(measured, Spec(2));
  const double of_fit = ErrorBeyond(fit.model, measured);
  const int own = fit.model.spec().num_parameters();
  for (const int budget : {kPlenty, own, own - 12}) {
    ModelChoiceOptions options = fit.ByE(budget);
    options.judge = [by_E = options.judge](const FactorModel& candidate) {
      return 100 * by_E(candidate);  // so that small gains are worth it
    };
    const ChosenModel chosen = ChooseModel(fit.objective, fit.model, options);
    ExpectConsistent(fit, chosen, budget);
    const Candidate& best = chosen.candidates[chosen.chosen];
    EXPECT_NE(best.name, "as fitted");
    EXPECT_LT(ErrorBeyond(chosen.model, measured), 1.5 * of_fit) << budget << ": " << best.name;
  }
}

TEST(ModelChoice, AModelThatHasTheFormStaysAsItIs) {
  // The fit is exact already: nothing is gained, and the first of equals is chosen.
  const FactorModel truth = Material(Spec(1));
  Fit fit(TableOf(truth, kGrid), Spec(1), 60);
  ModelChoiceOptions options = fit.ByE(kPlenty);
  options.judge = [&](const FactorModel& candidate) {
    return -std::round(1e6 * Objective(fit.objective, candidate.spec()).Value(candidate) /
                       fit.objective.MeasuredEnergy());
  };
  const ChosenModel result = ChooseModel(fit.objective, fit.model, options);
  EXPECT_EQ(result.chosen, 0);
  EXPECT_EQ(result.layout, TableLayout::Full(Spec(1)));
}

TEST(ModelChoice, TriesWhatTheSpecAllows) {
  // Forms of the fit, or of the stretched one; that with a lobe more, of the best.
  const auto names_from = [](const ModelSpec& spec) {
    const Fit fit(RandomTable(kGrid, 1), spec, 2);
    std::vector<std::string> names;
    for (const Candidate& candidate : fit.Choose(kPlenty).candidates) {
      std::string name = candidate.name;
      if (name.ends_with(", thinned") || name.ends_with(", finished")) continue;
      if (name.ends_with("a lobe more")) name = "a lobe more";
      // Whether a second way to stretches ends lower than the first, noise decides.
      if (name == "stretched anew") continue;
      for (const std::string base : {"stretched, ", "stretched anew, "}) {
        if (name.starts_with(base)) name.erase(0, base.size());
      }
      if (std::ranges::count(names, name) == 0) names.push_back(name);
    }
    return names;
  };
  EXPECT_THAT(names_from(Spec(0)), ElementsAre("as fitted"));
  EXPECT_THAT(names_from(Spec(1)),
              ElementsAre("as fitted", "stretched", "D by channel", "a lobe more"));
  EXPECT_THAT(names_from(Spec(2)),
              ElementsAre("as fitted", "stretched", "F by lobe, D by channel", "a lobe more"));
  ModelSpec spec = Spec(2);
  spec.D.per_lobe = false;  // lobes that share D cannot be split
  EXPECT_THAT(names_from(spec), ElementsAre("as fitted", "stretched", "F by lobe, D by channel"));
  spec = Spec(2);
  spec.D = spec.F = spec.G = {.per_lobe = true, .per_channel = true};
  EXPECT_THAT(names_from(spec), ElementsAre("as fitted", "stretched", "a lobe more"));
  EXPECT_THAT(names_from(ModelSpec::IndependentG(kGrid)),
              ElementsAre("as fitted", "stretched", "a lobe more"));
  if (kSanitized) return;
  EXPECT_THAT(names_from(Spec(8)),
              ElementsAre("as fitted", "stretched", "F by lobe, D by channel"));
}

TEST(ModelChoice, AnySpecKeepsToAnyBudget) {
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    if (named.spec.lobes > (kSanitized ? 2 : 3)) continue;
    for (const int parameters : {40, 2}) {
      SCOPED_TRACE(named.name + ", " + std::to_string(parameters));
      const Fit fit(RandomTable(kGrid, 1), named.spec, 2);
      ExpectConsistent(fit, fit.Choose(parameters), parameters);
    }
  }
}

TEST(ModelChoice, StopAtOnceLeavesTheFittedModel) {
  const Fit fit = MakeFit();
  const int own = fit.model.spec().num_parameters();
  ModelChoiceOptions options = fit.ByE(own);
  options.stop = [] { return true; };
  ChosenModel result = ChooseModel(fit.objective, fit.model, options);
  ExpectConsistent(fit, result, own);
  EXPECT_EQ(result.candidates.size(), 1U);
  EXPECT_TRUE(std::ranges::equal(result.model.parameters(), fit.model.parameters()));
  // A budget is kept to nevertheless.
  for (const int parameters : {own - 1, 20, 3, 1}) {
    SCOPED_TRACE(parameters);
    options.max_parameters = parameters;
    result = ChooseModel(fit.objective, fit.model, options);
    ExpectConsistent(fit, result, parameters);
    for (const Candidate& candidate : result.candidates) {
      EXPECT_THAT(candidate.name, StartsWith("as fitted"));
    }
  }
}

TEST(ModelChoice, StopAtAnyTimeLeavesTheBestSoFar) {
  const Fit fit = MakeFit();
  const int parameters = fit.model.spec().num_parameters() - 10;
  ModelChoiceOptions options = fit.ByE(parameters);
  int asked = 0;
  options.stop = [&asked] { return ++asked, false; };
  const size_t in_all = ChooseModel(fit.objective, fit.model, options).candidates.size();
  const int times = asked;
  size_t fewest = in_all;
  for (int after = 1; after < times; after += times / 12 + 1) {
    SCOPED_TRACE(after);
    asked = 0;
    int judged = 0, judged_before = 0;
    options.judge = [&, by_E = fit.ByE(parameters).judge](const FactorModel& candidate) {
      ++judged;
      return by_E(candidate);
    };
    options.stop = [&] {
      if (++asked <= after) judged_before = judged;
      return asked > after;
    };
    const ChosenModel result = ChooseModel(fit.objective, fit.model, options);
    ExpectConsistent(fit, result, parameters);
    ExpectBestOfThoseWithin(result, parameters);
    EXPECT_LE(judged, judged_before + 1);  // the one that was in the works
    EXPECT_LE(result.candidates.size(), in_all);
    fewest = std::min(fewest, result.candidates.size());
  }
  EXPECT_LT(fewest, in_all);
}

TEST(ModelChoice, TheSameBitsForAnyNumberOfThreads) {
  const BrdfTable measured = Noisy(TableOf(Material(FByLobe()), kGrid), 0.01);
  const Fit one(measured, Spec(2));
  const int parameters = one.model.spec().num_parameters();
  const ChosenModel expected = one.Choose(parameters);
  for (const int threads : {2, 3}) {
    const Fit fit(measured, Spec(2), 20, threads);
    const ChosenModel result = fit.Choose(parameters);
    EXPECT_EQ(result.chosen, expected.chosen);
    EXPECT_EQ(result.layout, expected.layout);
    EXPECT_TRUE(std::ranges::equal(result.model.parameters(), expected.model.parameters()));
    ASSERT_EQ(result.candidates.size(), expected.candidates.size());
    for (size_t k = 0; k < result.candidates.size(); ++k) {
      EXPECT_EQ(result.candidates[k].name, expected.candidates[k].name);
      EXPECT_EQ(result.candidates[k].num_parameters, expected.candidates[k].num_parameters);
      EXPECT_EQ(result.candidates[k].E, expected.candidates[k].E);
      EXPECT_EQ(result.candidates[k].score, expected.candidates[k].score);
    }
  }
}

TEST(ModelChoice, AModelFileKeepsWhatWasChosen) {
  // Data that end, so that there are unobserved entries.
  BrdfTable measured = Noisy(TableOf(Material(FByLobe()), kGrid), 0.01);
  LimitAngles(DegreesToRadians(70), Unmeasured::kBeyondMaxAngle, &measured);
  const Fit fit(measured, Spec(2));
  const TestDirectory directory;
  for (const int parameters : {kPlenty, 50, 12}) {
    SCOPED_TRACE(parameters);
    const ChosenModel chosen = fit.Choose(parameters);
    ExpectConsistent(fit, chosen, parameters);
    ASSERT_GT(chosen.model.spec().lobes, 0);
    const Objective objective(fit.objective, chosen.model.spec());
    WriteModel({chosen.model, UnobservedParameters(objective.coverage()), {}, chosen.layout},
               directory.Path("model.json"));
    const ModelFile file = ReadModel(directory.Path("model.json"));
    EXPECT_EQ(file.model.spec(), chosen.model.spec());
    EXPECT_EQ(file.layout.value_or(TableLayout::Full(chosen.model.spec())), chosen.layout);
    EXPECT_EQ(objective.Value(file.model), chosen.candidates[chosen.chosen].E);
    Random random(1);
    for (int k = 0; k < 100; ++k) {
      const DirectionPair pair = ToDirections(
          HalfDiffAngles{random.Uniform(0, 0.7), random.Uniform(0, 0.7), random.Uniform(0, kPi)});
      EXPECT_EQ(Evaluate(file.model, pair), Evaluate(chosen.model, pair));
    }
  }
}

TEST(ModelChoice, DegenerateMeasurements) {
  BrdfTable black = RandomTable(kGrid, 1);
  for (auto& plane : black.stored) {
    for (double& x : plane) x = std::min(x, 0.0);
  }
  const BrdfTable spiky = RandomTable(kGrid, 1, /*lost=*/0.6, /*sigma=*/10);
  for (const BrdfTable& measured : {black, spiky}) {
    const Fit fit(measured, Spec(2), 5);
    for (const int parameters : {kPlenty, 30, 4}) {
      SCOPED_TRACE(measured.Value(0, 0) == 0 ? "black" : "spiky");
      ExpectConsistent(fit, fit.Choose(parameters), parameters);
    }
  }
}

TEST(ModelChoice, ScatteredSamples) {
  const BrdfSamples samples = Scattered(ValidSamples(TableOf(Material(FByLobe()), kGrid)));
  Fit fit = MakeFit();
  fit.objective = Objective(samples, Spec(2), FindWeighting("compressive"));
  for (const int parameters : {kPlenty, 60}) {
    SCOPED_TRACE(parameters);
    const ChosenModel result = fit.Choose(parameters);
    ExpectConsistent(fit, result, parameters);
    EXPECT_LT(result.candidates[result.chosen].E, fit.E());
  }
}

TEST(ModelChoice, ABudgetBelowOneIsAnError) {
  const Fit fit(RandomTable(kGrid, 1), Spec(0), 1);
  for (const int parameters : {0, -1, std::numeric_limits<int>::min()}) {
    EXPECT_THAT(ErrorOf([&] { fit.Choose(parameters); }),
                IsError(ErrorKind::kRange, {.key = "max_parameters"}))
        << parameters;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
