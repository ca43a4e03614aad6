#include "trilobe/solvers/texel_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr int kSamples = 40;

// Materials with highlights of random width, in random directions.
struct Surface {
  std::vector<Cosines> cosines;
  std::vector<std::vector<Rgb>> lobes;

  Surface(int materials, Random* random) {
    std::vector<double> place;
    for (int j = 0; j < kSamples; ++j) {
      cosines.push_back({.i = random->Uniform(0.1, 1), .o = random->Uniform(0.1, 1)});
      place.push_back(random->Uniform(0, 3));
    }
    for (int b = 0; b < materials; ++b) {
      const Rgb colour = {random->Uniform(0.1, 1), random->Uniform(0.1, 1),
                          random->Uniform(0.1, 1)};
      std::vector<Rgb>& of = lobes.emplace_back();
      for (const double at : place) {
        const double f = std::exp(-(1 + b) * at * at);
        of.push_back({3 * colour[0] * f, 3 * colour[1] * f, 3 * colour[2] * f});
      }
    }
  }

  TexelSolver Solver(bool coloured, const char* weighting = "appearance") const {
    return {cosines, lobes, FindWeighting(weighting), coloured};
  }

  std::vector<Rgb> Values(const std::vector<Rgb>& d_and_s) const {
    std::vector<Rgb> rho(kSamples, d_and_s[0]);
    for (size_t b = 0; b < lobes.size(); ++b) {
      for (int j = 0; j < kSamples; ++j) {
        for (int c = 0; c < kChannels; ++c) rho[j][c] += d_and_s[1 + b][c] * lobes[b][j][c];
      }
    }
    return rho;
  }
};

std::vector<Rgb> RandomTexel(int materials, bool coloured, Random* random) {
  std::vector<Rgb> d_and_s(1 + materials);
  for (Rgb& colour : d_and_s) {
    const double s = random->Uniform() < 0.3 ? 0 : random->Uniform();
    for (double& x : colour) x = coloured || &colour == d_and_s.data() ? s * random->Uniform() : s;
  }
  return d_and_s;
}

TEST(TexelSolver, FindsWhatATexelIsMadeOf) {
  Random random(1);
  for (const bool coloured : {false, true}) {
    for (int materials = 0; materials <= 4; ++materials) {
      const Surface surface(materials, &random);
      const TexelSolver solver = surface.Solver(coloured);
      for (int texel = 0; texel < 20; ++texel) {
        const std::vector<Rgb> truth = RandomTexel(materials, coloured, &random);
        std::vector<Rgb> found(truth.size(), Rgb{7, 7, 7});
        const TexelSolver::Fit fit = solver.Solve(surface.Values(truth), found);
        EXPECT_LE(fit.objective, 1e-12 * fit.measured_energy);
        for (size_t k = 0; k < truth.size(); ++k) {
          for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(found[k][c], truth[k][c], 1e-4);
        }
      }
    }
  }
}

// E by its formula.
double EnergyOf(const Surface& surface, const TexelSolver& solver, const std::vector<Rgb>& rho,
                const std::vector<Rgb>& d_and_s) {
  std::vector<Rgb> weights(kSamples);
  solver.Weigh(rho, weights);
  const std::vector<Rgb> values = surface.Values(d_and_s);
  double sum = 0;
  for (int j = 0; j < kSamples; ++j) {
    for (int c = 0; c < kChannels; ++c) {
      sum += weights[j][c] * (values[j][c] - rho[j][c]) * (values[j][c] - rho[j][c]);
    }
  }
  return sum;
}

// The conditions of Karush, Kuhn and Tucker: where an unknown is above 0, E does not change with
// it, and where it is 0, E does not fall.
TEST(TexelSolver, FindsTheLeastError) {
  Random random(2);
  const Surface surface(3, &random);
  int at_bound = 0;
  for (int texel = 0; texel < 60; ++texel) {
    const bool coloured = texel % 2 == 0;
    const TexelSolver solver = surface.Solver(coloured);
    std::vector<Rgb> rho = surface.Values(RandomTexel(3, coloured, &random)), found(4);
    for (Rgb& value : rho) {
      for (double& x : value) x *= random.LogNormal(0.5);
    }
    const TexelSolver::Fit fit = solver.Solve(rho, found);
    const double unit = 1e-6 * fit.measured_energy;
    EXPECT_NEAR(EnergyOf(surface, solver, rho, found), fit.objective, 1e-6 * unit);
    for (int unknown = 0; unknown < 12; ++unknown) {
      const int k = unknown / kChannels, c = unknown % kChannels;
      const auto moved = [&](double by) {
        std::vector<Rgb> at = found;
        for (int of = 0; of < kChannels; ++of)
          at[k][of] += of == c || (k > 0 && !coloured) ? by : 0;
        return EnergyOf(surface, solver, rho, at);
      };
      constexpr double kStep = 1e-6;
      const double slope = (moved(kStep) - moved(-kStep)) / (2 * kStep);
      EXPECT_GE(slope, -unit);
      if (found[k][c] > 0) {
        EXPECT_LE(slope, unit);
      } else {
        ++at_bound;
      }
    }
  }
  EXPECT_GT(at_bound, 10);
}

