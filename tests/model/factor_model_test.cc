#include "trilobe/model/factor_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 8, .phi_d = 10};

TEST(FactorModel, StartsAtZero) {
  const FactorModel model(ModelSpec::SharedFactors(3));
  EXPECT_EQ(model.parameters().size(), 822U);
  EXPECT_TRUE(std::ranges::all_of(model.parameters(), [](double x) { return x == 0; }));
}

TEST(FactorModel, RefusesABadSpec) {
  EXPECT_THAT(ErrorOf([&] { FactorModel(ModelSpec::SharedFactors(9)); }),
              IsError(ErrorKind::kRange, {.key = "lobes", .value = "9"}));
  EXPECT_THAT(ErrorOf([&] {
                FactorModel(ModelSpec{.d_axis = {.rule = Axis::Rule::kRootTheta, .size = 2}});
              }),
              IsError(ErrorKind::kRange, {.key = "D", .value = "2"}));
}

// [ d | s | D | F | G ]: the accessors walk over all parameters once, in this order.
TEST(FactorModel, ParametersLieInTheirOrder) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    FactorModel model(spec);
    std::iota(model.parameters().begin(), model.parameters().end(), 0.0);
    double next = 0;
    // Named captures: clang 14 does not capture structured bindings by itself.
    const auto expect_next = [&, &name = name](std::span<const double> part) {
      for (const double x : part) EXPECT_EQ(x, next++) << name;
    };
    expect_next(model.d());
    for (int m = 0; m < spec.lobes; ++m) expect_next(model.s(m));
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        EXPECT_EQ(model.TableOffset(factor, t), next) << name;
        expect_next(model.table(factor, t));
      }
    }
    EXPECT_EQ(next, spec.num_parameters()) << name;
    for (int m = 0; m < spec.lobes; ++m) {
      for (int c = 0; c < kChannels; ++c) {
        const auto read = [&, &spec = spec](Factor factor) {
          return model.table(factor, spec.table(factor, m, c)).data();
        };
        EXPECT_EQ(model.D(m, c).data(), read(Factor::kD)) << name;
        EXPECT_EQ(model.F(m, c).data(), read(Factor::kF)) << name;
        EXPECT_EQ(model.G(m, c).data(), read(Factor::kG)) << name;
      }
    }
  }
}

TEST(FactorModel, IsAValue) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(2, kGrid), 1);
  FactorModel copy = model;
  copy.d()[0] = 17;
  EXPECT_NE(model.d()[0], 17);
}

// Equation (3) at bin (h, d, p), written out with the formulas of docs/model.md.
TEST(FactorModel, EvaluatesThePapersEquation) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const FactorModel model = RandomModel(spec, 2);
  const CatmullRom spline(8);
  std::vector<double> cosines(8);
  for (int k = 0; k < 8; ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  const int h = 2, d = 3, p = 4;
  const HalfDiffAngles angles = kGrid.Center(h, d, p);
  const DirectionPair pair = ToDirections(angles);
  const Stencil at_i = spline.StencilAt(std::acos(pair.wi[2]));
  const Stencil at_o = spline.StencilAt(std::acos(pair.wo[2]));
  for (int c = 0; c < kChannels; ++c) {
    double expected = model.d()[c];
    for (int m = 0; m < 2; ++m) {
      const auto G = model.table(Factor::kG, m);
      expected += model.s(m)[c] * model.table(Factor::kD, m)[h] * model.table(Factor::kF, c)[d] *
                  at_i(G) * at_o(G) / (at_i(cosines) * at_o(cosines));
    }
    const SampleStencils stencils = GridStencils(spec, kGrid, kGrid.Index(h, d, p));
    EXPECT_NEAR(UnclampedValue(model, stencils, c), expected, 1e-13 * expected);
    // A bin's centre is where both ways of reading agree.
    const SampleStencils scattered = ScatteredStencils(spec, angles);
    EXPECT_NEAR(UnclampedValue(model, scattered, c), expected, 1e-12 * expected);
    EXPECT_NEAR(Evaluate(model, pair)[c], expected, 1e-12 * expected);
  }
}

TEST(FactorModel, ScatteredReadingIsLinearInDAndF) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  // A quarter of the way from D bin 2 to 3 in sqrt(theta_h), half way from F bin 4 to 5.
  const SampleStencils at =
      ScatteredStencils(spec, HalfDiffAngles{kGrid.ThetaH(2.75), kGrid.ThetaD(5.0), 1.0});
  EXPECT_NEAR(at.D.WeightOf(2), 0.75, 1e-14);
  EXPECT_NEAR(at.D.WeightOf(3), 0.25, 1e-14);
  EXPECT_NEAR(at.F.WeightOf(4), 0.5, 1e-14);
  EXPECT_NEAR(at.F.WeightOf(5), 0.5, 1e-14);
}

TEST(FactorModel, AllChannelsAtOnceAreThoseOfEach) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 5);
    const SampleStencils at = GridStencils(spec, kGrid, kGrid.Index(1, 2, 3));
    const Rgb rho = EvaluateAt(model, at);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_EQ(rho[c], std::max(UnclampedValue(model, at, c), 0.0)) << name;
    }
  }
}

TEST(FactorModel, IsReciprocal) {
  const FactorModel model = RandomModel(ModelSpec::IndependentG(kGrid), 3);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    const auto [wi, wo] = ToDirections(kGrid.Center(bin));
    const Rgb one = Evaluate(model, {wi, wo}), other = Evaluate(model, {wo, wi});
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(one[c], other[c], 1e-12 * std::abs(one[c]));
  }
}

TEST(FactorModel, ALambertianIsConstantAndDarkBelowTheSurface) {
  FactorModel model;
  std::ranges::fill(model.d(), 0.25);
  EXPECT_EQ(Evaluate(model, {{0, 0, 1}, {0.6, 0, 0.8}}), (Rgb{0.25, 0.25, 0.25}));
  EXPECT_EQ(Evaluate(model, {{0, 0, 1}, {0.6, 0, -0.8}}), (Rgb{0, 0, 0}));
  EXPECT_EQ(Evaluate(model, {{1, 0, 0}, {0.6, 0, 0.8}}), (Rgb{0, 0, 0}));
}

TEST(FactorModel, TheCosinesNeverVanish) {
  const MerlGrid grid;
  const ModelSpec spec;
  const double least = std::cos(DegreesToRadians(89.5));
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); bin += kSanitized ? 37 : 7) {
    if (!above[bin]) continue;
    const double inverse = GridStencils(spec, grid, bin).inverse_cosines;
    ASSERT_GE(inverse, 1 - 1e-3);
    ASSERT_LE(inverse, 1 / (least * least) * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
