// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/beyond_data.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "model/objective/unclamped_model.h"
#include "tests/error_of.h"
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

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

BrdfSamples Samples() { return ValidSamples(RandomTable(kGrid, 1)); }

Objective MakeObjective(BrdfSamples samples, int num_threads = 1) {
  return {std::move(samples), ModelSpec::SharedFactors(1, kGrid), FindWeighting("appearance"),
          num_threads};
}

// The error for samples with something changed.
std::optional<Error> ErrorWith(const std::function<void(BrdfSamples*)>& change,
                               bool scattered = false) {
  BrdfSamples samples = scattered ? Scattered(Samples()) : Samples();
  change(&samples);
  return ErrorOf([&] { MakeObjective(samples); });
}

TEST(Arguments, SamplesOfAnObjective) {
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { *changed = Selected(*changed, {}); }),
              IsError(ErrorKind::kData, {.key = "samples", .value = "0"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.pop_back(); }),
              IsError(ErrorKind::kMismatch, {.key = "bins", .value = "152"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.clear(); }),
              IsError(ErrorKind::kMismatch, {.key = "bins", .value = "0"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins[0] = -1; }),
              IsError(ErrorKind::kRange, {.key = "sample 0", .value = "bin -1"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.back() = kGrid.size(); }),
              IsError(ErrorKind::kRange, {.key = "sample 152", .value = "bin 240"}));
  EXPECT_THAT(
      ErrorWith([](BrdfSamples* changed) { std::swap(changed->bins[3], changed->bins[4]); }),
      IsError(ErrorKind::kRange, {.key = "sample 4", .value = "bin 5"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins[4] = changed->bins[3]; }),
              IsError(ErrorKind::kRange, {.key = "sample 4", .value = "bin 5"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->bins.back() = kGrid.Index(5, 4, 0); }),
              IsError(ErrorKind::kRange, {.key = "sample 152", .value = "below the surface"}));
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) {
                changed->multiplicity = {1, 1};
              }),
              IsError(ErrorKind::kMismatch, {.key = "multiplicities", .value = "2"}));
  for (const double bad : {-1e-300, -1.0, kNaN, kInfinity}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->rho[3][1] = bad; }),
                IsError(ErrorKind::kRange, {.key = "sample 3"}));
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) {
                  changed->multiplicity.assign(changed->size(), 1);
                  changed->multiplicity[5] = bad;
                }),
                IsError(ErrorKind::kRange, {.key = "sample 5", .value = "multiplicity"}));
  }
  for (const HalfDiffAngles& bad :
       {HalfDiffAngles{kNaN, 0, 0}, HalfDiffAngles{0, kNaN, 0}, HalfDiffAngles{0, 0, kNaN},
        HalfDiffAngles{-0.1, 0, 0}, HalfDiffAngles{0, 2, 0}, HalfDiffAngles{1.5, 1.5, 0}}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->angles[2] = bad; }, true),
                IsError(ErrorKind::kRange, {.key = "sample 2"}));
  }
  EXPECT_THAT(ErrorWith([](BrdfSamples* changed) { changed->angles.pop_back(); }, true),
              IsError(ErrorKind::kMismatch, {.key = "angles", .value = "152"}));
  for (const int phi_d : {0, -1, 1 << 30}) {
    EXPECT_THAT(ErrorWith([&](BrdfSamples* changed) { changed->grid.phi_d = phi_d; }),
                IsError(ErrorKind::kRange, {.key = "grid of bins"}));
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
      EXPECT_THAT(ErrorOf([&] { CheckSamples(below); }),
                  IsError(ErrorKind::kRange, {.key = "sample 0", .value = "below the surface"}))
          << bin;
    }
  }
}