TEST(TexelSolver, LeavesOutWhatIsNoMeasurement) {
  Random random(3);
  const Surface surface(2, &random);
  const std::vector<Rgb> truth = {{0.1, 0.2, 0.3}, {1, 1, 1}, {0.5, 0.5, 0.5}};
  std::vector<Rgb> rho = surface.Values(truth), found(3), weights(kSamples);
  rho[3][1] = -1;
  rho[4][0] = std::numeric_limits<double>::quiet_NaN();
  rho[5][2] = std::numeric_limits<double>::infinity();
  rho[6][2] = 1e300;
  const TexelSolver solver = surface.Solver(false);
  solver.Solve(rho, found);
  for (size_t k = 0; k < truth.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(found[k][c], truth[k][c], 1e-4);
  }
  solver.Weigh(rho, weights);
  for (int j = 0; j < kSamples; ++j) EXPECT_EQ(weights[j][0] == 0, j >= 3 && j <= 6);

  rho.assign(kSamples, {-1, -1, -1});
  const TexelSolver::Fit none = solver.Solve(rho, found);
  EXPECT_EQ(none.objective, 0);
  EXPECT_EQ(none.measured_energy, 0);
  for (const Rgb& colour : found) EXPECT_EQ(colour, Rgb{});
}

// With weights relative to the texel, twice the light is twice of everything, to the bit.
TEST(TexelSolver, ScalesWithTheTexel) {
  Random random(4);
  const Surface surface(3, &random);
  const TexelSolver solver = surface.Solver(true);
  std::vector<Rgb> rho = surface.Values(RandomTexel(3, true, &random)), one(4), two(4);
  for (Rgb& value : rho) value[1] *= random.LogNormal(0.3);
  solver.Solve(rho, one);
  for (Rgb& value : rho) {
    for (double& x : value) x *= 1024;
  }
  solver.Solve(rho, two);
  for (size_t k = 0; k < one.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) EXPECT_EQ(two[k][c], 1024 * one[k][c]);
  }
}

TEST(TexelSolver, RefusesWhatMakesNoSense) {
  Random random(5);
  const Surface surface(1, &random);
  EXPECT_THAT(ErrorOf([&] { Surface(kMaxTexelMaterials + 1, &random).Solver(false); }),
              IsError(ErrorKind::kRange, {.key = "materials", .value = "7"}));
  Surface wrong = surface;
  wrong.cosines[2].o = 0;
  EXPECT_THAT(ErrorOf([&] { wrong.Solver(false); }),
              IsError(ErrorKind::kRange, {.key = "direction"}));
  wrong = surface;
  wrong.lobes[0].pop_back();
  EXPECT_THAT(ErrorOf([&] { wrong.Solver(false); }),
              IsError(ErrorKind::kMismatch, {.key = "a material", .value = "39"}));
  wrong = surface;
  wrong.lobes[0][7][1] = 1e60;
  EXPECT_THAT(ErrorOf([&] { wrong.Solver(false); }),
              IsError(ErrorKind::kData, {.key = "material", .value = "1e+60"}));
  EXPECT_THAT(ErrorOf([&] { TexelSolver(surface.cosines, surface.lobes, Weighting(), false); }),
              IsError(ErrorKind::kMissing, {.key = "weighting"}));
  const TexelSolver solver = surface.Solver(false);
  std::vector<Rgb> rho(kSamples), found(2), short_of_one(kSamples - 1);
  EXPECT_THAT(ErrorOf([&] { solver.Solve(short_of_one, found); }),
              IsError(ErrorKind::kMismatch, {.key = "a texel", .value = "39"}));
  EXPECT_THAT(ErrorOf([&] { solver.Solve(rho, short_of_one); }),
              IsError(ErrorKind::kMismatch, {.key = "d and s", .value = "39"}));
  EXPECT_THAT(ErrorOf([&] { solver.Weigh(rho, short_of_one); }),
              IsError(ErrorKind::kMismatch, {.key = "an array of weights", .value = "39"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
