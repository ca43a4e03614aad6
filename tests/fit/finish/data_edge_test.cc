#include "fit/finish/data_edge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "model/objective/gauge.h"
#include "tests/fit/finish/fitted.h"
#include "tests/test_util.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Fine enough that the coverage falls steeply towards the edge of the data.
constexpr MerlGrid kGrid{.theta_h = 16, .theta_d = 18, .phi_d = 20};

// A smooth material, each value multiplied by log-normal noise, that is measured up to an angle.
BrdfTable Measured(int lobes, double max_degrees, double noise = 0.01) {
  FactorModel model(ModelSpec::SharedFactors(lobes, kGrid));
  const ModelSpec& spec = model.spec();
  std::ranges::fill(model.d(), 0.1);
  for (int m = 0; m < lobes; ++m) {
    std::ranges::fill(model.s(m), 1 + m);
    const auto D = model.table(Factor::kD, m), G = model.table(Factor::kG, m);
    for (int k = 0; k < spec.d_axis.size; ++k) D[k] = std::exp(-std::pow(k / (3.0 + 4 * m), 2));
    for (int k = 0; k < spec.g_axis.size; ++k) {
      G[k] = std::cos((k + 0.5) / spec.g_axis.size * (0.5 + m));
    }
  }
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    const auto F = model.table(Factor::kF, t);
    for (int k = 0; k < spec.f_axis.size; ++k) {
      F[k] = 0.2 + std::pow((k + 0.5) / spec.f_axis.size, 5);
    }
  }
  BrdfTable table = TableOf(model, kGrid);
  Random random(1);
  for (auto& plane : table.stored) {
    for (double& x : plane) x *= random.LogNormal(noise);
  }
  LimitAngles(DegreesToRadians(max_degrees), Unmeasured::kBeyondMaxAngle, &table);
  return table;
}

FactorModel Fitted(const Objective& objective) { return trilobe::Fitted(objective, 25); }

bool SameBits(const FactorModel& a, const FactorModel& b) {
  return std::ranges::equal(a.parameters(), b.parameters());
}

// The observed entries at the end of a table that are read by so little weight that they are to be
// tied: [begin, end). Empty where the table is observed up to its end.
struct Tail {
  int begin, end;
};
Tail PoorTail(std::span<const double> coverage) {
  int end = static_cast<int>(coverage.size());
  while (end > 0 && coverage[end - 1] == 0) --end;
  if (end == static_cast<int>(coverage.size())) return {end, end};
  int begin = end;
  while (begin >= 4 && begin > end - 8 && coverage[begin - 1] < 0.05 * coverage[begin - 4]) --begin;
  return {begin, end};
}

// How many entries of the tables of a factor are to be tied, and how many of these are as the last
// one before them, to the bit or next to it.
struct Ties {
  int wanted = 0, made = 0;
};
Ties CountTies(const Objective& objective, const FactorModel& model, Factor factor) {
  Ties ties;
  for (int t = 0; t < model.spec().num_tables(factor); ++t) {
    const std::span<const double> table = model.table(factor, t);
    const Tail tail = PoorTail(
        std::span(objective.coverage()).subspan(model.TableOffset(factor, t), table.size()));
    for (int k = tail.begin; k < tail.end; ++k) {
      ++ties.wanted;
      if (table[k] == table[tail.begin - 1]) ++ties.made;
    }
  }
  return ties;
}

// The largest rho cos theta of the bins above the surface that are not measured, as the model is
// continued there.
double LargestBeyond(const Objective& objective, const BrdfTable& measured, FactorModel model) {
  Canonicalize(objective.coverage(), &model);
  const BrdfTable all = Reconstruct(model, "model", kGrid);
  double largest = 0;
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    if (ReasonOf(measured, bin) == Unmeasured::kNo) continue;
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    for (int c = 0; c < kChannels; ++c) {
      largest = std::max(largest, all.Value(c, bin) * std::max(cosines.i, cosines.o));
    }
  }
  return largest;
}

double Largest(const BrdfTable& measured) {
  const BrdfSamples samples = ValidSamples(measured);
  double largest = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = ToCosines(samples.Angles(j));
    largest = std::max(largest, std::ranges::max(samples.rho[j]) * std::max(cosines.i, cosines.o));
  }
  return largest;
}

