#include "trilobe/fit/finish/node_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

constexpr HemisphereGrid kGrid = {6, 12};

BrdfSamples Velvet(double noise) {
  return SamplesOf(SynthesizeSamples(FindSynthMaterial("velvet"), noise, 1, kGrid));
}

// Each has the nodes of the one before among its own.
std::vector<FormSpec> Nested() {
  std::vector<FormSpec> ladder;
  for (const auto& [name, theta, phis] :
       {std::tuple("coarse", std::vector<double>{0, 30, 60}, 3),
        std::tuple("middle", std::vector<double>{0, 15, 30, 45, 60}, 6),
        std::tuple("fine", std::vector<double>{0, 7.5, 15, 22.5, 30, 37.5, 45, 52.5, 60}, 12)}) {
    ModelSpec spec = ModelSpec::Anisotropic(1);
    spec.d_axis = Axis::Polar(theta, phis);
    spec.f_axis.size = 4;
    spec.g_axis = Axis::Polar({0, 40, 75}, 4);
    ladder.push_back({.name = name, .spec = spec});
  }
  return ladder;
}

// Samples of a model with these nodes, D up and down between them, and 5 % of noise.
BrdfSamples OfModel(const ModelSpec& spec) {
  FactorModel model(spec);
  const std::span<double> x = model.parameters();
  for (size_t k = 0; k < x.size(); ++k) {
    x[k] = 0.5 + 0.4 * std::sin(2.4 * static_cast<double>(k));
  }
  BrdfSamples samples = Velvet(0);
  samples.rho = EvaluateSamples(model, samples, 1);
  for (size_t j = 0; j < samples.rho.size(); ++j) {
    for (double& rho : samples.rho[j]) rho *= 1 + 0.05 * std::sin(static_cast<double>(j * j));
  }
  return samples;
}

NodeChoice Choose(BrdfSamples samples, const std::vector<FormSpec>& ladder,
                  const NodeChoiceOptions& options, int threads = 1) {
  return ChooseNodes(Objective(std::move(samples), ladder[0].spec, Weightings().front(), threads),
                     ladder, options);
}

TEST(HeldOut, IsAFifthOfThePairsEachWithItsTwin) {
  const BrdfSamples samples = Velvet(0);
  const std::vector<bool> held_out = HeldOut(samples, 1);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(held_out, true)),
              0.2 * static_cast<double>(held_out.size()),
              0.02 * static_cast<double>(held_out.size()));
  BrdfSamples twins = samples;
  for (SphericalAngles& at : twins.directions) {
    at = {at.theta_o, at.phi_o - 2 * kPi, at.theta_i, at.phi_i + 2 * kPi};
  }
  EXPECT_EQ(HeldOut(twins, 1), held_out);
  EXPECT_NE(HeldOut(samples, 2), held_out);
}

TEST(HeldOut, AsksForDirections) {
  BrdfSamples samples = Velvet(0);
  samples.directions.clear();
  EXPECT_THAT(ErrorOf([&] { HeldOut(samples, 1); }),
              IsError(ErrorKind::kMissing, {.key = "directions"}));
}

TEST(NodeLadder, ClimbsAsFarAsTheDataDo) {
  const auto names_for = [](int thetas, int phis) {
    std::vector<std::string> names;
    for (const FormSpec& rung : NodeLadder(ModelSpec::Anisotropic(3), thetas, phis)) {
      CheckSpec(rung.spec);
      names.push_back(rung.name);
    }
    return names;
  };
  const ModelSpec by_default = ModelSpec::AnisotropicFor(3, 48, DegreesToRadians(75));
  EXPECT_EQ(NodeLadder(by_default, 6, 48)[1].spec, by_default);
  EXPECT_THAT(names_for(6, 48),
              ElementsAre("D 8rx24, G 6x16", "D 12rx36, G 6x24", "D 16rx48, G 6x24",
                          "D 20rx48, G 6x24", "D 24rx48, G 6x24"));
  EXPECT_THAT(names_for(18, 72),
              ElementsAre("D 8rx24, G 6x16", "D 12rx36, G 6x24", "D 16rx48, G 6x32",
                          "D 20rx60, G 8x36", "D 24rx72, G 10x36"));
  EXPECT_THAT(names_for(4, 3), testing::Contains("D 8rx4, G 6x4"));
}

TEST(ChooseNodes, FinerOnesForDataOfFinerOnes) {
  const std::vector<FormSpec> ladder = Nested();
  int wanted = 0;
  for (const FormSpec& maker : ladder) {
    const NodeChoice choice = Choose(OfModel(maker.spec), ladder, {.prior = 0});
    EXPECT_EQ(choice.tried[choice.chosen].name, maker.name);
    EXPECT_EQ(choice.chosen, wanted++);
    EXPECT_LT(choice.tried[choice.chosen].E, 0.01) << maker.name;
    EXPECT_GT(choice.held_out, 0);
  }
}

TEST(ChooseNodes, IsTheSameOnAnyNumberOfThreads) {
  const NodeChoice one = Choose(Velvet(0.02), Nested(), {}, 1);
  const NodeChoice three = Choose(Velvet(0.02), Nested(), {}, 3);
  ASSERT_EQ(one.tried.size(), three.tried.size());
  EXPECT_EQ(one.chosen, three.chosen);
  for (size_t k = 0; k < one.tried.size(); ++k) {
    EXPECT_EQ(one.tried[k].E, three.tried[k].E) << one.tried[k].name;
  }
}

TEST(ChooseNodes, StopsWithWhatItHas) {
  const NodeChoice choice = Choose(Velvet(0), Nested(), {.stop = [] { return true; }});
  EXPECT_EQ(choice.tried.size(), 1U);
  EXPECT_EQ(choice.chosen, 0);
  const ModelSpec coarse = Nested()[0].spec;
  const NodeChoice later =
      Choose(OfModel(Nested()[2].spec), Nested(),
             {.prior = 0, .on_iteration = [&](const IterationRecord&, const FactorModel& model) {
                return model.spec() == coarse;
              }});
  EXPECT_EQ(later.tried.size(), 2U);
  EXPECT_EQ(later.chosen, 0);
  EXPECT_EQ(later.model.spec(), coarse);
  const Objective all(OfModel(Nested()[2].spec), coarse, Weightings().front());
  EXPECT_LT(all.Value(later.model), 0.5 * all.MeasuredEnergy());
}

TEST(ChooseNodes, AsksForALadderAndEnoughSamples) {
  EXPECT_THAT(ErrorOf([&] {
                ChooseNodes(Objective(Velvet(0), Nested()[0].spec, Weightings().front()), {}, {});
              }),
              IsError(ErrorKind::kMissing, {.key = "nodes"}));
  EXPECT_THAT(ErrorOf([&] { Choose(Selected(Velvet(0), {100}), Nested(), {}); }),
              IsError(ErrorKind::kData, {.key = "directions", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
