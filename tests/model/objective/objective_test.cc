#include "trilobe/model/objective/objective.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/anisotropic_samples.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kEven{.theta_h = 12, .theta_d = 12, .phi_d = 24};
constexpr MerlGrid kOdd{.theta_h = 10, .theta_d = 12, .phi_d = 15};  // one bin is its own mirror

void ExpectRelative(double value, long double expected, double tolerance, const std::string& what) {
  EXPECT_NEAR(value, static_cast<double>(expected),
              tolerance * std::abs(static_cast<double>(expected)))
      << what;
}

TEST(Objective, ValueIsTheSumOverAllSamples) {
  for (const MerlGrid& grid : {kEven, kOdd}) {
    const BrdfTable table = RandomTable(grid, 1);
    for (const auto& [name, spec] : TestSpecs(grid)) {
      for (const Weighting& weighting : Weightings()) {
        const Objective objective = MakeObjective(table, spec, weighting.name);
        ASSERT_EQ(objective.folded() != nullptr, !spec.stretches.any());
        const FactorModel model = RandomModel(spec, 2);
        const long double expected = ExactObjective(objective, model);
        ExpectRelative(objective.Value(model), expected, 1e-12, name + ", " + weighting.name);
        const FactorModel black(spec);
        ExpectRelative(objective.Value(black), ExactObjective(objective, black), 1e-12, name);
        ExpectRelative(objective.MeasuredEnergy(), ExactObjective(objective, black), 1e-12, name);
      }
    }
  }
}

// In the paper's own order: the weights come from the named weighting at the exact cosine.
TEST(Objective, SamplesCarryTheirWeights) {
  const BrdfTable table = RandomTable(kOdd, 3);
  const Objective objective = MakeObjective(table, ModelSpec::SharedFactors(1, kOdd), "log");
  const BrdfSamples samples = ValidSamples(table);
  ASSERT_EQ(objective.weighted_samples().size(), samples.rho.size());
  for (int j = 0; j < samples.size(); ++j) {
    const double cos_i = ToDirections(samples.Angles(j)).wi[2];
    for (int c = 0; c < kChannels; ++c) {
      const double slope = cos_i / (1 + samples.rho[j][c] * cos_i);
      EXPECT_NEAR(objective.weighted_samples()[j].weight[c], slope * slope, 1e-12 * slope * slope);
      EXPECT_EQ(objective.weighted_samples()[j].rho[c], samples.rho[j][c]);
    }
  }
}

// Half-vector coordinates exchange wi and wo where phi_d is beyond 180 degrees.
TEST(Objective, WeightsAreOfTheIncidentDirection) {
  const ModelSpec spec = ModelSpec::Anisotropic(1);
  const BrdfSamples samples = PolarSamples(RandomModel(spec, 5, 0.1), 5, 8);
  const Objective objective(samples, spec, FindWeighting("cosine"));
  for (int j = 0; j < samples.size(); ++j) {
    const double cos_i = std::cos(samples.directions[j].theta_i);
    ASSERT_NEAR(objective.Sample(j).weight[0], cos_i * cos_i, 1e-12) << j;
  }
}

TEST(Objective, AnExactFitHasNoError) {
  for (const auto& [name, spec] : TestSpecs(kOdd)) {
    FactorModel model = RandomModel(spec, 4, 0.1);
    const Objective objective = MakeObjective(TableOf(model, kOdd), spec);
    constexpr double kError = 4 * std::numeric_limits<double>::epsilon();
    EXPECT_LE(objective.Value(model), kError * kError * objective.MeasuredEnergy()) << name;
  }
}

TEST(Objective, SameBitsForAnyNumberOfThreads) {
  const BrdfTable table = RandomTable(kOdd, 5);
  for (const auto& [name, spec] : TestSpecs(kOdd)) {
    const FactorModel model = RandomModel(spec, 6);
    const Objective one = MakeObjective(table, spec, "compressive", 1);
    for (const int threads : {2, 3, 64}) {
      const Objective many = MakeObjective(table, spec, "compressive", threads);
      EXPECT_EQ(many.Value(model), one.Value(model)) << name << ", " << threads << " threads";
      EXPECT_EQ(many.MeasuredEnergy(), one.MeasuredEnergy());
      EXPECT_EQ(many.coverage(), one.coverage());
    }
  }
}