TEST(DataEdge, FullDataLeaveNothingToDo) {
  const Objective objective = MakeObjective(Measured(2, 90), ModelSpec::SharedFactors(2, kGrid));
  FactorModel model = Fitted(objective);
  const FactorModel before = model;
  EXPECT_FALSE(TieEntriesAtDataEdge(objective, &model));
  EXPECT_TRUE(SameBits(model, before));
}

TEST(DataEdge, TiesWhatFewSamplesRead) {
  for (const double max_degrees : {60, 75, 80}) {
    for (const int lobes : {1, 2}) {
      SCOPED_TRACE(std::to_string(lobes) + " lobes, " + std::to_string(max_degrees));
      const Objective objective =
          MakeObjective(Measured(lobes, max_degrees), ModelSpec::SharedFactors(lobes, kGrid));
      FactorModel model = Fitted(objective);
      const double E = objective.Value(model);
      ASSERT_TRUE(TieEntriesAtDataEdge(objective, &model));
      EXPECT_LE(objective.Value(model), 1.05 * E);
      int wanted = 0;
      for (const Factor factor : kFactors) {
        const Ties ties = CountTies(objective, model, factor);
        EXPECT_EQ(ties.made, ties.wanted) << FactorName(factor);
        wanted += ties.wanted;
      }
      EXPECT_GT(wanted, 0);
    }
  }
}

// The case that the step is for: nodes at the edge trade huge values, which the data hardly see.
TEST(DataEdge, AHugeNodeAtTheEdgeIsTamed) {
  const BrdfTable measured = Measured(2, 75);
  const Objective objective = MakeObjective(measured, ModelSpec::SharedFactors(2, kGrid));
  const FactorModel fitted = Fitted(objective);
  FactorModel huge = fitted;
  for (int t = 0; t < huge.spec().num_tables(Factor::kG); ++t) {
    const auto G = huge.table(Factor::kG, t);
    const Tail tail = PoorTail(
        std::span(objective.coverage()).subspan(huge.TableOffset(Factor::kG, t), G.size()));
    ASSERT_GT(tail.end, tail.begin);
    for (int k = tail.begin; k < tail.end; ++k) G[k] *= 1000;
  }
  FactorModel overshoot = huge;
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &overshoot));
  EXPECT_LE(objective.Value(overshoot), 1.05 * objective.Value(fitted));
  EXPECT_GT(LargestBeyond(objective, measured, huge), 100 * Largest(measured));
  EXPECT_LT(LargestBeyond(objective, measured, overshoot), 3 * Largest(measured));
}

// If the model will be refitted anyway, the refit may end once E is back.
TEST(DataEdge, MayEndOnceEIsBack) {
  const Objective objective = MakeObjective(Measured(2, 75), ModelSpec::SharedFactors(2, kGrid));
  const FactorModel fitted = Fitted(objective);
  int asked[2] = {};
  double E[2];
  for (const TieRefit refit : {TieRefit::kUntilSettled, TieRefit::kUntilBack}) {
    const auto k = static_cast<int>(refit);
    FactorModel model = fitted;
    ASSERT_TRUE(TieEntriesAtDataEdge(
        objective, &model, [&] { return ++asked[k] < 0; }, refit));
    E[k] = objective.Value(model);
    EXPECT_LE(E[k], 1.05 * objective.Value(fitted));
    for (const Factor factor : kFactors) {
      const Ties ties = CountTies(objective, model, factor);
      EXPECT_EQ(ties.made, ties.wanted);
    }
  }
  EXPECT_LT(asked[1], asked[0]);
  EXPECT_GE(E[1], E[0]);
}

