#include "experiments/stiff/anisotropic_cases.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "experiments/stiff/material.h"
#include "tests/test_util.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

constexpr int kPhiNodes = 8;
constexpr int kTurn = 3;  // angle between the twins, in nodes

ModelSpec SmallSpec(int lobes) {
  ModelSpec spec = ModelSpec::Anisotropic(lobes);
  spec.d_axis = spec.g_axis = Axis::Polar({0, 15, 30, 45, 60, 75}, kPhiNodes);
  spec.f_axis.size = 6;
  return spec;
}

// Ward's highlight: Gaussian in the slopes of the half vector.
double Ward(const PolarAngles& half, double alpha_x, double alpha_y) {
  const double slope = std::tan(half.theta);
  const double x = slope * std::cos(half.phi) / alpha_x, y = slope * std::sin(half.phi) / alpha_y;
  return std::exp(-x * x - y * y) / (kPi * alpha_x * alpha_y);
}

// Lobes stretched across each other. At theta = 0 all azimuths are one direction, and say the same.
FactorModel Cloth(int lobes) {
  constexpr double kAlphaX[] = {0.2, 0.9}, kAlphaY[] = {0.7, 0.5}, kShadowing[] = {0.5, 1.5};
  Random random(1);
  FactorModel model(SmallSpec(lobes));
  const ModelSpec& spec = model.spec();
  std::ranges::copy(kDiffuse, model.d().begin());
  const auto set = [&](Factor factor, int t, auto&& curve) {
    const std::span<double> table = model.table(factor, t);
    const Axis& axis = spec.axis(factor);
    for (int k = 0; k < axis.size; ++k) {
      const PolarAngles at = {axis.Theta(k), axis.Phi(k)};
      table[k] = at.theta == 0 && k > 0 ? table[0] : curve(at) * random.LogNormal(kJitter);
    }
  };
  for (int m = 0; m < lobes; ++m) {
    std::ranges::copy(kWeight[m], model.s(m).begin());
    set(Factor::kD, m,
        [&](const PolarAngles& at) { return Ward(at, kAlphaX[m], kAlphaY[m]) + 0.01; });
    set(Factor::kG, m, [&](const PolarAngles& at) { return Shadowing(at.theta, kShadowing[m]); });
  }
  for (int c = 0; c < kChannels; ++c) {
    set(Factor::kF, c, [&](const PolarAngles& at) { return Schlick(at.theta, kF0[c]); });
  }
  return model;
}

// --- Measurements -------------------------------------------------------------------------------

using Directions = std::vector<PolarAngles>;
using Pairs = std::vector<SphericalAngles>;

Directions AtNodes() {
  Directions directions;
  const Axis axis = SmallSpec(1).g_axis;
  for (int k = 0; k < axis.size; ++k) directions.push_back({axis.Theta(k), axis.Phi(k)});
  return directions;
}

// Every direction with each, in one order.
Pairs AllPairs(const Directions& directions) {
  Pairs pairs;
  for (size_t i = 0; i < directions.size(); ++i) {
    for (size_t o = i; o < directions.size(); ++o) {
      pairs.push_back(
          {directions[i].theta, directions[i].phi, directions[o].theta, directions[o].phi});
    }
  }
  return pairs;
}

PolarAngles HalfVectorOf(const SphericalAngles& at) { return HalfVector(ToDirections(at)); }

// D is read at its first entry where the half vector is the normal, whatever the azimuths: what is
// turned with the others is not measured there.
Pairs OffTheNormal(Pairs pairs) {
  std::erase_if(pairs, [](const SphericalAngles& at) { return HalfVectorOf(at).theta < 1e-9; });
  return pairs;
}

template <typename Value>  // double(const SphericalAngles&, int channel)
StiffProblem MeasureBy(Value value, const ModelSpec& spec, const Pairs& pairs) {
  StiffProblem problem;
  problem.samples.source = "stiff";
  problem.spec = spec;
  for (const SphericalAngles& at : pairs) {
    problem.samples.angles.push_back(ToHalfDiff(ToDirections(at)));
    problem.samples.directions.push_back(at);
    problem.samples.rho.push_back({value(at, 0), value(at, 1), value(at, 2)});
  }
  return problem;
}

// The values of a model, rounded once.
StiffProblem Measure(const FactorModel& truth, const Pairs& pairs) {
  StiffProblem problem = MeasureBy(
      [&](const SphericalAngles& at, int c) {
        return static_cast<double>(ExactEvaluate(truth, ScatteredStencils(truth.spec(), at), c));
      },
      truth.spec(), pairs);
  problem.truth = truth;
  return problem;
}

// A ridge along the azimuth phi, in slopes exp(-(x / width)^2) across; not of the model's own form.
StiffProblem Ridge(double width, double phi_degrees) {
  const double phi = DegreesToRadians(phi_degrees);
  return MeasureBy(
      [&](const SphericalAngles& at, int c) {
        PolarAngles half = HalfVectorOf(at);
        half.phi -= phi;
        const double theta_d = ToHalfDiff(ToDirections(at)).theta_d;
        return kDiffuse[c] + kWeight[0][c] * Ward(half, 0.5, width) * Schlick(theta_d, kF0[c]) *
                                 Shadowing(at.theta_i, 1) * Shadowing(at.theta_o, 1);
      },
      SmallSpec(1), AllPairs(AtNodes()));
}

