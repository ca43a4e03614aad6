#include "fit/scene/scene_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "fit/finish/limit_light.h"
#include "fit/prune/pruning.h"
#include "tests/test_directory.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Few steps of a fast solver with one lobe: this is not about how well it fits.
SceneFitSettings Settings(const FitCache& cache = {}) {
  SceneFitSettings settings;
  settings.fit.solver = "awls";
  settings.options.max_iterations = 2;
  settings.options.diagnose = false;
  settings.fit.init = "analytic";
  settings.fit.weighting = FindWeighting("compressive");
  settings.fit.form.lobes = 1;
  settings.source.noise = 0.02;
  settings.program = "test";
  settings.cache = cache;
  return settings;
}

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 20, .phi_d = 40};

// The directions that a floor seen from above uses; few, and of a small table, for speed.
SceneMaterial Material(const std::string& synth) {
  SceneMaterial material;
  material.name = synth;
  material.source = "synth:" + synth + "@20x20x40";
  material.directions = DirectionRanges{{0, 0.4}, {0, 0.4}};
  return material;
}

void ExpectSame(const MaterialFit& a, const MaterialFit& b) {
  EXPECT_THAT(a.file.model.parameters(), testing::ElementsAreArray(b.file.model.parameters()));
  EXPECT_EQ(a.file.layout, b.file.layout);
  EXPECT_EQ(a.file.unobserved, b.file.unobserved);
  EXPECT_EQ(a.num_parameters, b.num_parameters);
  EXPECT_EQ(a.full_parameters, b.full_parameters);
  EXPECT_EQ(a.valid_samples, b.valid_samples);
  EXPECT_EQ(a.used_samples, b.used_samples);
  EXPECT_EQ(a.full.objective, b.full.objective);
  EXPECT_EQ(a.pruned.objective, b.pruned.objective);
  EXPECT_EQ(a.pruned.psnr_db, b.pruned.psnr_db);
  ASSERT_EQ(a.decisions.size(), b.decisions.size());
  for (size_t k = 0; k < a.decisions.size(); ++k) {
    EXPECT_EQ(a.decisions[k].what, b.decisions[k].what);
    EXPECT_EQ(a.decisions[k].why, b.decisions[k].why);
    EXPECT_EQ(a.decisions[k].taken, b.decisions[k].taken);
    EXPECT_EQ(a.decisions[k].E_after, b.decisions[k].E_after);
  }
}

TEST(FitMaterial, KeepsWithinTheBudgetAndSaysWhatItDid) {
  const auto fit = FitMaterial(Material("felt"), Settings(), 1);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->name, "felt");
  EXPECT_EQ(fit->full_parameters, ModelSpec::SharedFactors(1, kGrid).num_parameters());
  EXPECT_LT(fit->num_parameters, fit->full_parameters);
  EXPECT_LT(fit->used_samples, fit->valid_samples);
  EXPECT_LE(fit->pruned.objective, 1.01 * fit->full.objective * (1 + 1e-12));
  EXPECT_FALSE(fit->decisions.empty());
  EXPECT_FALSE(fit->fit_from_cache || fit->prune_from_cache);
  const SceneScore again = ScoreOnScene({&fit->file.model, 1}, Material("felt"), Settings(), 2)[0];
  EXPECT_EQ(again.objective, fit->pruned.objective);
  EXPECT_EQ(again.psnr_db, fit->pruned.psnr_db);
}

