// A plan's scores of a model are those of `trilobe score` for the file that is written, to the bit.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "fit/scene/directions.h"
#include "fit/scene/scene_fit.h"
#include "fit/scene/scene_reads.h"
#include "model/appearance/picture_data.h"
#include "model/appearance/verdict.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/read_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr const char* kTable = "synth:plastic@18x18x36";
constexpr const char* kCloth = "synth:velvet@4x8";

// Budgets of each unit; the first few go for all materials.
constexpr size_t kFew = 3;
constexpr SceneBudget kBudgets[] = {
    {SceneBudget::Unit::kMeanDeltaE, 2},       {SceneBudget::Unit::kRelativeRise, 0.05},
    {SceneBudget::Unit::kBytes, 400},          {SceneBudget::Unit::kMeanDeltaE, 0.05},
    {SceneBudget::Unit::kSpherePsnr, 35},      {SceneBudget::Unit::kPsnrDrop, 0.5},
    {SceneBudget::Unit::kRelativeRise, -0.02}, {SceneBudget::Unit::kSeconds, 20}};

SceneFitSettings Settings(const FitCache& cache = {}) {
  SceneFitSettings settings;
  settings.fit.solver = "awls";
  settings.options.max_iterations = 2;
  settings.options.diagnose = false;
  settings.fit.init = "analytic";
  settings.fit.weighting = FindWeighting("compressive");
  settings.fit.form.lobes = 2;
  settings.source.noise = 0.02;
  settings.program = "test";
  settings.appearance = {.lights = 6, .size = 24};
  settings.verdicts = true;
  settings.cache = cache;
  return settings;
}

Measurement Measured(const std::string& source, double max_angle = 90) {
  return LoadMeasurement(source, {.noise = Settings().source.noise, .max_angle_deg = max_angle});
}

SceneMaterial Material(const std::string& source) {
  SceneMaterial material;
  material.name = "material";
  material.source = source;
  return material;
}

DirectionRanges Within(double degrees) {
  return {{0, DegreesToRadians(degrees)}, {0, DegreesToRadians(degrees)}};
}

// The bins at whose centres both directions are within this angle, each read once.
DirectionHistogram OccurrencesWithin(double degrees) {
  const BrdfTable table = TableOf(Measured(kTable, degrees));
  DirectionHistogram histogram{"counts", table.grid, std::vector<double>(table.grid.size())};
  for (const int bin : ValidSamples(table).bins) histogram.counts[bin] = 1;
  return histogram;
}

Measurement InGrey(Measurement measured) {
  BrdfTable& table = *measured.table;
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    const double grey =
        0.2126 * table.Value(0, bin) + 0.7152 * table.Value(1, bin) + 0.0722 * table.Value(2, bin);
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, grey);
  }
  return measured;
}

// `seen` is what `trilobe score` is given, and `rounding` that of values that it has divided by a
// file's scale.
void ExpectAsWritten(const MaterialFit& fit, const Measurement& seen, double rounding = 0) {
  const ModelFile written = ParseModel(FormatModel(fit.file), "written");
  const FactorModel& model = written.model;
  const Objective objective(SamplesOf(seen), model.spec(), Settings().fit.weighting, 1);
  const ScoreReport score = ScoreModel(objective, model);
  EXPECT_EQ(fit.used_samples, score.valid_samples);
  EXPECT_EQ(written.fit.objective, fit.pruned.objective);
  EXPECT_NEAR(fit.pruned.objective, score.objective, rounding * score.objective);
  EXPECT_NEAR(fit.pruned.psnr_db, score.psnr_db, rounding * score.psnr_db);
  const PictureData pictured = PictureDataOf(seen);
  SeenError error;
  if (pictured.empty()) {
    const BrdfSamples& samples = objective.samples();
    error =
        CompareSampledSphere(samples, EvaluateSamples(model, samples, 1),
                             MaterialOf(model).spherical, seen.anisotropic, Settings().appearance);
  } else {
    error = CompareAppearance(pictured, MaterialOf(model), Settings().appearance).sphere;
  }
  EXPECT_FALSE(fit.judged_by_reads);
  EXPECT_EQ(fit.pruned.mean_delta_e, error.mean_delta_e);
  EXPECT_EQ(fit.pruned.seen_psnr_db, error.psnr_db);
  EXPECT_EQ(fit.verdict, Words(VerdictOf(error)));
}