TEST(Objective, IsTheSameMadeFromOneOfAnotherSpec) {
  const BrdfTable table = RandomTable(kOdd, 5);
  const Objective first = MakeObjective(table, ModelSpec::SharedFactors(2, kOdd));
  const auto expect_same = [&](const ModelSpec& spec, const std::string& name) {
    const Objective anew = MakeObjective(table, spec), made(first, spec);
    const FactorModel model = RandomModel(spec, 6);
    EXPECT_EQ(made.Value(model), anew.Value(model)) << name;
    EXPECT_EQ(made.MeasuredEnergy(), anew.MeasuredEnergy()) << name;
    EXPECT_EQ(made.coverage(), anew.coverage()) << name;
    return made.folded() == first.folded();
  };
  for (const auto& [name, spec] : TestSpecs(kOdd)) {
    EXPECT_EQ(expect_same(spec, name), !spec.stretches.any()) << name;
  }
  ModelSpec finer = first.spec();
  finer.g_axis.size += 3;
  EXPECT_FALSE(expect_same(finer, "finer G"));
  ++finer.d_axis.size;
  EXPECT_FALSE(expect_same(finer, "finer D"));
}

TEST(Objective, ScatteredSamples) {
  for (const auto& [name, spec] : TestSpecs(kOdd)) {
    BrdfSamples samples = Scattered(ValidSamples(RandomTable(kOdd, 7)));
    Random random(8);
    for (HalfDiffAngles& angles : samples.angles) {
      // Off the bins' centres, where D and F are interpolated, but above the surface.
      const HalfDiffAngles moved = {angles.theta_h * random.Uniform(0.9, 1.1),
                                    angles.theta_d * random.Uniform(0.9, 1.0), angles.phi_d};
      const Cosines cosines = ToCosines(moved);
      if (std::min(cosines.i, cosines.o) > 0) angles = moved;
    }
    const Objective one(samples, spec, FindWeighting("cosine"), 1);
    const Objective three(samples, spec, FindWeighting("cosine"), 3);
    EXPECT_EQ(one.folded(), nullptr);
    const FactorModel model = RandomModel(spec, 9);
    ExpectRelative(one.Value(model), ExactObjective(one, model), 1e-12, name);
    ExpectRelative(one.MeasuredEnergy(), ExactObjective(one, FactorModel(spec)), 1e-12, name);
    EXPECT_EQ(one.Value(model), three.Value(model)) << name;
  }
}

// At the bins' centres both kinds of samples have the same E.
TEST(Objective, ScatteredAndGridAgreeAtTheCentres) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, kEven);
  const BrdfSamples on_grid = ValidSamples(RandomTable(kEven, 10));
  const Objective folded(on_grid, spec, FindWeighting("compressive"));
  const Objective scattered(Scattered(on_grid), spec, FindWeighting("compressive"));
  const FactorModel model = RandomModel(spec, 11);
  EXPECT_NEAR(folded.Value(model), scattered.Value(model), 1e-12 * folded.Value(model));
}

// The sum of w |stencil weight| over the samples and channels that read a parameter.
std::vector<double> BruteForceCoverage(const Objective& objective) {
  const ModelSpec& spec = objective.spec();
  FactorModel coverage(spec);
  for (const WeightedSample& sample : objective.weighted_samples()) {
    const SampleStencils& at = sample.stencils;
    for (int c = 0; c < kChannels; ++c) {
      const double w = sample.weight[c];
      coverage.d()[c] += w;
      for (int m = 0; m < spec.lobes; ++m) coverage.s(m)[c] += w;
      // Each table once, by the first lobe that it serves.
      const auto add = [&](Factor factor, const auto& stencil_of) {
        for (int t = 0; t < spec.num_tables(factor); ++t) {
          bool serves = false;
          Stencil stencil;
          for (int m = spec.lobes - 1; m >= 0; --m) {
            if (!spec.serves(factor, t, m, c)) continue;
            serves = true;
            stencil = stencil_of(m);
          }
          for (int k = 0; serves && k < stencil.size; ++k) {
            coverage.table(factor, t)[stencil.index[k]] += w * std::abs(stencil.weight[k]);
          }
        }
      };
      add(Factor::kD, [&](int m) { return at.DOf(spec.stretches.index(m)); });
      add(Factor::kF, [&](int) { return at.F; });
      add(Factor::kG, [&](int) { return at.G_i; });
      add(Factor::kG, [&](int) { return at.G_o; });
    }
  }
  return {coverage.parameters().begin(), coverage.parameters().end()};
}

