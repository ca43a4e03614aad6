// Code that runs on several threads, at sizes small enough for the thread sanitizer (preset
// `tsan`). Without it these tests check that the results are those of one thread.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "fit/finish/data_edge.h"
#include "fit/scene/scene_fit.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 12, .theta_d = 12, .phi_d = 24};
constexpr int kThreads = 3;

bool SameBits(const FactorModel& a, const FactorModel& b) {
  return std::ranges::equal(a.parameters(), b.parameters());
}

BrdfTable Measured() {
  BrdfTable table = RandomTable(kGrid, 1);
  LimitAngles(DegreesToRadians(80), Unmeasured::kBeyondMaxAngle, &table);
  return table;
}

// A fit as the program makes it.
FactorModel Fit(const std::string& solver, const Objective& objective) {
  FactorModel model = FindInitialModel("analytic").make(objective, 1);
  SolverOptions options;
  options.max_iterations = 3;
  options.starts = 4;
  MakeSolver(solver)->Solve(objective, options, &model);
  TieEntriesAtDataEdge(objective, &model);
  ScoreModel(objective, model);
  return model;
}

class Races : public testing::TestWithParam<std::string> {};

TEST_P(Races, OfOneSolver) {
  const BrdfTable table = Measured();
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const FactorModel alone = Fit(GetParam(), MakeObjective(table, spec, "appearance", 1));
  const FactorModel fitted = Fit(GetParam(), MakeObjective(table, spec, "appearance", kThreads));
  // Ceres adds up the cost of lm_plain in the order in which threads finish.
  if (GetParam() == "lm_plain") return;
  EXPECT_TRUE(SameBits(fitted, alone));
}

// An objective prepares some things when they are first asked for, by whichever thread that is.
TEST_P(Races, OnOneObjective) {
  const Objective objective = MakeObjective(Measured(), ModelSpec::SharedFactors(1, kGrid));
  std::vector<FactorModel> models(2);
  {
    std::vector<std::jthread> threads;
    for (FactorModel& model : models) {
      threads.emplace_back([&] { model = Fit(GetParam(), objective); });
    }
  }
  EXPECT_TRUE(SameBits(models[0], models[1]));
}

std::vector<std::string> SolverNames() {
  std::vector<std::string> names;
  for (const SolverEntry& solver : Solvers()) names.push_back(solver.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Races, testing::ValuesIn(SolverNames()),
                         [](const auto& param) { return param.param; });

TEST(RacesInABsdf, OverItsTables) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  std::ranges::fill(model.parameters(), 0.5);
  const Bsdf<double> bsdf(model);
  std::vector<double> drawn(kThreads);
  {
    std::vector<std::jthread> threads;
    for (double& sum : drawn) {
      threads.emplace_back([&] {
        const Bsdf<double> copy = bsdf;
        sum = copy.SampleWo({0, 0, 1}, {0.7, 0.2}).pdf + bsdf.Albedo({0, 0, 1})[0];
      });
    }
  }
  EXPECT_GT(drawn[0], 0);
  for (const double sum : drawn) EXPECT_EQ(sum, drawn[0]);
}

TEST(RacesInScenes, OfMaterialsSideBySide) {
  const TestDirectory directory;
  SceneFitSettings settings;
  settings.fit.solver = "awls";
  settings.options.max_iterations = 2;
  settings.options.diagnose = false;
  settings.fit.init = "analytic";
  settings.fit.weighting = FindWeighting("appearance");
  settings.fit.form.lobes = 1;
  settings.program = "test";
  settings.cache = FitCache(directory.path());
  Scene scene{.path = "scene.json", .materials = {}};
  for (const char* const name : {"felt", "rubber"}) {
    SceneMaterial& material = scene.materials.emplace_back();
    material.name = name;
    material.source = std::string("synth:") + name;
    material.directions = DirectionRanges{{0, 0.2}, {0, 0.2}};
  }
  const auto fits = FitScene(scene, settings, kThreads, [](const MaterialFit&) {});
  settings.cache = FitCache();
  for (size_t k = 0; k < fits.size(); ++k) {
    ASSERT_TRUE(fits[k].fit);
    const auto alone = FitMaterial(scene.materials[k], settings, 1);
    ASSERT_TRUE(alone);
    EXPECT_TRUE(SameBits(fits[k].fit->file.model, alone->file.model)) << fits[k].fit->name;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