// A model that is as it was, or tied and no worse than it may be, whenever the stop comes.
TEST(DataEdge, StopsBetweenSteps) {
  const Objective objective = MakeObjective(Measured(2, 75), ModelSpec::SharedFactors(2, kGrid));
  const FactorModel fitted = Fitted(objective);
  const double E = objective.Value(fitted);
  int asked = 0;
  FactorModel whole = fitted;
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &whole, [&] { return ++asked < 0; }));
  ASSERT_GT(asked, 2);
  int kept = 0;
  for (int stop_at = 1; stop_at <= asked; ++stop_at) {
    int times = 0;
    FactorModel model = fitted;
    const bool tied = TieEntriesAtDataEdge(objective, &model, [&] { return ++times >= stop_at; });
    EXPECT_LE(times, stop_at + 2) << "one a rule that is left, at most";
    if (!tied) {
      EXPECT_TRUE(SameBits(model, fitted)) << stop_at;
      continue;
    }
    ++kept;
    EXPECT_LE(objective.Value(model), 1.05 * E) << stop_at;
    for (const Factor factor : kFactors) {
      const Ties ties = CountTies(objective, model, factor);
      EXPECT_EQ(ties.made, ties.wanted) << stop_at;
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, asked);
}

// Tables that are not smooth have no fit that is like theirs and tied.
TEST(DataEdge, WhatWouldBeDearStaysToTheBit) {
  for (const double noise : {0.0, 0.01, 0.05}) {
    const FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kGrid), 1, 2);
    BrdfTable measured = TableOf(truth, kGrid);
    Random random(1);
    for (auto& plane : measured.stored) {
      for (double& x : plane) x *= random.LogNormal(noise);
    }
    LimitAngles(DegreesToRadians(75), Unmeasured::kBeyondMaxAngle, &measured);
    const Objective objective = MakeObjective(measured, truth.spec());
    int wanted = 0;
    for (const Factor factor : kFactors) wanted += CountTies(objective, truth, factor).wanted;
    ASSERT_GT(wanted, 0);
    FactorModel fitted = truth;
    MakeSolver("varpro")->Solve(objective, {.max_iterations = 10, .diagnose = false}, &fitted);
    FactorModel model = fitted;
    EXPECT_FALSE(TieEntriesAtDataEdge(objective, &model)) << noise;
    EXPECT_TRUE(SameBits(model, fitted)) << noise;
  }
}

// G alone is tied where tying D and F would cost too much E.
TEST(DataEdge, TiesShadowingAloneWhereTheOthersAreDear) {
  // D and F are rough, G is flat at the edge, and E small but not zero.
  FactorModel truth = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1, 2);
  std::ranges::fill(truth.table(Factor::kG, 0), 1.0);
  BrdfTable measured = TableOf(truth, kGrid);
  Random random(1);
  for (auto& plane : measured.stored) {
    for (double& x : plane) x *= random.LogNormal(1e-4);
  }
  LimitAngles(DegreesToRadians(75), Unmeasured::kBeyondMaxAngle, &measured);
  const Objective objective = MakeObjective(measured, truth.spec());
  FactorModel model = truth;
  MakeSolver("varpro")->Solve(objective, {.max_iterations = 10, .diagnose = false}, &model);
  const double E = objective.Value(model);
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &model));
  EXPECT_LE(objective.Value(model), 1.05 * E);
  const Ties G = CountTies(objective, model, Factor::kG);
  EXPECT_GT(G.wanted, 0);
  EXPECT_EQ(G.made, G.wanted);
  Ties others = CountTies(objective, model, Factor::kD);
  const Ties F = CountTies(objective, model, Factor::kF);
  EXPECT_GT(others.wanted + F.wanted, 0);
  EXPECT_EQ(others.made + F.made, 0);
}

TEST(DataEdge, NeverWorseByMoreThanItMayBe) {
  int changed = 0;
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    if (kSanitized && named.spec.lobes > 2) continue;
    for (const double max_degrees : {50, 80}) {
      BrdfTable measured = RandomTable(kGrid, 1);
      LimitAngles(DegreesToRadians(max_degrees), Unmeasured::kBeyondMaxAngle, &measured);
      const Objective objective = MakeObjective(measured, named.spec);
      const FactorModel before = RandomModel(named.spec, 1);
      FactorModel model = before;
      const std::string what = named.name + ", " + std::to_string(max_degrees);
      if (TieEntriesAtDataEdge(objective, &model)) {
        EXPECT_LE(objective.Value(model), 1.05 * objective.Value(before)) << what;
        EXPECT_TRUE(std::ranges::all_of(model.parameters(), [](double x) { return x >= 0; }));
        ++changed;
      } else {
        EXPECT_TRUE(SameBits(model, before)) << what;
      }
    }
  }
  EXPECT_GT(changed, 0);
}

