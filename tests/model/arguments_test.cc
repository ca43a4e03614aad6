// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/beyond_data.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "model/objective/unclamped_model.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/measurement/tabulated_brdf.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/objective/parameter_blocks.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/sample_residual.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/model/table_layout.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

BrdfSamples Samples() { return ValidSamples(RandomTable(kGrid, 1)); }

Objective MakeObjective(BrdfSamples samples, int num_threads = 1) {
  return {std::move(samples), ModelSpec::SharedFactors(1, kGrid), FindWeighting("appearance"),
          num_threads};
}

// The message for samples with something changed.
std::string ErrorWith(const std::function<void(BrdfSamples*)>& change, bool scattered = false) {
  BrdfSamples samples = scattered ? Scattered(Samples()) : Samples();
  change(&samples);
  return ErrorOf([&] { MakeObjective(samples); });
}

TEST(Arguments, SamplesOfAnObjective) {
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { *changed = Selected(*changed, {}); }),
              HasSubstr("no sample"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.pop_back(); }),
              HasSubstr("each needs one"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.clear(); }), HasSubstr("0 bins"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins[0] = -1; }),
              HasSubstr("sample 0"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.back() = kGrid.size(); }),
              HasSubstr("bin 240 of 240"));
  EXPECT_THAT(
      ErrorWith([](BrdfSamples* changed) { std::swap(changed->bins[3], changed->bins[4]); }),
      HasSubstr("ascend"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins[4] = changed->bins[3]; }),
              HasSubstr("ascend"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.back() = kGrid.Index(5, 4, 0); }),
              HasSubstr("below the surface"));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) {
                changed->multiplicity = {1, 1};
              }),
              HasSubstr("2 multiplicities"));
  for (const double bad : {-1e-300, -1.0, kNaN, kInfinity}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->rho[3][1] = bad; }),
                HasSubstr("sample 3"));
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) {
                  changed->multiplicity.assign(changed->size(), 1);
                  changed->multiplicity[5] = bad;
                }),
                HasSubstr("sample 5"));
  }
  for (const HalfDiffAngles& bad :
       {HalfDiffAngles{kNaN, 0, 0}, HalfDiffAngles{0, kNaN, 0}, HalfDiffAngles{0, 0, kNaN},
        HalfDiffAngles{-0.1, 0, 0}, HalfDiffAngles{0, 2, 0}, HalfDiffAngles{1.5, 1.5, 0}}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->angles[2] = bad; }, true),
                HasSubstr("sample 2"));
  }
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->angles.pop_back(); }, true),
              HasSubstr("angles; each needs one"));
  for (const int phi_d : {0, -1, 1 << 30}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->grid.phi_d = phi_d; }),
                HasSubstr("grid"));
  }
}

// Every bin above the surface is one, at the horizon too.
TEST(Arguments, BinsAtTheHorizonAreAccepted) {
  for (const MerlGrid& grid :
       {kGrid, MerlGrid{}, MerlGrid{.theta_h = 7, .theta_d = 7, .phi_d = 1}}) {
    EXPECT_NO_THROW(CheckSamples(ValidSamples(RandomTable(grid, 1, 0))));
    const std::vector<bool> above = BinsAboveSurface(grid);
    for (int bin = 0; bin < grid.size(); bin += 7) {
      if (above[bin]) continue;
      BrdfSamples below{"below", grid, {bin}, {}, {Rgb{1, 1, 1}}};
      EXPECT_THROW(CheckSamples(below), Error) << bin;
    }
  }
}