// Each step goes on from the one before, down to what is written; and says why if it adds.
void ExpectDecisionsLeadThere(const MaterialFit& fit, const SceneBudget& budget) {
  int parameters = fit.full_parameters;
  for (const PruneDecision& decision : fit.decisions) {
    if (decision.adds) {
      EXPECT_THAT(decision.why, testing::HasSubstr(budget.unit == SceneBudget::Unit::kBytes
                                                       ? "the budget has room"
                                                       : "the budget is missed"));
      EXPECT_THAT(decision.why,
                  testing::HasSubstr(decision.taken ? "below the full model's" : "hardly nearer"));
    }
    if (!decision.taken) continue;
    EXPECT_EQ(decision.parameters_before, parameters) << decision.what;
    parameters = decision.parameters_after;
  }
  EXPECT_EQ(parameters, fit.num_parameters);
}

// Checks the fits of the material within each of the first `budgets` budgets.
void ExpectJudgedAsWritten(SceneMaterial material, const Measurement& seen, size_t budgets = kFew,
                           double rounding = 0) {
  const TestDirectory directory;
  const SceneFitSettings settings = Settings(FitCache(directory.path()));
  for (const SceneBudget& budget : std::span(kBudgets).first(budgets)) {
    const testing::ScopedTrace trace(__FILE__, __LINE__,
                                     material.source + ", budget " +
                                         std::to_string(static_cast<int>(budget.unit)) + " of " +
                                         std::to_string(budget.amount));
    material.budget = budget;
    const auto fit = FitMaterial(material, settings, 1);
    ASSERT_TRUE(fit);
    ExpectAsWritten(*fit, seen, rounding);
    ExpectDecisionsLeadThere(*fit, budget);
  }
}

TEST(JudgedAsWritten, OverAllDirections) {
  ExpectJudgedAsWritten(Material(kTable), Measured(kTable));
}

TEST(JudgedAsWritten, WithinEachBudget) {
  SceneMaterial material = Material(kTable);
  material.directions = Within(60);
  ExpectJudgedAsWritten(material, Measured(kTable, 60), std::size(kBudgets));
}

TEST(JudgedAsWritten, InLuminance) {
  SceneMaterial material = Material(kTable);
  material.channels = SceneChannels::kLuminance;
  material.directions = Within(60);
  ExpectJudgedAsWritten(material, InGrey(Measured(kTable, 60)), kFew, /*rounding=*/1e-13);
}

// Checks scores by the reads of the measurement, for the model as its file has it.
void ExpectJudgedByReads(SceneMaterial material) {
  const TestDirectory directory;
  const SceneFitSettings settings = Settings(FitCache(directory.path()));
  for (const SceneBudget& budget : std::span(kBudgets).first(kFew)) {
    material.budget = budget;
    const auto fit = FitMaterial(material, settings, 1);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->judged_by_reads);
    ExpectDecisionsLeadThere(*fit, budget);
    const FactorModel model = ParseModel(FormatModel(fit->file), "written").model;
    const SceneScore score = ScoreOnScene({&model, 1}, material, settings, 1)[0];
    EXPECT_EQ(fit->pruned.objective, score.objective);
    EXPECT_EQ(fit->pruned.psnr_db, score.psnr_db);
    const BrdfSamples all = SamplesOf(Measured(kTable));
    const BrdfSamples used = UsedSamples(all, material.directions);
    EXPECT_TRUE(used.counted);
    const SeenError error = SceneReads(all, used, material.directions).Compare(model, 1);
    EXPECT_EQ(fit->pruned.mean_delta_e, error.mean_delta_e);
    EXPECT_EQ(fit->pruned.seen_psnr_db, error.psnr_db);
    EXPECT_EQ(fit->verdict, Words(VerdictOf(error)));
    if (budget.unit == SceneBudget::Unit::kMeanDeltaE && !fit->misses_budget) {
      EXPECT_LE(error.mean_delta_e, budget.amount);
    }
  }
}