TEST(Arguments, OfAnObjective) {
  for (const int threads : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { MakeObjective(Samples(), threads); }),
                IsError(ErrorKind::kRange, {.key = "num_threads"}));
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
                  IsError(ErrorKind::kRange, {.key = "weighting", .value = "own"}))
          << bad;
    }
  }
  EXPECT_THAT(ErrorOf([&] { Objective(Samples(), spec, {.name = "own", .description = ""}); }),
              IsError(ErrorKind::kMissing, {.key = "weighting", .value = "own"}));

  const Objective objective = MakeObjective(Samples());
  for (const ModelSpec& other : {ModelSpec::SharedFactors(2, kGrid), ModelSpec::SharedFactors(1),
                                 ModelSpec::IndependentG(kGrid)}) {
    EXPECT_THAT(ErrorOf([&] { objective.Value(FactorModel(other)); }),
                IsError(ErrorKind::kMismatch, {.key = "spec"}));
    EXPECT_THAT(ErrorOf([&] { ScoreModel(objective, FactorModel(other)); }),
                IsError(ErrorKind::kMismatch, {.key = "spec"}));
    ParameterBlocks blocks(spec);
    FactorModel model(other);
    EXPECT_THAT(ErrorOf([&] { blocks.Read(model); }),
                IsError(ErrorKind::kMismatch, {.key = "spec"}));
    EXPECT_THAT(ErrorOf([&] { blocks.Write(&model); }),
                IsError(ErrorKind::kMismatch, {.key = "spec"}));
  }
  for (const int j : {-1, objective.samples().size()}) {
    EXPECT_THAT(ErrorOf([&] { objective.Sample(j); }),
                IsError(ErrorKind::kRange, {.key = "sample"}));
  }
  EXPECT_THAT(ErrorOf([&] { MakeObjective(Scattered(Samples())).spline_cells(); }),
              IsError(ErrorKind::kUnsupported, {.key = "grid"}));
  EXPECT_THAT(ErrorOf([&] { ScoreValues(objective, std::vector<Rgb>(3)); }),
              IsError(ErrorKind::kMismatch, {.key = "values", .value = "3"}));
}

TEST(Arguments, ParameterBlocksAndWhatReadsThem) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  ParameterBlocks blocks(spec);
  for (const int b : {-1, blocks.num_blocks(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { blocks.block(b); }),
                IsError(ErrorKind::kRange, {.key = "the parameter block"}));
    EXPECT_THAT(ErrorOf([&] { blocks.parameters(b); }),
                IsError(ErrorKind::kRange, {.key = "the parameter block"}));
  }
  for (const int entry : {-1, spec.d_axis.size}) {
    EXPECT_THAT(ErrorOf([&] { blocks.row(Factor::kD, entry); }),
                IsError(ErrorKind::kRange, {.key = "the entry of a table"}));
  }
  const ParameterBlocks diffuse(ModelSpec::SharedFactors(0, kGrid));
  EXPECT_THAT(ErrorOf([&] { diffuse.row(Factor::kF, 0); }),
              IsError(ErrorKind::kRange, {.key = "the entry of a table", .value = "0"}));
  EXPECT_THAT(ErrorOf([&] { blocks.Write(nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));

  const WeightedSample sample = MakeObjective(Samples()).Sample(0);
  std::vector<int> read;
  EXPECT_NO_THROW(SampleResidual(blocks, sample, &read));
  const auto error_with = [&](const std::function<void(WeightedSample*)>& change) {
    WeightedSample changed = sample;
    change(&changed);
    return ErrorOf([&] { SampleResidual(blocks, changed, &read); });
  };
  EXPECT_THAT(ErrorOf([&] { SampleResidual(blocks, sample, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the numbers of blocks"}));
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_THAT(error_with([&](WeightedSample* changed) { changed->weight[1] = bad; }),
                IsError(ErrorKind::kRange, {.key = "the weight of a sample"}));
  }
  EXPECT_THAT(error_with([](WeightedSample* changed) { changed->stencils.F.index[0] = 5; }),
              IsError(ErrorKind::kRange, {.key = "the entry of a table", .value = "5"}));
  for (const int size : {0, 5}) {
    EXPECT_THAT(error_with([&](WeightedSample* changed) { changed->stencils.G_o.size = size; }),
                IsError(ErrorKind::kRange, {.key = "the last entry of a stencil"}));
  }
  EXPECT_THAT(error_with([](WeightedSample* changed) { changed->stencils.more_D.resize(1); }),
              IsError(ErrorKind::kMismatch, {.key = "stencils of D", .value = "2"}));
}

TEST(Arguments, NumbersOfSamples) {
  const BrdfSamples samples = Samples();
  for (const int j : {-1, samples.size(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] {
                  Selected(samples, {0, j});
                }),
                IsError(ErrorKind::kRange, {.key = "sample"}));
  }
  for (const int stride : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { Thinned(samples, stride); }),
                IsError(ErrorKind::kRange, {.key = "stride"}));
  }
  BrdfSamples no_bins = samples;
  no_bins.bins.clear();
  EXPECT_THAT(ErrorOf([&] { Selected(no_bins, {0}); }),
              IsError(ErrorKind::kMismatch, {.key = "bins", .value = "0"}));
  EXPECT_THAT(ErrorOf([&] { Thinned(no_bins, 2); }),
              IsError(ErrorKind::kMismatch, {.key = "bins", .value = "0"}));
  EXPECT_THAT(ErrorOf([&] {
                EvaluateSamples(FactorModel(ModelSpec::SharedFactors(1, kGrid)), no_bins, 1);
              }),
              IsError(ErrorKind::kMismatch, {.key = "bins", .value = "0"}));
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
    EXPECT_THAT(ErrorOf([&] { Evaluate(model, bad); }),
                IsError(ErrorKind::kRange, {.key = "coordinate", .value = "nan"}));
    EXPECT_THAT(ErrorOf([&] { tabulated(bad); }),
                IsError(ErrorKind::kRange, {.key = "theta_h, theta_d, phi_d"}));
    EXPECT_THAT(ErrorOf([&] { tabulated.Interpolate(bad); }),
                IsError(ErrorKind::kRange, {.key = "theta_h, theta_d, phi_d"}));
  }
  for (const HalfDiffAngles& bad :
       {HalfDiffAngles{kNaN, 0, 0}, HalfDiffAngles{0, kNaN, 0}, HalfDiffAngles{-1, 0, 0}}) {
    EXPECT_THAT(ErrorOf([&] { ScatteredStencils(model.spec(), bad); }),
                IsError(ErrorKind::kRange, {.key = "coordinate", .value = "nan"}));
    EXPECT_THAT(ErrorOf([&] {
                  unclamped(bad, {1, 1});
                }),
                IsError(ErrorKind::kRange, {.key = "coordinate", .value = "nan"}));
    EXPECT_THAT(ErrorOf([&] { kGrid.Bin(bad); }),
                IsError(ErrorKind::kRange, {.key = "theta_h, theta_d, phi_d"}));
  }
  for (const HalfDiffAngles& bad : {HalfDiffAngles{0, 0, kNaN}, HalfDiffAngles{0, 0, 100}}) {
    EXPECT_THAT(ErrorOf([&] { kGrid.Bin(bad); }),
                IsError(ErrorKind::kRange, {.key = "theta_h, theta_d, phi_d"}));
    EXPECT_THAT(ErrorOf([&] { tabulated.Interpolate(bad); }),
                IsError(ErrorKind::kRange, {.key = "theta_h, theta_d, phi_d"}));
  }
  EXPECT_THAT(ErrorOf([&] {
                unclamped(HalfDiffAngles{0.1, 0.1, 0}, {kNaN, 1});
              }),
              IsError(ErrorKind::kRange, {.key = "theta", .value = "nan"}));
  const auto evaluate = [&](const DirectionPair& pair) { return Evaluate(model, pair); };
  for (const double theta : {kNaN, -0.1, kPi / 2, kInfinity}) {
    EXPECT_THAT(ErrorOf([&] { DirectionalAlbedo(evaluate, theta); }),
                IsError(ErrorKind::kRange, {.key = "theta_i"}));
  }
}