TEST(Arguments, OfAnObjective) {
  for (const int threads : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { MakeObjective(Samples(), threads); }), HasSubstr("num_threads"));
  }
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  for (const double bad : {-1.0, kNaN, kInfinity, 1e-250, 1e250}) {
    for (const bool scattered : {false, true}) {
      const Weighting weighting{
          .name = "own", .description = "", .formula = [&](const WeightedPoint&, double) {
            return Rgb{bad, bad, bad};
          }};
      const BrdfSamples samples = scattered ? Scattered(Samples()) : Samples();
      EXPECT_THAT(ErrorOf([&] { Objective(samples, spec, weighting); }),
                  HasSubstr("weighting 'own'"))
          << bad;
    }
  }
  EXPECT_THAT(ErrorOf([&] { Objective(Samples(), spec, {.name = "own", .description = ""}); }),
              HasSubstr("no formula"));

  const Objective objective = MakeObjective(Samples());
  for (const ModelSpec& other : {ModelSpec::SharedFactors(2, kGrid), ModelSpec::SharedFactors(1),
                                 ModelSpec::IndependentG(kGrid)}) {
    EXPECT_THAT(ErrorOf([&] { objective.Value(FactorModel(other)); }), HasSubstr("another spec"));
    EXPECT_THAT(ErrorOf([&] { ScoreModel(objective, FactorModel(other)); }),
                HasSubstr("another spec"));
    ParameterBlocks blocks(spec);
    FactorModel model(other);
    EXPECT_THAT(ErrorOf([&] { blocks.Read(model); }), HasSubstr("another spec"));
    EXPECT_THAT(ErrorOf([&] { blocks.Write(&model); }), HasSubstr("another spec"));
  }
  for (const int j : {-1, objective.samples().size()}) {
    EXPECT_THAT(ErrorOf([&] { objective.Sample(j); }), HasSubstr("no sample"));
  }
  EXPECT_THAT(ErrorOf([&] { MakeObjective(Scattered(Samples())).spline_cells(); }),
              HasSubstr("no grid"));
  EXPECT_THAT(ErrorOf([&] { ScoreValues(objective, std::vector<Rgb>(3)); }), HasSubstr("3 values"));
}

TEST(Arguments, ParameterBlocksAndWhatReadsThem) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  ParameterBlocks blocks(spec);
  for (const int b : {-1, blocks.num_blocks(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { blocks.block(b); }), HasSubstr("the parameter block is"));
    EXPECT_THAT(ErrorOf([&] { blocks.parameters(b); }), HasSubstr("the parameter block is"));
  }
  for (const int entry : {-1, spec.d_axis.size}) {
    EXPECT_THAT(ErrorOf([&] { blocks.row(Factor::kD, entry); }), HasSubstr("must be from 0 to 5"));
  }
  const ParameterBlocks diffuse(ModelSpec::SharedFactors(0, kGrid));
  EXPECT_THAT(ErrorOf([&] { diffuse.row(Factor::kF, 0); }), HasSubstr("there is none"));
  EXPECT_THAT(ErrorOf([&] { blocks.Write(nullptr); }), HasSubstr("must not be null"));

  const WeightedSample sample = MakeObjective(Samples()).Sample(0);
  std::vector<int> read;
  EXPECT_NO_THROW(SampleResidual(blocks, sample, &read));
  const auto error_with = [&](const std::function<void(WeightedSample*)>& change) {
    WeightedSample changed = sample;
    change(&changed);
    return ErrorOf([&] { SampleResidual(blocks, changed, &read); });
  };
  EXPECT_THAT(ErrorOf([&] { SampleResidual(blocks, sample, nullptr); }),
              HasSubstr("must not be null"));
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_THAT(error_with([&](WeightedSample* changed) { changed->weight[1] = bad; }),
                HasSubstr("the weight of a sample is"));
  }
  EXPECT_THAT(error_with([](WeightedSample* changed) { changed->stencils.F.index[0] = 5; }),
              HasSubstr("must be from 0 to 4"));
  for (const int size : {0, 5}) {
    EXPECT_THAT(error_with([&](WeightedSample* changed) { changed->stencils.G_o.size = size; }),
                HasSubstr("of a stencil"));
  }
  EXPECT_THAT(error_with([](WeightedSample* changed) { changed->stencils.more_D.resize(1); }),
              HasSubstr("stencils of D"));
}