TEST(JudgedAsWritten, WhereAHistogramHasCounts) {
  SceneMaterial material = Material(kTable);
  material.directions = OccurrencesWithin(50);
  ExpectJudgedByReads(material);
}

TEST(JudgedAsWritten, AtAListOfDirections) {
  SceneMaterial material = Material(kTable);
  DirectionList list;
  for (int k = 0; k < 200; ++k) {
    list.directions.push_back({0.6 * k / 200, 1.1 * (k % 29) / 29, kPi * (k % 7) / 7});
  }
  material.directions = list;
  ExpectJudgedByReads(material);
}

// Ranges of directions, too: the sphere of an anisotropic material shows no more than others do.
TEST(JudgedAsWritten, OfAnisotropicMaterials) {
  SceneMaterial material = Material(kCloth);
  ExpectJudgedAsWritten(material, Measured(kCloth));
  material.directions = Within(45);  // a node
  ExpectJudgedAsWritten(material, Measured(kCloth, 45), /*budgets=*/1);
}

TEST(JudgedAsWritten, OfScatteredSamples) {
  const TestDirectory directory;
  std::string text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int k = 0; k < 600; ++k) {
    const int i = 10 * (k % 8), o = 10 * (k / 8 % 8), phi = 24 * (k % 15);
    const double highlight = 1.0 / (1 + (i - o) * (i - o) + (phi - 180) * (phi - 180) / 100.0);
    text += std::to_string(i) + ",0," + std::to_string(o) + "," + std::to_string(phi);
    for (const double base : {0.1, 0.2, 0.3}) text += "," + std::to_string(base + highlight);
    text += "\n";
  }
  SceneMaterial material = Material(directory.Make("some.csv", text));
  material.directions = Within(40);  // which rounding might put beyond 40 degrees
  ExpectJudgedAsWritten(material, Measured(material.source, 40));
}

// How many parameters a material keeps whose sphere may be off by so much. It has enough lights for
// a narrow range to show more than a few bins.
int Kept(SceneMaterial material, const SceneDirections& directions, double mean_delta_e) {
  SceneFitSettings settings = Settings();
  settings.options.max_iterations = 4;
  settings.source.noise = 0;
  settings.appearance = {.lights = 60, .size = 32};
  material.directions = directions;
  material.budget = {SceneBudget::Unit::kMeanDeltaE, mean_delta_e};
  return FitMaterial(material, settings, 1)->num_parameters;
}

TEST(FitMaterial, KeepsNoMoreForNarrowerNeeds) {
  const SceneMaterial table = Material(kTable), cloth = Material("synth:velvet@6x8");
  std::vector<int> by_ranges, by_counts, of_cloth;
  for (const int degrees : {30, 45, 60, 75, 90}) {
    if (!IsOneIn(30, {degrees})) continue;
    by_ranges.push_back(Kept(table, Within(degrees), 2));
    by_counts.push_back(Kept(table, OccurrencesWithin(degrees), 2));
    of_cloth.push_back(Kept(cloth, Within(degrees), 12));
  }
  for (const std::vector<int>& kept : {by_ranges, by_counts, of_cloth}) {
    EXPECT_TRUE(std::ranges::is_sorted(kept)) << testing::PrintToString(kept);
    EXPECT_LT(kept.front(), 50) << testing::PrintToString(kept);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