TEST(DataEdge, TheSameBitsForAnyNumberOfThreads) {
  const BrdfTable measured = Measured(2, 75);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const FactorModel fitted = Fitted(MakeObjective(measured, spec));
  FactorModel expected = fitted;
  ASSERT_TRUE(TieEntriesAtDataEdge(MakeObjective(measured, spec), &expected));
  for (const int threads : {2, 3}) {
    FactorModel model = fitted;
    ASSERT_TRUE(
        TieEntriesAtDataEdge(MakeObjective(measured, spec, "compressive", threads), &model));
    EXPECT_TRUE(SameBits(model, expected)) << threads;
  }
}

// An entry that no sample reads may stand before those that are tied.
TEST(DataEdge, EntriesAreNotTiedToAnUnobservedOne) {
  BrdfTable measured = Measured(1, 75);
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const auto D_tail = [&] {
    const std::vector<double> coverage = MakeObjective(measured, spec).coverage();
    return PoorTail(std::span(coverage).subspan(FactorModel(spec).TableOffset(Factor::kD, 0),
                                                spec.d_axis.size));
  };
  // Three entries apart, so that neither counts as poor beside the other.
  const int unobserved = D_tail().begin - 1;
  for (const int theta_h : {unobserved, unobserved - 3}) InvalidateThetaH(theta_h, 0, &measured);
  const Tail tail = D_tail();
  ASSERT_EQ(tail.begin - 1, unobserved);
  ASSERT_GT(tail.end, tail.begin);
  const Objective objective = MakeObjective(measured, spec);
  FactorModel model = Fitted(objective);
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &model));
  const auto D = model.table(Factor::kD, 0);
  for (int k = unobserved; k < spec.d_axis.size; ++k) EXPECT_EQ(D[k], D[unobserved - 1]) << k;
}

TEST(DataEdge, NothingToTieWithoutLobesOrWeights) {
  BrdfSamples samples = ValidSamples(Measured(1, 75));
  const Weighting weighting = FindWeighting("compressive");
  const ModelSpec none = ModelSpec::SharedFactors(0, kGrid);
  FactorModel lambertian = RandomModel(none, 1);
  EXPECT_FALSE(TieEntriesAtDataEdge(Objective(samples, none, weighting), &lambertian));
  EXPECT_TRUE(SameBits(lambertian, RandomModel(none, 1)));

  samples.multiplicity.assign(samples.size(), 0);
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  FactorModel model = RandomModel(spec, 1);
  EXPECT_FALSE(TieEntriesAtDataEdge(Objective(samples, spec, weighting), &model));
  EXPECT_TRUE(SameBits(model, RandomModel(spec, 1)));
}

TEST(DataEdge, BlackDataStayFinite) {
  BrdfTable black = Measured(1, 75);
  for (auto& plane : black.stored) {
    for (double& x : plane) x = std::min(x, 0.0);
  }
  const Objective objective = MakeObjective(black, ModelSpec::SharedFactors(1, kGrid));
  for (FactorModel model : {FactorModel(objective.spec()), RandomModel(objective.spec(), 1)}) {
    const double E = objective.Value(model);
    TieEntriesAtDataEdge(objective, &model);
    EXPECT_LE(objective.Value(model), 1.05 * E);
    EXPECT_TRUE(std::ranges::all_of(model.parameters(), [](double x) { return x < 1e100; }));
  }
}

TEST(DataEdge, ScatteredSamplesToo) {
  const BrdfSamples samples = Scattered(ValidSamples(Measured(1, 75)));
  const Objective objective(samples, ModelSpec::SharedFactors(1, kGrid),
                            FindWeighting("compressive"));
  FactorModel model = RandomModel(objective.spec(), 1, 0.1);
  MakeSolver("newton")->Solve(objective, {.max_iterations = 10, .diagnose = false}, &model);
  const double E = objective.Value(model);
  ASSERT_TRUE(TieEntriesAtDataEdge(objective, &model));
  EXPECT_LE(objective.Value(model), 1.05 * E);
  const Ties ties = CountTies(objective, model, Factor::kG);
  EXPECT_GT(ties.wanted, 0);
  EXPECT_EQ(ties.made, ties.wanted);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