TEST(Arguments, NumbersOfSamples) {
  const BrdfSamples samples = Samples();
  for (const int j : {-1, samples.size(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { Selected(samples, {0, j}); }), HasSubstr(std::to_string(j)));
  }
  for (const int stride : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { Thinned(samples, stride); }), HasSubstr("stride"));
  }
  BrdfSamples no_bins = samples;
  no_bins.bins.clear();
  EXPECT_THROW(Selected(no_bins, {0}), Error);
  EXPECT_THROW(Thinned(no_bins, 2), Error);
  EXPECT_THROW(EvaluateSamples(FactorModel(ModelSpec::SharedFactors(1, kGrid)), no_bins, 1), Error);
  // None of these is one that a thinning keeps.
  for (int j = 0; j < samples.size(); ++j) {
    EXPECT_EQ(Thinned(Selected(samples, {j}), 1000).size(), 1) << j;
  }
}

TEST(Arguments, AnglesThatAreNone) {
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1);
  const UnclampedModel unclamped(model);
  const BrdfTable table = RandomTable(kGrid, 1);
  const TabulatedBrdf tabulated(table);
  for (const DirectionPair& bad :
       {DirectionPair{{kNaN, 0, 1}, {0, 0, 1}}, DirectionPair{{0, 0, 1}, {0, kNaN, 1}},
        DirectionPair{{kInfinity, 0, 1}, {0, 0, 1}}}) {
    EXPECT_NE(ErrorOf([&] { Evaluate(model, bad); }), "");
    EXPECT_NE(ErrorOf([&] { tabulated(bad); }), "");
    EXPECT_NE(ErrorOf([&] { tabulated.Interpolate(bad); }), "");
  }
  for (const HalfDiffAngles& bad :
       {HalfDiffAngles{kNaN, 0, 0}, HalfDiffAngles{0, kNaN, 0}, HalfDiffAngles{-1, 0, 0}}) {
    EXPECT_NE(ErrorOf([&] { ScatteredStencils(model.spec(), bad); }), "");
    EXPECT_NE(ErrorOf([&] { unclamped(bad, {1, 1}); }), "");
    EXPECT_NE(ErrorOf([&] { kGrid.Bin(bad); }), "");
  }
  for (const HalfDiffAngles& bad : {HalfDiffAngles{0, 0, kNaN}, HalfDiffAngles{0, 0, 100}}) {
    EXPECT_NE(ErrorOf([&] { kGrid.Bin(bad); }), "");
    EXPECT_NE(ErrorOf([&] { tabulated.Interpolate(bad); }), "");
  }
  EXPECT_NE(ErrorOf([&] { unclamped(HalfDiffAngles{0.1, 0.1, 0}, {kNaN, 1}); }), "");
  const auto evaluate = [&](const DirectionPair& pair) { return Evaluate(model, pair); };
  for (const double theta : {kNaN, -0.1, kPi / 2, kInfinity}) {
    EXPECT_THAT(ErrorOf([&] { DirectionalAlbedo(evaluate, theta); }), HasSubstr("theta_i"));
  }
}

TEST(Arguments, TablesAndGrids) {
  BrdfTable table = RandomTable(kGrid, 1);
  table.stored[2].pop_back();
  EXPECT_THAT(ErrorOf([&] { ValidSamples(table); }), HasSubstr("239 values"));
  EXPECT_THAT(ErrorOf([&] { CountBins(table); }), HasSubstr("239 values"));
  EXPECT_THAT(ErrorOf([&] { TabulatedBrdf{table}; }), HasSubstr("239 values"));
  EXPECT_THAT(ErrorOf([&] { LimitAngles(1, Unmeasured::kBeyondMaxAngle, &table); }),
              HasSubstr("239 values"));
  table = RandomTable(kGrid, 1);
  table.unmeasured.resize(3);
  EXPECT_THAT(ErrorOf([&] { ValidBins(table); }), HasSubstr("3 bins"));
  table.unmeasured.clear();
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_NE(ErrorOf([&] { LimitAngles(bad, Unmeasured::kBeyondMaxAngle, &table); }), "");
  }
  EXPECT_NE(ErrorOf([&] { LimitThetaD(kNaN, &table); }), "");
  for (const MerlGrid& bad : {MerlGrid{.theta_h = 0}, MerlGrid{.theta_d = -1},
                              MerlGrid{.theta_h = 1 << 20, .theta_d = 1 << 20}}) {
    EXPECT_THAT(ErrorOf([&] { MakeInvalidTable("bad", bad); }), HasSubstr("grid"));
    EXPECT_THAT(ErrorOf([&] { BinsAboveSurface(bad); }), HasSubstr("grid"));
    EXPECT_THAT(ErrorOf([&] { Reconstruct(FactorModel(), "bad", bad); }), HasSubstr("grid"));
  }
  EXPECT_NE(ErrorOf([] { VisibleSolidAngles(0); }), "");
}