TEST(Arguments, BinsNodesAndSamples) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  for (const int bin : {-1, kGrid.size(), 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { GridStencils(spec, kGrid, bin); }),
                IsError(ErrorKind::kRange, {.key = "the bin"}));
    EXPECT_THAT(ErrorOf([&] { kGrid.Center(bin); }),
                IsError(ErrorKind::kRange, {.key = "the bin"}));
  }
  EXPECT_THAT(ErrorOf([] { MerlGrid{.phi_d = 0}.Center(0); }),
              IsError(ErrorKind::kRange, {.key = "the bin", .value = "0"}));
  const HemisphereGrid nodes = {2, 3};
  for (const int node : {-1, 6}) {
    EXPECT_THAT(ErrorOf([&] { nodes.Theta(node); }),
                IsError(ErrorKind::kRange, {.key = "the node"}));
    EXPECT_THAT(ErrorOf([&] { nodes.Angles(0, node); }),
                IsError(ErrorKind::kRange, {.key = "the node"}));
  }
  for (const HemisphereGrid& bad : {HemisphereGrid{0, 3}, {3, 0}, {-1, -1}, {1 << 20, 1 << 20}}) {
    EXPECT_THAT(ErrorOf([&] { CheckHemisphereGrid(bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of directions"}));
  }
  for (const BrdfSamples& samples : {Samples(), Scattered(Samples())}) {
    for (const int j : {-1, samples.size()}) {
      EXPECT_THAT(ErrorOf([&] { samples.Angles(j); }),
                  IsError(ErrorKind::kRange, {.key = "the sample"}));
      EXPECT_THAT(ErrorOf([&] { samples.Multiplicity(j); }),
                  IsError(ErrorKind::kRange, {.key = "the sample"}));
      EXPECT_THAT(ErrorOf([&] { samples.CosinesOf(j); }),
                  IsError(ErrorKind::kRange, {.key = "the sample"}));
      EXPECT_THAT(ErrorOf([&] { samples.SolidAngle(j); }),
                  IsError(ErrorKind::kRange, {.key = "the sample"}));
    }
  }
}

TEST(Arguments, NullsAndEmptyFunctions) {
  const std::vector<double> coverage(1000, 1.0);
  const FactorModel model = RandomModel(ModelSpec::SharedFactors(1, kGrid), 1);
  EXPECT_THAT(ErrorOf([&] { Canonicalize(coverage, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { Canonicalize(MakeObjective(Samples()), nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { NormalizeScale(coverage, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { FillFromNeighbors(coverage, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { ContinueBeyondData(coverage, 1, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([&] { ExpandStored(TableLayout::Full(model.spec()), nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the model"}));
  EXPECT_THAT(ErrorOf([] { LimitAngles(1, Unmeasured::kBeyondMaxAngle, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the table"}));
  EXPECT_THAT(ErrorOf([] { LimitThetaD(1, static_cast<BrdfTable*>(nullptr)); }),
              IsError(ErrorKind::kMissing, {.key = "the table"}));
  EXPECT_THAT(ErrorOf([] { DirectionalAlbedo(nullptr, 0); }),
              IsError(ErrorKind::kMissing, {.key = "brdf"}));
  EXPECT_THAT(ErrorOf([] { ReciprocityError(nullptr, kGrid, 1); }),
              IsError(ErrorKind::kMissing, {.key = "brdf"}));
  const auto black = [](const DirectionPair&) { return Rgb{}; };
  EXPECT_THAT(ErrorOf([&] { ReciprocityError(black, kGrid, 1, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "measured"}));
  const std::vector<double> angles = {0};
  for (const int bad : {0, -1}) {
    EXPECT_THAT(ErrorOf([&] { DirectionalAlbedos(black, angles, bad); }),
                IsError(ErrorKind::kRange, {.key = "num_threads"}));
    EXPECT_THAT(ErrorOf([&] { Reconstruct(model, "model", kGrid, bad); }),
                IsError(ErrorKind::kRange, {.key = "num_threads"}));
    const std::vector<double> all(model.parameters().size(), 1.0);
    EXPECT_THAT(ErrorOf([&] { ComputeLobeLight(all, model, bad); }),
                IsError(ErrorKind::kRange, {.key = "num_threads"}));
    FactorModel copy = model;
    EXPECT_THAT(ErrorOf([&] { Canonicalize(all, &copy, LobeOrder::kByLight, bad); }),
                IsError(ErrorKind::kRange, {.key = "num_threads"}));
  }
}

TEST(Arguments, SizesOfArrays) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  FactorModel model = RandomModel(spec, 1);
  const std::vector<double> coverage(model.parameters().size() - 1, 1.0);
  EXPECT_THAT(ErrorOf([&] { Canonicalize(coverage, &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "31"}));
  EXPECT_THAT(ErrorOf([&] { NormalizeScale(coverage, &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "31"}));
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "31"}));
  EXPECT_THAT(ErrorOf([&] { ComputeLobeLight(coverage, model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "31"}));
  FactorModel other;
  EXPECT_THAT(ErrorOf([&] { CopyUnobservedParameters(coverage, model, &other); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  const LobeLight light =
      ComputeLobeLight(std::vector<double>(model.parameters().size(), 1.0), model);
  for (const int lobe : {-1, 1}) {
    EXPECT_THAT(ErrorOf([&] { light.Share(lobe); }), IsError(ErrorKind::kRange, {.key = "lobe"}));
  }
  EXPECT_THAT(ErrorOf([] { CatmullRom(6).Pieces(std::vector<double>(5)); }),
              IsError(ErrorKind::kMismatch, {.key = "values", .value = "5"}));
  EXPECT_THAT(ErrorOf([] { WeightsAt({}, 0); }), IsError(ErrorKind::kMissing, {.key = "nodes"}));
  const std::vector<double> angles = {0, 1};
  EXPECT_THAT(ErrorOf([&] { AlbedoPassesOne(angles, std::vector<Rgb>(3), 0); }),
              IsError(ErrorKind::kMismatch, {.key = "albedo", .value = "3"}));
  EXPECT_THAT(ErrorOf([&] { AlbedoPassesOne(angles, std::vector<Rgb>(2), 3); }),
              IsError(ErrorKind::kMismatch, {.key = "albedo", .value = "2"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