// Budgets of what is seen hold on the sphere as `trilobe fit` renders it, and are spent.
TEST(FitMaterial, KeepsWithinABudgetOfLook) {
  SceneFitSettings settings = Settings();
  settings.fit.form.lobes = 2;
  settings.appearance = {.lights = 6, .size = 48};
  SceneMaterial material = Material("plastic");
  material.source = "synth:plastic@30x30x60";
  material.directions = AllDirections();
  material.channels = SceneChannels::kLuminance;
  const auto fitted = [&](SceneBudget::Unit unit, double amount) {
    material.budget = {unit, amount};
    return *FitMaterial(material, settings, 1);
  };
  const MaterialFit strict = fitted(SceneBudget::Unit::kMeanDeltaE, 1e-6);
  ASSERT_TRUE(strict.full.mean_delta_e && strict.pruned.seen_psnr_db);
  const double full = *strict.full.mean_delta_e;
  ASSERT_GT(full, 0);
  EXPECT_LE(*strict.pruned.mean_delta_e, full);  // only free reductions, or more lobes
  for (const double amount : {full + 1, full + 3}) {
    const MaterialFit fit = fitted(SceneBudget::Unit::kMeanDeltaE, amount);
    EXPECT_LE(*fit.pruned.mean_delta_e, amount);
    EXPECT_GT(*fit.pruned.mean_delta_e, full);
    EXPECT_LT(2 * fit.num_parameters, fit.full_parameters) << amount;
  }
  const double least = *strict.full.seen_psnr_db - 3;
  const MaterialFit by_psnr = fitted(SceneBudget::Unit::kSpherePsnr, least);
  EXPECT_GE(*by_psnr.pruned.seen_psnr_db, least);
  EXPECT_LT(by_psnr.num_parameters, by_psnr.full_parameters);
}

// Samples on no grid are judged, too.
TEST(FitMaterial, KeepsWithinABudgetOfLookOnScatteredSamples) {
  SceneFitSettings settings = Settings();
  settings.appearance = {.lights = 6, .size = 24};
  const TestDirectory directory;
  WriteFile(directory.Path("few.csv"), [](std::ostream& out) {
    out << "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
    for (int k = 0; k < 64; ++k) {
      out << 10 * (k % 8) << ",0," << 10 * (k / 8) << "," << 37 * k % 360 << ",0.1,0.2,0.3\n";
    }
  });
  SceneMaterial material = Material("");
  material.source = directory.Path("few.csv");
  material.directions = AllDirections();
  material.budget = {SceneBudget::Unit::kMeanDeltaE, 1};
  const auto fit = FitMaterial(material, settings, 1);
  ASSERT_TRUE(fit);
  EXPECT_LE(*fit->pruned.mean_delta_e, 1);
  EXPECT_FALSE(fit->judged_by_reads);
  EXPECT_LE(fit->num_parameters, 10);  // it is nearly Lambertian
}

// A sphere of few lights shows no pixel whose directions are all near the normal.
TEST(FitMaterial, IsJudgedByReadsWhereNoPixelShowsWhatTheSceneSees) {
  SceneFitSettings settings = Settings();
  settings.appearance = {.lights = 6, .size = 24};
  SceneMaterial material = Material("plastic");
  material.directions = DirectionRanges{{0, 0.1}, {0, 0.1}};
  material.budget = {SceneBudget::Unit::kMeanDeltaE, 1};
  const auto fit = FitMaterial(material, settings, 1);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->judged_by_reads);
  EXPECT_LE(*fit->pruned.mean_delta_e, 1);
}

// Few directions need few numbers, and are met: mirror pairs, too.
TEST(FitMaterial, KeepsWhatAListReads) {
  SceneFitSettings settings = Settings();
  settings.fit.solver = "auto";
  settings.options.max_iterations = 60;
  settings.fit.weighting = FindWeighting("appearance");
  settings.fit.form.lobes = 3;
  settings.verdicts = true;
  settings.appearance = {.lights = 6, .size = 24};
  SceneMaterial material = Material("plastic");
  material.source = "synth:plastic@45x45x90";
  material.budget = {SceneBudget::Unit::kMeanDeltaE, 0.5};
  const auto pair = [](double i, double o, double phi) {
    return ToHalfDiff({ToDirection({DegreesToRadians(i), 0}),
                       ToDirection({DegreesToRadians(o), DegreesToRadians(phi)})});
  };
  const std::vector<HalfDiffAngles> pairs = {pair(30, 30, 180), pair(45, 10, 90),
                                             pair(60, 55, 180)};
  int fewer = 0;
  for (const size_t count : {1, 3}) {
    material.directions = DirectionList{{pairs.begin(), pairs.begin() + count}};
    const auto fit = FitMaterial(material, settings, 1);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->judged_by_reads);
    EXPECT_FALSE(fit->misses_budget);
    EXPECT_LE(*fit->pruned.mean_delta_e, 0.5);
    EXPECT_THAT(fit->verdict, testing::HasSubstr("cannot be told apart"));
    EXPECT_LE(fit->num_parameters, 30);
    EXPECT_GE(fit->num_parameters, fewer);
    fewer = fit->num_parameters;
  }
}