TEST(Arguments, AxesAndTheirEntries) {
  for (const int phi : {0, -1, 1 << 30}) EXPECT_NE(ErrorOf([&] { Axis::Polar({0, 10}, phi); }), "");
  EXPECT_NE(ErrorOf([] { Axis::Polar({}, 1); }), "");
  EXPECT_NE(ErrorOf([] { Axis::Polar(std::vector<double>(1 << 20), 1 << 20); }), "");
  for (const int thetas : {0, -1, 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { Axis::EvenPolar(thetas, Axis::Steps::kOfTheta, 4); }),
                HasSubstr("from 1 to 2048"));
  }
  // Members say what they like.
  const Axis no_nodes = {.rule = Axis::Rule::kPolar, .size = 4, .theta = {}, .phi_nodes = 0};
  EXPECT_THAT(ErrorOf([&] { no_nodes.At(0, 0); }), HasSubstr("cannot have 0 x 0 nodes"));
  EXPECT_FALSE(no_nodes.reaches_horizon());
  for (const auto rule : {Axis::Rule::kRootTheta, Axis::Rule::kTheta, Axis::Rule::kSpline}) {
    EXPECT_NE(ErrorOf([&] { Axis{.rule = rule, .size = 0}.At(0, 0); }), "");
  }
  for (const Axis& axis : {Axis::Utia(), Axis{.rule = Axis::Rule::kTheta, .size = 5}}) {
    for (const int entry : {-1, axis.size, 1 << 30}) {
      EXPECT_THAT(ErrorOf([&] { axis.Theta(entry); }), HasSubstr("must be from 0 to "));
      EXPECT_THAT(ErrorOf([&] { axis.Phi(entry); }), HasSubstr("must be from 0 to "));
      EXPECT_THAT(ErrorOf([&] { axis.CellOf(entry); }), HasSubstr("must be from 0 to "));
    }
  }
  EXPECT_NE(ErrorOf([] { OnCircle(kNaN, 4); }), "");
  EXPECT_NE(ErrorOf([] { OnCircle(1, 0); }), "");
  EXPECT_NE(ErrorOf([] { LinearStencil(0.5, 1); }), "");
  EXPECT_THAT(ErrorOf([] { ProjectedIntegral(Axis::Utia(), std::vector<double>(3)); }),
              HasSubstr("must have 288"));
}

TEST(Arguments, BinsNodesAndSamples) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  for (const int bin : {-1, kGrid.size(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { GridStencils(spec, kGrid, bin); }), HasSubstr("from 0 to 239"));
    EXPECT_THAT(ErrorOf([&] { kGrid.Center(bin); }), HasSubstr("from 0 to 239"));
  }
  EXPECT_NE(ErrorOf([] { MerlGrid{.phi_d = 0}.Center(0); }), "");
  const HemisphereGrid nodes = {2, 3};
  for (const int node : {-1, 6}) {
    EXPECT_NE(ErrorOf([&] { nodes.Theta(node); }), "");
    EXPECT_NE(ErrorOf([&] { nodes.Angles(0, node); }), "");
  }
  for (const HemisphereGrid& bad : {HemisphereGrid{0, 3}, {3, 0}, {-1, -1}, {1 << 20, 1 << 20}}) {
    EXPECT_THAT(ErrorOf([&] { CheckHemisphereGrid(bad); }), HasSubstr("at least one"));
  }
  for (const BrdfSamples& samples : {Samples(), Scattered(Samples())}) {
    for (const int j : {-1, samples.size()}) {
      EXPECT_NE(ErrorOf([&] { samples.Angles(j); }), "");
      EXPECT_NE(ErrorOf([&] { samples.Multiplicity(j); }), "");
      EXPECT_NE(ErrorOf([&] { samples.CosinesOf(j); }), "");
      EXPECT_NE(ErrorOf([&] { samples.SolidAngle(j); }), "");
    }
  }
}

