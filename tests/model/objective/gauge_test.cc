#include "model/objective/gauge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/robust_line.h"
#include "model/objective/lobes.h"
#include "tests/test_util.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 10, .theta_d = 9, .phi_d = 15};

void ExpectSameModel(const FactorModel& a, const FactorModel& b, double tolerance,
                     const std::string& what) {
  ASSERT_EQ(a.parameters().size(), b.parameters().size());
  for (size_t k = 0; k < a.parameters().size(); ++k) {
    const double expected = b.parameters()[k];
    EXPECT_NEAR(a.parameters()[k], expected, tolerance * std::abs(expected))
        << what << ", parameter " << k;
  }
}

// Every sample's value, relative to the largest.
void ExpectSameValues(const Objective& objective, const FactorModel& a, const FactorModel& b,
                      const std::string& what) {
  for (const WeightedSample& sample : objective.weighted_samples()) {
    for (int c = 0; c < kChannels; ++c) {
      const double expected = UnclampedValue(b, sample.stencils, c);
      ASSERT_NEAR(UnclampedValue(a, sample.stencils, c), expected, 1e-12 * std::abs(expected))
          << what;
    }
  }
}

// A measurement that leaves D bins 0, 1, 4, 5 and 9, F bins 3 and 8 and the last G nodes unread.
BrdfTable TableWithGaps() {
  BrdfTable table = RandomTable(kGrid, 1);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    const int h = bin / (kGrid.theta_d * kGrid.phi_d), d = bin / kGrid.phi_d % kGrid.theta_d;
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    const bool gap = h <= 1 || h == 4 || h == 5 || h == 9 || d == 3 || d == 8 ||
                     std::min(cosines.i, cosines.o) < std::cos(DegreesToRadians(65));
    if (gap) table.stored[0][bin] = -1;
  }
  return table;
}

double MeanLog(std::span<const double> table) {
  double sum = 0;
  int positive = 0;
  for (const double x : table) {
    if (!(x > 0)) continue;
    sum += std::log(x);
    ++positive;
  }
  return sum / positive;
}

// Connected components: lobes and channels, in the order of s, that share tables of F or of G have
// the same number.
std::vector<int> Groups(const ModelSpec& spec) {
  std::vector<int> group(kChannels * spec.lobes);
  std::iota(group.begin(), group.end(), 0);
  for (size_t pass = 0; pass < group.size(); ++pass) {
    for (size_t i = 0; i < group.size(); ++i) {
      for (size_t j = 0; j < group.size(); ++j) {
        const auto table = [&](Factor factor, size_t k) {
          const int at = static_cast<int>(k);
          return spec.table(factor, at / kChannels, at % kChannels);
        };
        if (table(Factor::kF, i) == table(Factor::kF, j) ||
            table(Factor::kG, i) == table(Factor::kG, j)) {
          group[i] = std::min(group[i], group[j]);
        }
      }
    }
  }
  return group;
}

double WeightedMean(std::span<const double> weights, std::span<const double> table) {
  return std::inner_product(weights.begin(), weights.end(), table.begin(), 0.0) /
         std::accumulate(weights.begin(), weights.end(), 0.0);
}

double VisibleIntegral(std::span<const double> D) {
  const std::vector<double> angles = VisibleSolidAngles(static_cast<int>(D.size()));
  return std::inner_product(D.begin(), D.end(), angles.begin(), 0.0);
}

void ExpectCanonical(const Objective& objective, const FactorModel& model, const std::string& what,
                     bool ordered = true) {
  const ModelSpec& spec = model.spec();
  const std::span<const double> coverage = objective.coverage();
  const LobeLight light = ComputeLobeLight(coverage, model);
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    EXPECT_NEAR(VisibleIntegral(model.table(Factor::kD, t)), 1, 1e-12) << what;
  }
  const std::vector<int> groups = Groups(spec);
  std::vector<double> sum(groups.size()), total(groups.size());
  for (const Factor factor : {Factor::kF, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<const double> table = model.table(factor, t);
      double reflected = 0, s = 0;
      int group = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          if (!spec.serves(factor, t, m, c)) continue;
          reflected += light.lobes[m][c];
          s += model.s(m)[c];
          group = groups[kChannels * m + c];
        }
      }
      EXPECT_NEAR(reflected, 4 * s, 1e-12 * reflected) << what;
      if (reflected == 0) {
        EXPECT_NEAR(MeanLog(table), 0, 1e-12) << what;
      }
      if (factor == Factor::kG) continue;
      for (size_t k = 0; k < table.size(); ++k) {
        const double through = light.through[model.TableOffset(factor, t) + k];
        if (!(through > 0)) continue;
        sum[group] += through * std::log(table[k]);
        total[group] += through;
      }
    }
  }
  for (size_t k = 0; k < sum.size(); ++k) EXPECT_NEAR(sum[k], 0, 1e-12 * total[k]) << what;
  for (int m = 1; m < spec.lobes && ordered && !spec.stretches.several(); ++m) {
    EXPECT_LE(light.Share(m), light.Share(m - 1)) << what;
  }
}