// No form is within a budget of next to nothing; a small one that is nearly the best comes.
TEST(FitMaterial, PrunesWhereTheBudgetIsMissed) {
  SceneFitSettings settings = Settings();
  settings.appearance = {.lights = 6, .size = 24};
  SceneMaterial material = Material("plastic");
  material.directions = AllDirections();
  material.budget = {SceneBudget::Unit::kMeanDeltaE, 1e-3};
  const auto fit = FitMaterial(material, settings, 1);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->misses_budget);
  EXPECT_LT(fit->num_parameters, fit->full_parameters);
  EXPECT_TRUE(std::ranges::any_of(fit->decisions, [](const PruneDecision& decision) {
    return decision.what == kWithinBudget && !decision.taken;
  }));
}

// Its sphere is off by what the bins of its narrow highlight are, which no fit mends.
TEST(FitMaterial, NeverAddsToAModel) {
  SceneFitSettings settings = Settings();
  settings.appearance = {.lights = 6, .size = 24};
  SceneMaterial material = Material("");
  material.source = "material:chm_orange";
  material.directions = DirectionRanges{{0, 1.2}, {0, 1.2}};
  material.budget = {SceneBudget::Unit::kMeanDeltaE, 1e-6};
  const auto fit = FitMaterial(material, settings, 1);
  ASSERT_TRUE(fit);
  EXPECT_GT(*fit->full.mean_delta_e, 1e-6);
  EXPECT_LE(fit->num_parameters, fit->full_parameters);
  EXPECT_EQ(fit->file.model.spec().lobes, 3);
}

// A share of 1 % of an E that is almost 0.
TEST(FitMaterial, SaysThatAFractionOfAnExactFitBuysNothing) {
  SceneFitSettings settings = Settings();
  settings.source.noise = 0;
  settings.fit.form.lobes = 0;
  settings.fit.weighting = FindWeighting("uniform");
  SceneMaterial material = Material("felt");
  const TestDirectory directory;
  WriteFile(directory.Path("grey.csv"), [](std::ostream& out) {
    out << "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
    for (int k = 1; k < 9; ++k) out << 10 * k << ",0," << 5 * k << ",170,0.25,0.25,0.25\n";
  });
  material.source = directory.Path("grey.csv");
  material.directions = AllDirections();
  const auto fit = FitMaterial(material, settings, 1);
  ASSERT_TRUE(fit);
  ASSERT_LT(fit->full.objective, 1e-20);
  ASSERT_FALSE(fit->decisions.empty());
  EXPECT_FALSE(fit->decisions.front().taken);
  EXPECT_THAT(fit->decisions.front().why, testing::HasSubstr("practically 0"));
  EXPECT_THAT(fit->decisions.front().why, testing::HasSubstr("mean_delta_e"));
}

