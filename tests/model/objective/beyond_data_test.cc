#include "model/objective/beyond_data.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "core/base/robust_line.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 20, .theta_d = 18, .phi_d = 20};
constexpr int kLast = 13;  // the last theta_h that is observed

// Two lobes. Along a highlight F and G^2 trade: F falls towards grazing as far as G rises.
FactorModel Trading(double rise, const ModelSpec& spec) {
  FactorModel model(spec);
  for (int m = 0; m < spec.lobes; ++m) std::ranges::fill(model.s(m), 1.0 + m);
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    for (int k = 0; k < spec.d_axis.size; ++k) {
      model.table(Factor::kD, t)[k] = std::exp(-0.5 * k) + 1e-2;
    }
  }
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    for (int k = 0; k < spec.f_axis.size; ++k) {
      model.table(Factor::kF, t)[k] = std::pow(rise, -2.0 * k / spec.f_axis.size);
    }
  }
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    for (int k = 0; k < spec.g_axis.size; ++k) {
      model.table(Factor::kG, t)[k] = std::pow(rise, static_cast<double>(k) / spec.g_axis.size) *
                                      std::cos((k + 0.5) / spec.g_axis.size * kPi / 2);
    }
  }
  return model;
}

// All entries are observed but those of D beyond kLast.
std::vector<double> Coverage(const FactorModel& model) {
  std::vector<double> coverage(model.parameters().size(), 1);
  const ModelSpec& spec = model.spec();
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    const int offset = model.TableOffset(Factor::kD, t);
    std::fill_n(coverage.begin() + offset + kLast + 1, spec.d_axis.size - kLast - 1, 0.0);
  }
  return coverage;
}

// Light that the lobes of a table of D reflect, per half vector that reads an entry.
std::vector<double> Reflected(const FactorModel& model, int table) {
  const std::vector<double> everywhere(model.parameters().size(), 1);
  FactorModel flat(model.spec());
  std::ranges::fill(flat.parameters(), 1.0);
  const LobeLight light = ComputeLobeLight(everywhere, model),
                  of_flat = ComputeLobeLight(everywhere, flat);
  const int offset = model.TableOffset(Factor::kD, table);
  std::vector<double> reflected(model.spec().d_axis.size);
  for (size_t k = 0; k < reflected.size(); ++k) {
    reflected[k] = light.through[offset + k] / of_flat.through[offset + k];
  }
  return reflected;
}

double MedianOfLastFive(std::span<const double> values) {
  std::vector<double> five(values.begin() + kLast - 4, values.begin() + kLast + 1);
  std::ranges::sort(five);
  return five[2];
}

TEST(ContinueBeyondData, NoLobeShinesBesideTheHalfVectorsThatWereMeasured) {
  ModelSpec by_channel = ModelSpec::SharedFactors(2, kGrid);
  by_channel.D.per_channel = true;
  ModelSpec stretched = ModelSpec::SharedFactors(2, kGrid);
  stretched.stretches = Stretches({{.along = -1.2, .across = 0.5}, {.along = -2, .across = -1}});
  for (const ModelSpec& spec : {ModelSpec::SharedFactors(2, kGrid), by_channel, stretched}) {
    FactorModel model = Trading(30, spec);
    const std::vector<double> coverage = Coverage(model);
    for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
      // Kept as it is, D would let it reflect twice as much there and more.
      FactorModel kept = model;
      const auto D = kept.table(Factor::kD, t);
      const double last = MedianOfLastFive(D);
      std::fill(D.begin() + kLast + 1, D.end(), last);
      const std::vector<double> reflected = Reflected(kept, t);
      EXPECT_GT(*std::max_element(reflected.begin() + kLast + 1, reflected.end()),
                2 * MedianOfLastFive(reflected));
    }
    const FactorModel before = model;
    ContinueBeyondData(coverage, 1, &model);
    for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
      const std::vector<double> reflected = Reflected(model, t);
      const double most = MedianOfLastFive(reflected);
      double largest = 0;
      for (int k = kLast + 1; k < spec.d_axis.size; ++k) {
        EXPECT_LE(reflected[k], most * (1 + 1e-12)) << "table " << t << ", entry " << k;
        EXPECT_GT(model.table(Factor::kD, t)[k], 0);
        largest = std::max(largest, reflected[k]);
      }
      EXPECT_NEAR(largest, most, 1e-12 * most);  // and no less than that asks for
    }
    for (size_t k = 0; k < coverage.size(); ++k) {
      if (coverage[k] > 0) {
        EXPECT_EQ(model.parameters()[k], before.parameters()[k]);
      }
    }
  }
}