void ExpectNormalized(const Objective& objective, const FactorModel& model,
                      const std::string& what) {
  const ModelSpec& spec = model.spec();
  const std::span<const double> coverage = objective.coverage();
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    EXPECT_NEAR(ProjectedIntegral(model.spec().d_axis, model.table(Factor::kD, t)), 1, 1e-12)
        << what;
  }
  for (const Factor factor : {Factor::kF, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = model.table(factor, t);
      const auto weights = coverage.subspan(model.TableOffset(factor, t), table.size());
      EXPECT_NEAR(WeightedMean(weights, table), 1, 1e-12) << what;
    }
  }
}

TEST(Gauge, ProjectedIntegralUsesTheTrueBinWidths) {
  // The whole projected hemisphere, and its part within theta_h < 22.5 degrees: the first half of
  // the MERL bins.
  EXPECT_NEAR(ProjectedIntegral(ModelSpec().d_axis, std::vector<double>(90, 1.0)), kPi, 1e-14);
  std::vector<double> half(90, 0.0);
  std::fill_n(half.begin(), 45, 2.0);
  EXPECT_NEAR(ProjectedIntegral(ModelSpec().d_axis, half),
              2 * kPi * std::pow(std::sin(DegreesToRadians(22.5)), 2), 1e-14);
}

TEST(Gauge, CanonicalFormChangesNoValue) {
  for (const BrdfTable& table : {RandomTable(kGrid, 1), TableWithGaps()}) {
    for (const auto& [name, spec] : TestSpecs(kGrid)) {
      const Objective objective = MakeObjective(table, spec);
      const FactorModel model = RandomModel(spec, 2, 2.0);
      FactorModel canonical = model;
      Canonicalize(objective.coverage(), &canonical);
      ExpectCanonical(objective, canonical, name);
      ExpectSameValues(objective, canonical, model, name);
      const double E = objective.Value(model);
      EXPECT_NEAR(objective.Value(canonical), E, 1e-12 * E) << name;

      FactorModel again = canonical;
      Canonicalize(objective.coverage(), &again);
      ExpectSameModel(again, canonical, 0, name);

      FactorModel normalized = model;
      NormalizeScale(objective.coverage(), &normalized);
      ExpectNormalized(objective, normalized, name);
      ExpectSameValues(objective, normalized, model, name);
    }
  }
}

// The same values by other scales of the tables, in the order of D, F and G.
FactorModel InOtherGauge(const FactorModel& model, std::span<const double> D,
                         std::span<const double> F, std::span<const double> G) {
  const ModelSpec& spec = model.spec();
  FactorModel other = model;
  for (const Factor factor : kFactors) {
    const auto by = factor == Factor::kD ? D : factor == Factor::kF ? F : G;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const double scale = by[t % by.size()];
      for (double& x : other.table(factor, t)) x *= scale;
      for (int m = 0; m < spec.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          if (!spec.serves(factor, t, m, c)) continue;
          other.s(m)[c] /= scale;
          if (factor == Factor::kG) other.s(m)[c] /= scale;
        }
      }
    }
  }
  return other;
}