TEST(FitMaterial, TakesFromTheCacheWhatItWouldMake) {
  const TestDirectory directory;
  const FitCache cache(directory.path());
  const SceneMaterial material = Material("felt");
  const auto made = FitMaterial(material, Settings(cache), 1);
  ASSERT_TRUE(made);
  EXPECT_EQ(directory.Names().size(), 2U);  // the full fit, and what is left of it
  const auto found = FitMaterial(material, Settings(cache), 2);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->fit_from_cache && found->prune_from_cache);
  ExpectSame(*made, *found);
  EXPECT_EQ(found->fit_seconds, made->fit_seconds);
  // Another name changes nothing, another budget reuses the full fit.
  SceneMaterial other = material;
  other.name = "other";
  EXPECT_EQ(FitMaterial(other, Settings(cache), 1)->name, "other");
  EXPECT_EQ(directory.Names().size(), 2U);
  other.budget.amount = 0.05;
  const auto reused = FitMaterial(other, Settings(cache), 1);
  EXPECT_TRUE(reused->fit_from_cache);
  EXPECT_FALSE(reused->prune_from_cache);
  EXPECT_EQ(reused->fit_seconds, made->fit_seconds);
  EXPECT_EQ(directory.Names().size(), 3U);
  // Torn entries are made again, to the same bits.
  for (const std::string& name : directory.Names()) {
    std::filesystem::resize_file(directory.Path(name), 100);
  }
  const auto remade = FitMaterial(material, Settings(cache), 1);
  EXPECT_FALSE(remade->fit_from_cache || remade->prune_from_cache);
  ExpectSame(*made, *remade);
}

TEST(FitMaterial, AnythingThatMattersMakesAnotherEntry) {
  const TestDirectory directory;
  const FitCache cache(directory.path());
  ASSERT_TRUE(FitMaterial(Material("felt"), Settings(cache), 1));
  const auto expect_new = [&](const SceneMaterial& material, const SceneFitSettings& settings,
                              const char* what) {
    EXPECT_FALSE(FitMaterial(material, settings, 1)->prune_from_cache) << what;
  };
  SceneMaterial material = Material("felt");
  material.directions = DirectionRanges{{0, 0.4}, {0, 0.3}};
  expect_new(material, Settings(cache), "directions");
  material = Material("felt");
  material.reductions.tables = false;
  expect_new(material, Settings(cache), "reductions");
  SceneFitSettings settings = Settings(cache);
  settings.options.max_iterations = 3;
  expect_new(Material("felt"), settings, "options");
  settings = Settings(cache);
  settings.program = "newer";
  expect_new(Material("felt"), settings, "program");
  settings = Settings(cache);
  settings.build = "of other sources";
  expect_new(Material("felt"), settings, "build");
  settings = Settings(cache);
  settings.source.extrapolated = true;
  expect_new(Material("felt"), settings, "extrapolated");
  material = Material("felt");
  for (const auto& [name, text] : std::map<std::string, std::string>{
           {"corrupt", "noise:0.1"}, {"tilt", "2"}, {"cosine", "o:1"}, {"scale", "2"}}) {
    material.options = {{name, text}};
    expect_new(material, Settings(cache), name.c_str());
  }
  settings = Settings(cache);
  settings.source.max_angle_deg = 15;
  const auto whole = FitMaterial(Material("felt"), Settings(cache), 1);
  const auto part = FitMaterial(Material("felt"), settings, 1);
  EXPECT_TRUE(whole->prune_from_cache);
  EXPECT_FALSE(part->fit_from_cache || part->prune_from_cache);
  EXPECT_LT(part->valid_samples, whole->valid_samples);
  EXPECT_LT(part->used_samples, whole->used_samples);
  EXPECT_EQ(whole->file.fit.max_angle, 90);
  EXPECT_EQ(part->file.fit.max_angle, 15);
  EXPECT_TRUE(FitMaterial(Material("felt"), settings, 1)->prune_from_cache);
}

TEST(FitMaterial, InLuminanceIsGrey) {
  SceneMaterial material = Material("felt");
  material.channels = SceneChannels::kLuminance;
  const auto fit = FitMaterial(material, Settings(), 1);
  ASSERT_TRUE(fit);
  const FactorModel& model = fit->file.model;
  EXPECT_EQ(model.d()[0], model.d()[1]);
  EXPECT_EQ(model.d()[0], model.d()[2]);
  EXPECT_FALSE(model.spec().F.per_channel);
}