TEST(Arguments, NullsAndEmptyFunctions) {
  const std::vector<double> coverage(1000, 1.0);
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1);
  const auto null = HasSubstr("must not be null");
  EXPECT_THAT(ErrorOf([&] { Canonicalize(coverage, nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { Canonicalize(MakeObjective(Samples()), nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { NormalizeScale(coverage, nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { FillFromNeighbors(coverage, nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { ContinueBeyondData(coverage, 1, nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, nullptr); }), null);
  EXPECT_THAT(ErrorOf([&] { ExpandStored(TableLayout::Full(model.spec()), nullptr); }), null);
  EXPECT_THAT(ErrorOf([] { LimitAngles(1, Unmeasured::kBeyondMaxAngle, nullptr); }), null);
  EXPECT_THAT(ErrorOf([] { LimitThetaD(1, static_cast<BrdfTable*>(nullptr)); }), null);
  const auto empty = HasSubstr("not empty");
  EXPECT_THAT(ErrorOf([] { DirectionalAlbedo(nullptr, 0); }), empty);
  EXPECT_THAT(ErrorOf([] { ReciprocityError(nullptr, kGrid, 1); }), empty);
  const auto black = [](const DirectionPair&) { return Rgb{}; };
  EXPECT_THAT(ErrorOf([&] { ReciprocityError(black, kGrid, 1, nullptr); }), empty);
  const auto threads = HasSubstr("num_threads");
  const std::vector<double> angles = {0};
  for (const int bad : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { DirectionalAlbedos(black, angles, bad); }), threads);
    EXPECT_THAT(ErrorOf([&] { Reconstruct(model, "model", kGrid, bad); }), threads);
    const std::vector<double> all(model.parameters().size(), 1.0);
    EXPECT_THAT(ErrorOf([&] { ComputeLobeLight(all, model, bad); }), threads);
    FactorModel copy = model;
    EXPECT_THAT(ErrorOf([&] { Canonicalize(all, &copy, LobeOrder::kByLight, bad); }), threads);
  }
}

TEST(Arguments, SizesOfArrays) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  FactorModel model = RandomModel(spec, 1);
  const std::vector<double> coverage(model.parameters().size() - 1, 1.0);
  EXPECT_THAT(ErrorOf([&] { Canonicalize(coverage, &model); }), HasSubstr("coverage"));
  EXPECT_THAT(ErrorOf([&] { NormalizeScale(coverage, &model); }), HasSubstr("coverage"));
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, &model); }),
              HasSubstr("coverage"));
  EXPECT_THAT(ErrorOf([&] { ComputeLobeLight(coverage, model); }), HasSubstr("coverage"));
  FactorModel other;
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, &other); }),
              HasSubstr("another spec"));
  const LobeLight light =
      ComputeLobeLight(std::vector<double>(model.parameters().size(), 1.0), model);
  for (const int lobe : {-1, 1}) EXPECT_NE(ErrorOf([&] { light.Share(lobe); }), "");
  EXPECT_THAT(ErrorOf([] { CatmullRom(6).Pieces(std::vector<double>(5)); }), HasSubstr("not 5"));
  EXPECT_NE(ErrorOf([] { WeightsAt({}, 0); }), "");
  const std::vector<double> angles = {0, 1};
  EXPECT_NE(ErrorOf([&] { AlbedoPassesOne(angles, std::vector<Rgb>(3), 0); }), "");
  EXPECT_NE(ErrorOf([&] { AlbedoPassesOne(angles, std::vector<Rgb>(2), 3); }), "");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