// --- The cases ----------------------------------------------------------------------------------

StiffProblem ClothExact() { return Measure(Cloth(2), AllPairs(AtNodes())); }
StiffProblem ClothNoisy() { return Noisy(ClothExact(), 0.02); }
StiffProblem ClothOffTheNormal() {
  return Noisy(Measure(Cloth(2), OffTheNormal(AllPairs(AtNodes()))), 0.02);
}

StiffProblem BetweenNodes() {
  Random random(8);
  Pairs pairs;
  const auto theta = [&] { return DegreesToRadians(random.Uniform(0, 80)); };
  const auto phi = [&] { return random.Uniform(0, 2 * kPi); };
  for (int j = 0; j < 300; ++j) {
    const double theta_i = theta(), phi_i = phi(), theta_o = theta(), phi_o = phi();
    pairs.push_back({theta_i, phi_i, theta_o, phi_o});
  }
  return Noisy(Measure(Cloth(2), pairs), 0.02);
}

StiffProblem HalfVectorIsTheNormal() {
  Pairs pairs;
  for (const auto [theta, phi] : AtNodes()) {
    if (phi < kPi - 1e-9) pairs.push_back({theta, phi, theta, phi + kPi});
  }
  return Noisy(Measure(Cloth(1), pairs), 0.02);
}

// Both directions there: D is read at that azimuth alone.
StiffProblem OneAzimuth() {
  Directions directions;
  for (int k = 0; k <= 15; ++k) directions.push_back({DegreesToRadians(5.0 * k), 0});
  return Noisy(Measure(Cloth(1), OffTheNormal(AllPairs(directions))), 0.02);
}

StiffProblem LightAtOneAzimuth() {
  Pairs pairs;
  for (const PolarAngles& i : AtNodes()) {
    for (const PolarAngles& o : AtNodes()) {
      if (i.phi == 0) pairs.push_back({i.theta, i.phi, o.theta, o.phi});
    }
  }
  return Noisy(Measure(Cloth(1), pairs), 0.02);
}

}  // namespace

FactorModel Turned(const FactorModel& model, int nodes) {
  FactorModel turned = model;
  for (const Factor factor : kFactors) {
    const Axis& axis = model.spec().axis(factor);
    for (int t = 0; axis.polar() && t < model.spec().num_tables(factor); ++t) {
      for (int k = 0; k < axis.size; ++k) {
        const int a = k / axis.phi_nodes, b = (k + nodes) % axis.phi_nodes;
        turned.table(factor, t)[a * axis.phi_nodes + b] = model.table(factor, t)[k];
      }
    }
  }
  return turned;
}

StiffProblem Turned(StiffProblem problem, int nodes) {
  const double turn = problem.spec.d_axis.Phi(nodes);
  for (int j = 0; j < problem.samples.size(); ++j) {
    SphericalAngles& at = problem.samples.directions[j];
    at.phi_i = std::fmod(at.phi_i + turn, 2 * kPi);
    at.phi_o = std::fmod(at.phi_o + turn, 2 * kPi);
    problem.samples.angles[j] = ToHalfDiff(ToDirections(at));
  }
  if (problem.truth) problem.truth = Turned(*problem.truth, nodes);
  return problem;
}

std::vector<Twin> Twins() {
  return {{"off_normal_turned", "off_normal", kTurn}, {"one_azimuth_turned", "one_azimuth", kTurn}};
}

std::vector<StiffCase> AnisotropicCases() {
  return {
      {"cloth_exact", "anisotropic, two lobes without error: nothing is hard", ClothExact},
      {"cloth", "anisotropic, two lobes, 2 % noise: nothing is hard", ClothNoisy},
      {"cloth_turned", "the same, turned by three of eight nodes",
       [] { return Turned(ClothNoisy(), kTurn); }},
      {"off_normal", "cloth without half vectors at the normal", ClothOffTheNormal},
      {"off_normal_turned", "the same, turned by three of eight nodes",
       [] { return Turned(ClothOffTheNormal(), kTurn); }},
      {"between_nodes", "cloth in directions between the nodes", BetweenNodes},
      {"ridge_at_node",
       "a ridge 5 degrees wide (half its height) at a node of D, nodes being 45 degrees apart",
       [] { return Ridge(0.05, 90); }},
      {"ridge_between", "a ridge 10 degrees wide halfway between two nodes",
       [] { return Ridge(0.1, 67.5); }},
      {"half_at_normal", "anisotropic, half vectors at the normal only, 2 % noise",
       HalfVectorIsTheNormal},
      {"one_azimuth", "anisotropic, one azimuth of both directions measured, 2 % noise",
       OneAzimuth},
      {"one_azimuth_turned", "the same, turned by three of eight nodes",
       [] { return Turned(OneAzimuth(), kTurn); }},
      {"light_one_azimuth", "anisotropic, one azimuth of the light measured, 2 % noise",
       LightAtOneAzimuth},
  };
}

}  // namespace trilobe