// Beyond the measured angles, pruned entries must not come back as light.
TEST(FitMaterial, MakesNoLight) {
  SceneFitSettings settings = Settings();
  settings.source.max_angle_deg = 65;
  for (const char* const synth : {"foam", "copper"}) {
    SceneMaterial material = Material(synth);
    material.source = std::string("synth:") + synth + "@30x30x60";
    material.directions = AllDirections();
    material.budget = {SceneBudget::Unit::kRelativeRise, 0.05};
    const auto fit = FitMaterial(material, settings, 1);
    EXPECT_LT(fit->num_parameters, fit->full_parameters);
    EXPECT_LE(PeakLight(fit->file.model, 1).albedo, 1 + 2e-3) << synth;
  }
}

// Three incidences of a metal up to 40 degrees, whose light beyond is limited.
TEST(FitMaterial, KeepsABudgetInEWithinTheLimitOfLight) {
  const TestDirectory directory;
  const BrdfTable metal = Synthesize(FindSynthMaterial("copper"), 0, 1, MerlGrid{});
  std::string text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (const int i : {5, 20, 40}) {
    for (int o = 0; o <= 40; o += 5) {
      for (int phi = 0; phi < 360; phi += 60) {
        const SphericalAngles at = {DegreesToRadians(i), 0, DegreesToRadians(o),
                                    DegreesToRadians(phi)};
        const int bin = metal.grid.Bin(ToHalfDiff(ToDirections(at)));
        text += std::to_string(i) + ",0," + std::to_string(o) + "," + std::to_string(phi);
        for (int c = 0; c < kChannels; ++c) text += "," + std::to_string(metal.Value(c, bin));
        text += "\n";
      }
    }
  }
  SceneMaterial material = Material("metal");
  material.source = directory.Make("metal.csv", text);
  material.directions = AllDirections();
  material.budget = {SceneBudget::Unit::kRelativeRise, 0};
  const auto fit = FitMaterial(material, Settings(), 1);
  EXPECT_LE(fit->pruned.objective, (1 + 1e-6) * fit->full.objective);
  EXPECT_LE(PeakLight(fit->file.model, 1).albedo, 1 + 2e-3);
}

TEST(FitMaterial, ThatIsStoppedKeepsNothing) {
  const TestDirectory directory;
  SceneFitSettings settings = Settings(FitCache(directory.path()));
  settings.stop = [] { return true; };
  EXPECT_EQ(FitMaterial(Material("felt"), settings, 1), std::nullopt);
  EXPECT_TRUE(directory.Names().empty());
}

TEST(FitScene, IsTheSameForAnyNumberOfThreads) {
  const Scene scene{"scene.json", {Material("felt"), Material("rubber"), Material("plastic")}};
  std::vector<std::string> done;
  const auto one =
      FitScene(scene, Settings(), 1, [&](const MaterialFit& fit) { done.push_back(fit.name); });
  EXPECT_EQ(done, (std::vector<std::string>{"felt", "rubber", "plastic"}));
  const auto four = FitScene(scene, Settings(), 4, /*on_done=*/nullptr);
  ASSERT_EQ(one.size(), 3U);
  ASSERT_EQ(four.size(), 3U);
  for (size_t k = 0; k < one.size(); ++k) {
    ASSERT_TRUE(one[k].fit && four[k].fit);
    ExpectSame(*one[k].fit, *four[k].fit);
    EXPECT_EQ(one[k].error, "");
  }
}

TEST(FitScene, OneThatFailsDoesNotStopTheOthers) {
  const TestDirectory directory;
  SceneMaterial broken = Material("felt");
  broken.name = "broken";
  broken.source = directory.Make("broken.binary", "no measurement");
  const Scene scene{"scene.json", {Material("felt"), broken, Material("rubber")}};
  const auto results = FitScene(scene, Settings(), 1, [](const MaterialFit& fit) {
    if (fit.name == "rubber") throw Error(ErrorKind::kFile, "the disk is full");
  });
  ASSERT_EQ(results.size(), 3U);
  EXPECT_TRUE(results[0].fit.has_value());
  EXPECT_EQ(results[0].error, "");
  EXPECT_EQ(results[1].fit, std::nullopt);
  EXPECT_THAT(results[1].error, testing::HasSubstr("broken.binary"));
  EXPECT_EQ(results[2].fit, std::nullopt);
  EXPECT_EQ(results[2].error, "the disk is full");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