// Samples of a prior beside those of the data: what is shared, released or read by the fold of both
// has the bits of what is made of whole copies.
TEST(Objective, AddedSamplesShareThoseOfTheData) {
  const ModelSpec spec = ModelSpec::SharedFactors(2);
  const BrdfSamples samples = PolarSamples(RandomModel(spec, 3, 0.1), 6, 12);
  const int count = samples.size();
  // One of them stands where a sample of the data does, and folds into it.
  BrdfSamples added = Selected(samples, {1, 5}), more = Selected(samples, {7});
  added.angles[1].theta_h *= 0.9;
  added.directions[1] = ToSphericalAngles(ToDirections(added.angles[1]));
  added.rho = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  BrdfSamples joined = samples;
  joined.multiplicity.assign(count, 1);
  const auto append = [&](const BrdfSamples& from, double weight) {
    for (int j = 0; j < from.size(); ++j) {
      joined.angles.push_back(from.angles[j]);
      joined.directions.push_back(from.directions[j]);
      joined.rho.push_back(from.rho[j]);
      joined.multiplicity.push_back(weight);
    }
  };
  const FactorModel model = RandomModel(spec, 4);
  const Objective alone(samples, spec, FindWeighting("appearance"), 2);
  Objective both(alone.samples(), spec, alone.weighting(), 2);
  const Objective data = both;
  for (const auto& [next, weight] : {std::pair{added, 0.25}, {more, 3.0}}) {
    append(next, weight);
    both = Objective(std::move(both), next, weight);
    const Objective whole(alone, joined);
    EXPECT_EQ(both.Value(model), whole.Value(model));
    EXPECT_EQ(both.coverage(), whole.coverage());
    EXPECT_EQ(both.MeasuredEnergy(), whole.MeasuredEnergy());
    EXPECT_EQ(both.IrreducibleEnergy(), whole.IrreducibleEnergy());
    EXPECT_EQ(both.num_samples(), joined.size());
    EXPECT_EQ(both.added()->size(), joined.size() - count);
    EXPECT_EQ(both.EvenlySpread(9).rho, EvenlySpread(joined, 9).rho);
    EXPECT_EQ(both.Thinned(3).multiplicity, Thinned(joined, 3).multiplicity);
    EXPECT_EQ(both.Sample(count).rho, whole.Sample(count).rho);
    ASSERT_TRUE(both.has_prior());
    for (const Objective& measured : {data, both.data()}) {
      EXPECT_EQ(measured.Value(model), alone.Value(model));
      EXPECT_EQ(measured.IrreducibleEnergy(), alone.IrreducibleEnergy());
    }
  }
  EXPECT_LT(both.folded_samples()->size(), both.num_samples());
  EXPECT_EQ(both.samples().rho, joined.rho);
  EXPECT_EQ(both.samples().multiplicity, joined.multiplicity);
  const std::shared_ptr<const FoldedSamples> in_use = both.folded_samples();
  data.ReleaseFold();
  EXPECT_EQ(data.Value(model), alone.Value(model));
  EXPECT_EQ(data.folded_samples()->rho, alone.folded_samples()->rho);
  both.ReleaseFold();
  EXPECT_EQ(both.Value(model), Objective(alone, joined).Value(model));
  // Whoever uses a fold keeps it.
  EXPECT_NE(both.folded_samples(), in_use);
  EXPECT_EQ(both.folded_samples()->rho, in_use->rho);
}

TEST(Objective, OwnsSamplesThatWereShared) {
  const ModelSpec spec = ModelSpec::SharedFactors(1);
  auto samples = std::make_shared<BrdfSamples>(PolarSamples(RandomModel(spec, 3, 0.1), 4, 6));
  const Objective objective(samples, spec, FindWeighting("compressive"));
  EXPECT_EQ(&objective.samples(), samples.get());
  const std::vector<Rgb> rho = samples->rho;
  const FactorModel model = RandomModel(spec, 4, 0.1);
  const double E = objective.Value(model);
  const Objective owner = objective.WithOwnSamples();
  samples->rho.clear();
  EXPECT_EQ(owner.samples().rho, rho);
  EXPECT_EQ(owner.Value(model), E);
  EXPECT_EQ(owner.folded_samples(), objective.folded_samples());  // what was computed is shared
}

TEST(Objective, CoverageCountsTheWeightOfTheReaders) {
  BrdfTable table = RandomTable(kOdd, 12);
  InvalidateThetaH(3, 1, &table);
  for (const auto& [name, spec] : TestSpecs(kOdd)) {
    for (const bool scattered : {false, true}) {
      BrdfSamples samples = ValidSamples(table);
      if (scattered) samples = Scattered(samples);
      const Objective objective(samples, spec, FindWeighting("compressive"));
      const std::vector<double> expected = BruteForceCoverage(objective);
      ASSERT_EQ(objective.coverage().size(), expected.size());
      for (size_t k = 0; k < expected.size(); ++k) {
        EXPECT_NEAR(objective.coverage()[k], expected[k], 1e-12 * expected[k] + 1e-13)
            << name << ", parameter " << k;
      }
      // A stretched D is read in the place of its neighbours, too.
      if (!scattered && spec.lobes > 0 && !spec.stretches.any()) {
        const int unobserved = FactorModel(spec).TableOffset(Factor::kD, 0) + 3;
        EXPECT_EQ(objective.coverage()[unobserved], 0);
      }
    }
  }
}