// Two models that differ by gauge and by the order of their lobes have the same canonical form.
TEST(Gauge, CanonicalFormIsUnique) {
  const double D[] = {7, 0.01, 1e5}, F[] = {1e-3, 50, 2}, G[] = {3, 0.2, 11};
  for (const BrdfTable& table : {RandomTable(kGrid, 1), TableWithGaps()}) {
    for (const auto& [name, spec] : TestSpecs(kGrid)) {
      const Objective objective = MakeObjective(table, spec);
      FactorModel one = RandomModel(spec, 3);
      FactorModel other = InOtherGauge(one, D, F, G);
      Canonicalize(objective.coverage(), &one);
      Canonicalize(objective.coverage(), &other);
      ExpectSameModel(other, one, 1e-12, name);
    }
  }
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel one = RandomModel(spec, 3);
  FactorModel other = WithLobes(one, std::vector<int>{2, 0, 1});
  Canonicalize(objective.coverage(), &one);
  Canonicalize(objective.coverage(), &other);
  ExpectSameModel(other, one, 1e-12, "shuffled");

  FactorModel in_place = one;
  in_place = WithLobes(in_place, std::vector<int>{2, 0, 1});
  const FactorModel shuffled = in_place;
  Canonicalize(objective.coverage(), &in_place, LobeOrder::kAsTheyAre);
  ExpectSameModel(in_place, shuffled, 1e-12, "as they are");
}

// Scales whose products would overflow, or vanish, on the way.
TEST(Gauge, ScalesMayBeFarFromOne) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kGrid);
  const Objective objective = MakeObjective(TableWithGaps(), spec);
  FactorModel one = RandomModel(spec, 3);
  const double D[] = {1e150, 1e-120, 1e-140}, F[] = {1e-150, 1e-160, 1e-130};
  const double G[] = {1e130, 1e150, 1e140};
  FactorModel other = InOtherGauge(one, D, F, G);
  EXPECT_TRUE(std::ranges::all_of(other.parameters(), [](double x) { return std::isnormal(x); }));
  Canonicalize(objective.coverage(), &one);
  Canonicalize(objective.coverage(), &other);
  ExpectSameModel(other, one, 1e-11, "far scales");
}

// F = exp(2 k a) and G = exp(-k a) trade along a highlight: however far, s stays what is reflected.
TEST(Gauge, SIsTheAlbedoHoweverFarFAndGTrade) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  for (const double k : {0.0, 3.0, 30.0}) {
    FactorModel model(spec);
    for (double& x : model.parameters()) x = 1;
    for (int c = 0; c < kChannels; ++c) {
      for (int d = 0; d < spec.f_axis.size; ++d) {
        model.table(Factor::kF, c)[d] = std::exp(-2 * k * std::cos(spec.f_axis.Theta(d)));
      }
    }
    for (int h = 3; h < spec.d_axis.size; ++h) model.table(Factor::kD, 0)[h] = 0;
    for (int j = 0; j < spec.g_axis.size; ++j) {
      const double cosine = std::cos(spec.g_axis.Theta(j));
      model.table(Factor::kG, 0)[j] = cosine * std::exp(k * cosine);
    }
    Canonicalize(objective.coverage(), &model);
    const LobeLight light = ComputeLobeLight(objective.coverage(), model);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(4 * model.s(0)[c], light.lobes[0][c], 1e-12 * light.lobes[0][c]) << k;
    }
  }
}

// Thinned models are scaled only: their tables keep their shape beyond the data.
TEST(Gauge, TheScaleAloneLeavesUnobservedEntriesInProportion) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(TableWithGaps(), spec);
  const FactorModel model = RandomModel(spec, 4);
  FactorModel scaled = model;
  SetCanonicalScale(objective.coverage(), &scaled);
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const double scale = scaled.table(factor, t)[0] / model.table(factor, t)[0];
      for (int k = 1; k < spec.table_size(factor); ++k) {
        const double expected = scale * model.table(factor, t)[k];
        EXPECT_NEAR(scaled.table(factor, t)[k], expected, 1e-12 * expected);
      }
    }
  }
  ExpectCanonical(objective, scaled, "scaled", /*ordered=*/false);
  ExpectSameValues(objective, scaled, model, "scaled");
}