TEST(ContinueBeyondData, WhatReflectsLessStaysAsItIs) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  FactorModel model = Trading(0.8, spec);  // darker towards grazing by itself
  const double expected = MedianOfLastFive(model.table(Factor::kD, 0));
  ContinueBeyondData(Coverage(model), 1, &model);
  for (int k = kLast + 1; k < spec.d_axis.size; ++k) {
    EXPECT_EQ(model.table(Factor::kD, 0)[k], expected) << k;
  }
}

// With equal factors there is nothing to keep down, however half vectors read D.
TEST(ContinueBeyondData, AFlatLobeStaysFlat) {
  ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  spec.stretches = Stretches({{.along = -2, .across = -2}, {.along = 0.5, .across = 0.2}});
  FactorModel model(spec);
  std::ranges::fill(model.parameters(), 1.0);
  const std::vector<double> coverage = Coverage(model);
  ContinueBeyondData(coverage, 1, &model);
  for (int t = 0; t < 2; ++t) {
    for (const double x : model.table(Factor::kD, t)) EXPECT_NEAR(x, 1, 1e-12);
  }
}

TEST(ContinueBeyondData, ASecondTimeChangesNothingAndThreadsDoNotMatter) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  FactorModel model = Trading(30, spec);
  const std::vector<double> coverage = Coverage(model);
  FactorModel threaded = model;
  ContinueBeyondData(coverage, 1, &model);
  ContinueBeyondData(coverage, 3, &threaded);
  EXPECT_TRUE(std::ranges::equal(threaded.parameters(), model.parameters()));
  FactorModel again = model;
  ContinueBeyondData(coverage, 1, &again);
  for (size_t k = 0; k < coverage.size(); ++k) {
    EXPECT_NEAR(again.parameters()[k], model.parameters()[k], 1e-12 * model.parameters()[k]) << k;
  }
}

// A lobe that reflects nothing where it was observed, and one that reflects nothing at all.
TEST(ContinueBeyondData, DarkLobesStayDark) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  FactorModel model = Trading(30, spec);
  std::ranges::fill(model.table(Factor::kD, 0), 0.0);
  std::ranges::fill(model.s(1), 0.0);
  ContinueBeyondData(Coverage(model), 1, &model);
  for (const double x : model.table(Factor::kD, 0)) EXPECT_EQ(x, 0);
  for (const double x : model.parameters()) EXPECT_TRUE(std::isfinite(x) && x >= 0);
}

// F falls and G / cos theta rises exponentially up to the edge of the data, but for the last entry,
// which hardly a sample reads.
TEST(ContinueBeyondData, FAndGGoOnAndLevelOff) {
  const MerlGrid grid{.theta_h = 20, .theta_d = 90, .phi_d = 20};
  const ModelSpec spec = ModelSpec::SharedFactors(1, grid);
  constexpr int kEdge = 60;
  constexpr double kFall = -8, kRise = 5;  // a radian
  FactorModel model(spec);
  std::ranges::fill(model.parameters(), 1.0);
  const auto theta = [&](Factor factor, int k) { return spec.axis(factor).Theta(k); };
  const auto F = model.table(Factor::kF, 0), G = model.table(Factor::kG, 0);
  for (int k = 0; k < 90; ++k) {
    F[k] = std::exp(kFall * theta(Factor::kF, k));
    G[k] = std::exp(kRise * theta(Factor::kG, k)) * std::cos(theta(Factor::kG, k));
  }
  std::vector<double> coverage(model.parameters().size(), 1);
  for (const Factor factor : {Factor::kF, Factor::kG}) {
    const int offset = model.TableOffset(factor, 0);
    model.table(factor, 0)[kEdge - 1] *= 30;
    coverage[offset + kEdge - 1] = 1e-3;
    std::fill_n(coverage.begin() + offset + kEdge, spec.table_size(factor) - kEdge, 0.0);
  }
  ContinueBeyondData(coverage, 1, &model);
  for (int k = kEdge; k < 90; ++k) {
    const auto levelled = [&](double slope, Factor factor) {
      const double from = theta(factor, kEdge - 2);
      return std::exp(LevelledOff({.slope = slope, .at_zero = 0}, from, theta(factor, k)));
    };
    EXPECT_NEAR(F[k], levelled(kFall, Factor::kF), 1e-9 * F[k]) << k;
    EXPECT_NEAR(G[k], levelled(kRise, Factor::kG) * std::cos(theta(Factor::kG, k)), 1e-9 * G[k]);
  }
}

TEST(ContinueBeyondData, RefusesAnotherCoverage) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  const std::vector<double> short_one(3, 1);
  EXPECT_THAT(ErrorOf([&] { ContinueBeyondData(short_one, 1, &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "3"}));
  EXPECT_THAT(ErrorOf([&] { FillFromNeighbors(short_one, &model); }),
              IsError(ErrorKind::kMismatch, {.key = "coverage", .value = "3"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