TEST(Objective, FoldsMirrorPairs) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kOdd);
  const BrdfTable complete = RandomTable(kOdd, 13, 0);
  const Objective objective = MakeObjective(complete, spec);
  const int samples = objective.samples().size();
  // Every (theta_h, theta_d) row holds its pairs, and the middle bin that is its own mirror.
  EXPECT_LE(objective.folded()->size(), samples / 2 + kOdd.theta_h * kOdd.theta_d);
  EXPECT_GE(objective.folded()->size(), samples / 2);
}

std::optional<Error> ErrorFrom(BrdfSamples samples, const ModelSpec& spec) {
  return ErrorOf(
      [&] { const Objective objective(std::move(samples), spec, FindWeighting("uniform")); });
}

// Models of few scattered samples have such tables, and are compared with a table.
TEST(Objective, ReadsTablesOfOtherBinsBetweenThem) {
  const BrdfSamples samples = ValidSamples(RandomTable(kOdd, 14));
  ModelSpec spec = ModelSpec::SharedFactors(2, kOdd);
  for (const auto& [d, f, g] : {std::array{9, 12, 12}, {10, 5, 7}, {90, 90, 90}}) {
    spec.d_axis.size = d;
    spec.f_axis.size = f;
    spec.g_axis.size = g;
    const FactorModel model = RandomModel(spec, 3);
    const Objective objective(samples, spec, FindWeighting("uniform"));
    const std::vector<Rgb> fitted = EvaluateSamples(model, samples, 1);
    double E = 0;
    for (int j = 0; j < samples.size(); ++j) {
      for (int c = 0; c < kChannels; ++c) {
        E += (fitted[j][c] - samples.rho[j][c]) * (fitted[j][c] - samples.rho[j][c]);
      }
    }
    EXPECT_NEAR(objective.Value(model), E, 1e-12 * E) << d << " " << f << " " << g;
  }
}

TEST(Objective, RefusesTooManyLobes) {
  const BrdfSamples samples = ValidSamples(RandomTable(kOdd, 14));
  EXPECT_THAT(ErrorFrom(samples, ModelSpec::SharedFactors(20, kOdd)),
              IsError(ErrorKind::kRange, {.key = "lobes", .value = "20"}));
}

TEST(Objective, RefusesValuesThatAreNoReflectance) {
  BrdfSamples samples = ValidSamples(RandomTable(kOdd, 15));
  const ModelSpec spec = ModelSpec::SharedFactors(3, kOdd);
  samples.rho[7][1] = 1e50;
  EXPECT_NO_THROW(Objective(samples, spec, FindWeighting("uniform")));
  for (const double bad : {1.001e50, 1e300, std::numeric_limits<double>::infinity()}) {
    samples.rho[7][1] = bad;
    EXPECT_THAT(ErrorFrom(samples, spec),
                IsError(ErrorKind::kRange, {.file = "random", .key = "sample 7"}))
        << bad;
  }
}

TEST(Objective, StaysFiniteForTheLargestValues) {
  BrdfTable table = RandomTable(kOdd, 16);
  for (int c = 0; c < kChannels; ++c) {
    for (double& x : table.stored[c]) x *= 1e45;
  }
  for (const Weighting& weighting : Weightings()) {
    const ModelSpec spec = ModelSpec::SharedFactors(3, kOdd);
    const Objective objective = MakeObjective(table, spec, weighting.name);
    EXPECT_TRUE(std::isfinite(objective.MeasuredEnergy())) << weighting.name;
    EXPECT_TRUE(std::isfinite(objective.Value(RandomModel(spec, 1)))) << weighting.name;
  }
}

// A model without lobes reads no table, so it goes with any grid that is not finer than its own.
TEST(Objective, WithoutLobesAnyGridGoes) {
  const BrdfSamples samples = ValidSamples(RandomTable(kEven, 12));
  const Weighting weighting = FindWeighting("uniform");
  const ModelSpec spec = ModelSpec::SharedFactors(0);
  const Objective objective(samples, spec, weighting);
  FactorModel model(spec);
  std::ranges::fill(model.d(), 0.25);
  const auto expected = static_cast<double>(ExactObjective(objective, model));
  EXPECT_NEAR(objective.Value(model), expected, 1e-12 * expected);
  const MerlGrid coarser{kEven.theta_h - 1, kEven.theta_d, kEven.phi_d};
  model = FactorModel(ModelSpec::SharedFactors(0, coarser));
  std::ranges::fill(model.d(), 0.25);
  EXPECT_NEAR(Objective(samples, model.spec(), weighting).Value(model), expected, 1e-12 * expected);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