TEST(Gauge, UnobservedBinsAreFilledFromTheirNeighbours) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(TableWithGaps(), spec);
  FactorModel model = RandomModel(spec, 4);
  const std::vector<bool> unobserved = UnobservedParameters(objective.coverage());
  Canonicalize(objective.coverage(), &model);
  for (int t = 0; t < 2; ++t) {
    const auto D = model.table(Factor::kD, t);
    for (const int k : {0, 1, 4, 5, 8, 9}) {
      EXPECT_TRUE(unobserved[model.TableOffset(Factor::kD, t) + k]);
    }
    EXPECT_FALSE(unobserved[model.TableOffset(Factor::kD, t) + 2]);
    EXPECT_DOUBLE_EQ(D[0], D[2]);
    EXPECT_DOUBLE_EQ(D[1], D[2]);
    EXPECT_DOUBLE_EQ(D[4], (2 * D[3] + D[6]) / 3);
    EXPECT_DOUBLE_EQ(D[5], (D[3] + 2 * D[6]) / 3);
    std::vector<double> observed = {D[2], D[3], D[6], D[7]};
    std::ranges::sort(observed);
    for (const int k : {8, 9}) {  // or less, where more would be reflected there (Continuation)
      EXPECT_LE(D[k], observed[2] * (1 + 1e-12));
      EXPECT_GT(D[k], 0);
    }
  }
  const auto F = model.table(Factor::kF, 0);
  EXPECT_DOUBLE_EQ(F[3], (F[2] + F[4]) / 2);
  // Beyond the data F and G / cos theta go on (ContinueBeyondData).
  const auto goes_on = [&](Factor factor, int t, int k, const auto& value) {
    const int offset = model.TableOffset(factor, t);
    std::vector<double> x, y;
    const std::vector<double>& coverage = objective.coverage();
    for (int j = 0; j < k; ++j) {
      // Entries that hardly a sample reads do not count.
      const bool well = j < 3 || coverage[offset + j] >= 0.05 * coverage[offset + j - 3];
      if (unobserved[offset + j] || !well) continue;
      x.push_back(spec.axis(factor).Theta(j));
      y.push_back(std::log(value(j)));
    }
    return std::exp(LevelledOff(FitRobustLine(x, y), x.back(), spec.axis(factor).Theta(k)));
  };
  EXPECT_NEAR(F[8], goes_on(Factor::kF, 0, 8, [&](int k) { return F[k]; }), 1e-12 * F[8]);
  const auto G = model.table(Factor::kG, 1);
  ASSERT_TRUE(unobserved[model.TableOffset(Factor::kG, 1) + 8]);
  const auto ratio = [&](int k) { return G[k] / std::cos(spec.g_axis.Theta(k)); };
  EXPECT_NEAR(ratio(8), goes_on(Factor::kG, 1, 8, ratio), 1e-12 * ratio(8));
}

// Lobes and tables that have vanished keep their (lack of) value, without a division by 0.
TEST(Gauge, VanishedLobes) {
  for (const BrdfTable& table : {RandomTable(kGrid, 1), TableWithGaps()}) {
    for (const auto& [name, spec] : TestSpecs(kGrid)) {
      if (spec.lobes == 0) continue;
      const Objective objective = MakeObjective(table, spec);
      for (const char* const what : {"s", "one s", "D", "F", "G", "all"}) {
        const std::string which = what;
        FactorModel model = RandomModel(spec, 5);
        if (which == "s") std::ranges::fill(model.s(0), 0.0);
        if (which == "one s") model.s(0)[1] = 0;
        if (which == "D") std::ranges::fill(model.table(Factor::kD, 0), 0.0);
        if (which == "F") std::ranges::fill(model.table(Factor::kF, 0), 0.0);
        if (which == "G") std::ranges::fill(model.table(Factor::kG, 0), 0.0);
        if (which == "all") std::ranges::fill(model.parameters(), 0.0);
        FactorModel canonical = model;
        Canonicalize(objective.coverage(), &canonical);
        const std::string where = name + " without " + which;
        EXPECT_TRUE(std::ranges::all_of(canonical.parameters(), [](double x) {
          return std::isfinite(x) && x >= 0;
        })) << where;
        ExpectCanonical(objective, canonical, where);
        ExpectSameValues(objective, canonical, model, where);
        FactorModel again = canonical;
        Canonicalize(objective.coverage(), &again);
        ExpectSameModel(again, canonical, 0, where);
      }
    }
  }
}

TEST(Gauge, AVanishedTableBecomesConstantAndItsLobeDark) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 6);
  std::ranges::fill(model.table(Factor::kD, 1), 0.0);
  Canonicalize(objective.coverage(), &model);
  for (const double s : model.s(1)) EXPECT_EQ(s, 0);
  for (const double s : model.s(0)) EXPECT_GT(s, 0);
  const double constant = 1 / VisibleIntegral(std::vector<double>(kGrid.theta_h, 1.0));
  for (const double D : model.table(Factor::kD, 1)) EXPECT_NEAR(D, constant, 1e-15);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
