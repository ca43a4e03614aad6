#include "trilobe/model/objective/weighting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const std::vector<double> kValues = {0,     5e-324, 2.2e-308, 1e-200, 1e-100, 1e-20,
                                     1e-12, 1e-9,   1e-8,     1e-6,   1e-3,   0.1,
                                     1,     3.14,   1e3,      1e6,    1e12,   1e50};
const std::vector<double> kCosines = {1, 0.999, 0.5, 0.1, 0.01, 1e-6, 1e-17};

constexpr double kCosO = 0.7;
constexpr long double kSolidAngle = 3;

// Weight as a function of rho in its channel, rho in all three, and cos theta_i.
using Exact = long double;
using Formula = Exact (*)(Exact rho, const std::array<Exact, 3>& all, Exact cos_i);

// The table of docs/objective.md, as it stands there.
const std::map<std::string, Formula> kFormulas = {
    {"appearance",  // level 1, since no measurement is known
     [](Exact, const std::array<Exact, 3>& all, Exact cos_i) {
       const Exact c = cos_i * kCosO;
       const Exact root = std::sqrt(c * (all[0] + all[1] + all[2]) / 3 + 0.05L);
       return std::pow(kSolidAngle, 0.75L) * c * c / (root * root * root);
     }},
    {"appearance_channel",
     [](Exact rho, const std::array<Exact, 3>& all, Exact cos_i) {
       const Exact c = cos_i * kCosO;
       const Exact mixed = 0.9L * rho + 0.1L * (all[0] + all[1] + all[2]) / 3;
       const Exact root = std::sqrt(c * mixed + 0.05L);
       return std::pow(kSolidAngle, 0.75L) * c * c / (root * root * root);
     }},
    {"log_relative",
     [](Exact, const std::array<Exact, 3>& all, Exact cos_i) {
       const Exact b = (all[0] * cos_i + all[1] * cos_i + all[2] * cos_i) / 3;
       const Exact slope = cos_i / (b + 1e-3L);
       return slope * slope;
     }},
    {"log_relative_channel",
     [](Exact rho, const std::array<Exact, 3>&, Exact cos_i) {
       const Exact slope = cos_i / (rho * cos_i + 1e-3L);
       return slope * slope;
     }},
    {"cube_root",
     [](Exact rho, const std::array<Exact, 3>&, Exact cos_i) {
       const Exact root = std::cbrt(rho * cos_i + 1e-3L);
       return cos_i * cos_i / (root * root * root * root);
     }},
    {"compressive",
     [](Exact rho, const std::array<Exact, 3>&, Exact cos_i) {
       const Exact slope = rho == 0 ? cos_i : std::log1p(rho * cos_i) / rho;
       return slope * slope;
     }},
    {"log",
     [](Exact rho, const std::array<Exact, 3>&, Exact cos_i) {
       const Exact slope = cos_i / (1 + rho * cos_i);
       return slope * slope;
     }},
    {"percentage", [](Exact rho, const std::array<Exact, 3>&,
                      Exact) { return 1 / ((rho + 1e-3L) * (rho + 1e-3L)); }},
    {"cosine", [](Exact, const std::array<Exact, 3>&, Exact cos_i) { return cos_i * cos_i; }},
    {"uniform", [](Exact, const std::array<Exact, 3>&, Exact) { return 1.0L; }},
};

// A grey sample.
double Weight(const Weighting& weighting, double rho, double cos_i) {
  const Rgb weights = weighting({.rho = {rho, rho, rho}, .cosines = {cos_i, kCosO}});
  EXPECT_EQ(weights[0], weights[1]);
  EXPECT_EQ(weights[0], weights[2]);
  return weights[0];
}

std::optional<Error> ErrorFrom(const std::string& name) {
  return ErrorOf([&] { FindWeighting(name); });
}

// Calls visit(weighting, rho, cos_i, weights) for each weighting, at samples of all kinds.
template <typename Visit>
void ForEachWeight(const Visit& visit) {
  const size_t n = kValues.size();
  for (const Weighting& weighting : Weightings()) {
    for (size_t k = 0; k < n * n; ++k) {
      const Rgb rho = {kValues[k % n], kValues[k / n], kValues[(k % n * 5 + k / n) % n]};
      for (const double cos_i : kCosines) {
        visit(weighting, rho, cos_i,
              weighting({.rho = rho,
                         .cosines = {cos_i, kCosO},
                         .solid_angle = static_cast<double>(kSolidAngle)}));
      }
    }
  }
}

TEST(Weighting, AgreesWithItsFormula) {
  for (const auto& [name, formula] : kFormulas) EXPECT_EQ(FindWeighting(name).name, name);
  ForEachWeight([](const Weighting& weighting, const Rgb& rho, double cos_i, const Rgb& weights) {
    const auto of_name = kFormulas.find(weighting.name);
    if (of_name == kFormulas.end()) return;
    // Weights of highlights at 1e50/sr near the horizon may leave the range of double below.
    const double least = std::numeric_limits<double>::min();
    // The exponent 2/3 is no double, nor are 1/20 and 9/10.
    const bool rounded = weighting.name == "cube_root" || weighting.name.starts_with("appearance");
    const double tolerance = rounded ? 2e-14 : 2e-15;
    for (int c = 0; c < kChannels; ++c) {
      const auto expected =
          static_cast<double>(of_name->second(rho[c], {rho[0], rho[1], rho[2]}, cos_i));
      ASSERT_NEAR(weights[c], expected, tolerance * expected + least)
          << weighting.name << " at " << rho[c] << ", " << cos_i;
    }
  });
}

TEST(Weighting, IsFiniteAndPositive) {
  ForEachWeight([](const Weighting& weighting, const Rgb& rho, double cos_i, const Rgb& weights) {
    for (int c = 0; c < kChannels; ++c) {
      ASSERT_TRUE(std::isfinite(weights[c]) && weights[c] >= 0);
      if (cos_i >= 1e-6) {
        ASSERT_GT(weights[c], 0) << weighting.name << " at " << rho[c];
      }
    }
  });
}

TEST(Weighting, NeverRisesWithTheMeasuredValue) {
  for (const Weighting& weighting : Weightings()) {
    for (const double cos_i : kCosines) {
      for (double rho = 1e-12; rho < 1e12; rho *= 1.1) {
        ASSERT_LE(Weight(weighting, rho * 1.1, cos_i), Weight(weighting, rho, cos_i) * (1 + 1e-14))
            << weighting.name << " at " << rho;
        // Weights do not rise with rho of one channel either.
        const Rgb less = weighting({.rho = {0.2, rho, 0.1}, .cosines = {cos_i, 1}});
        const Rgb more = weighting({.rho = {0.2, rho * 1.1, 0.1}, .cosines = {cos_i, 1}});
        for (int c = 0; c < kChannels; ++c) {
          ASSERT_LE(more[c], less[c] * (1 + 1e-14)) << weighting.name << " at " << rho;
        }
      }
    }
  }
}

// The limit towards black, docs/objective.md: cos^2, across the switch to the series.
TEST(Weighting, CompressiveTendsToTheCosine) {
  const Weighting weighting = FindWeighting("compressive");
  for (const double cos_i : {1.0, 0.3, 0.01}) {
    EXPECT_DOUBLE_EQ(Weight(weighting, 0, cos_i), cos_i * cos_i);
    EXPECT_DOUBLE_EQ(Weight(weighting, 5e-324, cos_i), cos_i * cos_i);
    EXPECT_NEAR(Weight(weighting, 0.9999e-9 / cos_i, cos_i),
                Weight(weighting, 1.0001e-9 / cos_i, cos_i), 1e-12 * cos_i * cos_i);
  }
}

TEST(Weighting, ScaleFreeOnesIgnoreTheMeasuredValueOrItsUnit) {
  for (const Weighting& weighting : Weightings()) {
    const bool depends = Weight(weighting, 1, 0.5) != Weight(weighting, 2, 0.5);
    EXPECT_EQ(weighting.scale_free, !depends || weighting.needs_level) << weighting.name;
    EXPECT_FALSE(weighting.description.empty());
  }
}

TEST(Weighting, ByName) {
  EXPECT_EQ(Weightings().front().name, "appearance");
  for (const Weighting& weighting : Weightings()) {
    EXPECT_EQ(FindWeighting(weighting.name).description, weighting.description);
  }
  std::string known;
  for (const Weighting& weighting : Weightings()) {
    known += (known.empty() ? "" : ", ") + weighting.name;
  }
  EXPECT_THAT(ErrorFrom("nonesuch"),
              IsError(ErrorKind::kUnknown, {.key = "weighting", .value = "nonesuch"}));
}

// --- power:KEY=VALUE,... ------------------------------------------------------------------------

// The formula of weighting.h, number by number.
struct PowerCase {
  std::string name;
  Exact exponent, epsilon;
  Exact by_channel;
  bool both_cosines;
  Exact solid_angle;
};

TEST(PowerWeighting, AgreesWithItsFormula) {
  const PowerCase cases[] = {
      {"power:", 1, 1e-3L, 0, false, 0},
      {"power:exponent=1.5", 1.5L, 1e-3L, 0, false, 0},
      {"power:exponent=0", 0, 1e-3L, 0, false, 0},
      {"power:exponent=0,epsilon=0", 0, 0, 0, false, 0},
      {"power:epsilon=1,by_channel=1", 1, 1, 1, false, 0},
      {"power:both_cosines=1,relative=0", 1, 1e-3L, 0, true, 0},
      {"power:solid_angle=0.5,both_cosines=1", 1, 1e-3L, 0, true, 0.5L},
      {"power:exponent=0.25,epsilon=0.01,by_channel=1,both_cosines=1,solid_angle=1", 0.25L, 0.01L,
       1, true, 1},
      {"power:exponent=2,epsilon=1e-9,by_channel=1", 2, 1e-9L, 1, false, 0},
      {"power:by_channel=0.25", 1, 1e-3L, 0.25L, false, 0},
  };
  for (const PowerCase& power : cases) {
    const Weighting weighting = FindWeighting(power.name);
    EXPECT_EQ(weighting.name, power.name);
    EXPECT_FALSE(weighting.needs_level);
    EXPECT_FALSE(weighting.scale_free);
    for (const double rho : kValues) {
      for (const double cos_i : {1.0, 0.5, 0.01}) {
        const WeightedPoint point = {
            .rho = {rho, 0.3, 2}, .cosines = {cos_i, kCosO}, .solid_angle = 0.04};
        const Rgb weights = weighting(point);
        for (int c = 0; c < kChannels; ++c) {
          const Exact mean = (static_cast<Exact>(rho) + point.rho[1] + point.rho[2]) / 3;
          const Exact cosine = power.both_cosines ? static_cast<Exact>(cos_i) * 0.7 : cos_i;
          const Exact b =
              (power.by_channel * point.rho[c] + (1 - power.by_channel) * mean) * cosine;
          const Exact slope = cosine * std::pow(b + power.epsilon, -power.exponent);
          const Exact expected =
              slope * slope * std::pow(static_cast<Exact>(point.solid_angle), power.solid_angle);
          ASSERT_NEAR(weights[c], static_cast<double>(expected),
                      4e-15 * static_cast<double>(expected))
              << power.name << " at " << rho << ", " << cos_i;
        }
      }
    }
  }
}

TEST(PowerWeighting, IsTheNamedOneWhereThatIsAPower) {
  for (const auto& [power, name] :
       {std::pair("power:", "log_relative"),
        std::pair("power:by_channel=1", "log_relative_channel"),
        std::pair("power:exponent=1,epsilon=0.001,relative=0,by_channel=0,both_cosines=0,"
                  "solid_angle=0",
                  "log_relative")}) {
    const WeightedPoint point = {.rho = {0.1, 0.5, 3}, .cosines = {0.6, 0.2}, .solid_angle = 9};
    EXPECT_EQ(FindWeighting(power)(point), FindWeighting(name)(point)) << power;
  }
}

TEST(PowerWeighting, RejectsBadInputInOneLine) {
  struct Case {
    const char* name;
    ErrorKind kind;
    const char* key;
  };
  const Case cases[] = {
      {"power:exponent", ErrorKind::kFormat, "exponent"},
      {"power:exponent=", ErrorKind::kFormat, "exponent="},
      {"power:exponent=x", ErrorKind::kFormat, "exponent=x"},
      {"power:exponent=1x", ErrorKind::kFormat, "exponent=1x"},
      {"power:exponent=-1", ErrorKind::kFormat, "exponent=-1"},
      {"power:exponent=nan", ErrorKind::kFormat, "exponent=nan"},
      {"power:exponent=1e99", ErrorKind::kFormat, "exponent=1e99"},
      {"power:exponent=3", ErrorKind::kRange, "exponent"},
      {"power:epsilon=0", ErrorKind::kRange, "epsilon"},
      {"power:epsilon=1e-10,exponent=0.1", ErrorKind::kRange, "epsilon"},
      {"power:relative=2", ErrorKind::kRange, "relative"},
      {"power:by_channel=1.5", ErrorKind::kRange, "by_channel"},
      {"power:both_cosines=9", ErrorKind::kRange, "both_cosines"},
      {"power:colour=1", ErrorKind::kUnknown, "colour"},
      {"power:=1", ErrorKind::kUnknown, ""},
      {"power:exponent=1,,epsilon=1", ErrorKind::kFormat, ""},
  };
  for (const auto& [name, kind, key] : cases) {
    EXPECT_THAT(ErrorFrom(name), IsError(kind, {.key = key, .value = name})) << name;
  }
  EXPECT_THAT(ErrorFrom("power"),
              IsError(ErrorKind::kUnknown, {.key = "weighting", .value = "power"}));
}

// --- The level of a measurement -----------------------------------------------------------------

constexpr MerlGrid kGrid = {.theta_h = 10, .theta_d = 12, .phi_d = 20};

BrdfSamples Scaled(BrdfSamples samples, double scale) {
  for (Rgb& rho : samples.rho) {
    for (double& x : rho) x *= scale;
  }
  return samples;
}

// All pairs of directions: the mean of cos theta_i cos theta_o is 1/4.
TEST(SolidAngle, IsTheMeasureOfThePairsOfDirections) {
  const MerlGrid fine = {.theta_h = 60, .theta_d = 60, .phi_d = 90};
  BrdfTable table = MakeInvalidTable("all", fine);
  for (auto& plane : table.stored) plane.assign(plane.size(), 1);
  const BrdfSamples samples = ValidSamples(table);
  double all = 0, projected = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = ToCosines(samples.Angles(j));
    all += samples.SolidAngle(j);
    projected += samples.SolidAngle(j) * cosines.i * cosines.o;
  }
  EXPECT_NEAR(projected / all, 0.25, 1e-3);
  EXPECT_EQ(Scattered(samples).SolidAngle(0), 1);
}

TEST(MeanReflectance, IsTheLambertianOfTheSameLight) {
  BrdfTable table = RandomTable(kGrid, 1);
  const std::vector<bool> valid = ValidBins(table);
  for (int bin = 0; bin < kGrid.size(); ++bin) {
    for (int c = 0; c < kChannels && valid[bin]; ++c) table.SetValue(c, bin, 0.1 * (c + 1));
  }
  EXPECT_NEAR(MeanReflectance(ValidSamples(table)), 0.2, 1e-14);
  EXPECT_EQ(MeanReflectance(Scaled(ValidSamples(table), 0)), 0);
  // Compares with the definition for a table that is not constant; of many samples, none is left
  // out.
  constexpr MerlGrid kMany = {.theta_h = 50, .theta_d = 50, .phi_d = 80};
  const BrdfSamples samples = ValidSamples(RandomTable(kMany, 2));
  ASSERT_GT(samples.size(), 100000);
  Exact light = 0, reflected = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles a = samples.Angles(j);
    const Cosines cosines = ToCosines(a);
    const Exact through = std::sqrt(static_cast<Exact>(a.theta_h)) * std::sin(a.theta_h) *
                          std::sin(2 * a.theta_d) * cosines.i * cosines.o;
    light += through;
    for (const double rho : samples.rho[j]) reflected += through * rho / 3;
  }
  const auto expected = static_cast<double>(reflected / light);
  EXPECT_NEAR(MeanReflectance(samples), expected, 1e-13 * expected);
  EXPECT_EQ(MeanReflectance(samples, 3), MeanReflectance(samples));
}

TEST(PowerWeighting, EpsilonMayBeAMultipleOfTheLevel) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 3));
  const Weighting weighting = ForSamples(FindWeighting("power:epsilon=0.02,relative=1"), samples);
  EXPECT_TRUE(weighting.needs_level);
  EXPECT_TRUE(weighting.scale_free);
  EXPECT_EQ(weighting.level, MeanReflectance(samples));
  const double slope = 0.5 / (0.4 * 0.5 / weighting.level + 0.02);
  EXPECT_NEAR(Weight(weighting, 0.4, 0.5), slope * slope, 1e-14 * slope * slope);
  // No level, or next to none: as black as it may be, weights are finite.
  for (const double scale : {0.0, 1e-310, 1e-100}) {
    const Weighting black = ForSamples(FindWeighting("power:epsilon=1e-9,relative=1,exponent=2"),
                                       Scaled(samples, scale));
    EXPECT_TRUE(std::isfinite(Weight(black, 0, 1)));
    EXPECT_GT(Weight(black, 0, 1), 0);
  }
  // A weighting that needs no level gets none.
  EXPECT_EQ(ForSamples(FindWeighting("log_relative"), samples).level, 0);
  EXPECT_TRUE(FindWeighting("power:relative=1,exponent=0.5").scale_free);
}

// Equal to the last bit, since a power of two changes exponents only.
TEST(PowerWeighting, ScaleFreeMeansTheSameWeightsInAnyUnit) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 4));
  const FactorModel model = RandomModel(spec, 5);
  for (const char* const name : {"power:relative=1", "power:relative=1,by_channel=1,epsilon=0.1",
                                 "power:relative=1,both_cosines=1,solid_angle=1", "appearance"}) {
    const Weighting weighting = FindWeighting(name);
    ASSERT_TRUE(weighting.scale_free) << name;
    const Objective objective(samples, spec, weighting);
    for (const double scale : {0x1p10, 0x1p-20}) {
      FactorModel scaled = model;
      for (double& d : scaled.d()) d *= scale;
      for (int m = 0; m < spec.lobes; ++m) {
        for (double& s : scaled.s(m)) s *= scale;
      }
      const Objective other(Scaled(samples, scale), spec, weighting);
      EXPECT_EQ(other.weighting().level, scale * objective.weighting().level) << name;
      // E has the unit of a squared BRDF.
      EXPECT_EQ(other.Value(scaled), scale * scale * objective.Value(model)) << name;
      EXPECT_EQ(other.MeasuredEnergy(), scale * scale * objective.MeasuredEnergy()) << name;
    }
  }
}

// Fewer samples of the same measurement are weighted as they were.
TEST(PowerWeighting, ThinnedCopiesKeepTheLevel) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 6));
  const Objective objective(samples, spec, FindWeighting("power:relative=1"));
  EXPECT_EQ(objective.weighting().level, MeanReflectance(samples));
  const BrdfSamples few = Thinned(samples, 4);
  ASSERT_LT(few.size(), samples.size() / 2);
  ASSERT_NE(MeanReflectance(few), MeanReflectance(samples));
  const Objective thinned(few, spec, objective.weighting());
  EXPECT_EQ(thinned.weighting().level, objective.weighting().level);
  EXPECT_EQ(Objective(few, spec, FindWeighting("power:relative=1")).weighting().level,
            MeanReflectance(few));
  int next = 0;
  for (int j = 0; j < samples.size() && next < few.size(); ++j) {
    if (samples.bins[j] != few.bins[next]) continue;
    EXPECT_EQ(thinned.Sample(next++).weight, objective.Sample(j).weight);
  }
  EXPECT_EQ(next, few.size());
}

// The folded sum weights each half of a mirror pair by all three of its own channels.
TEST(PowerWeighting, IsTheSameOnTheFoldedGrid) {
  const BrdfSamples samples = ValidSamples(RandomTable(kGrid, 7));
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    for (const char* const weighting :
         {"log_relative", "power:both_cosines=1,solid_angle=1,relative=1"}) {
      const Objective objective(samples, spec, FindWeighting(weighting));
      ASSERT_EQ(objective.folded() != nullptr, !spec.stretches.any());
      const FactorModel model = RandomModel(spec, 8);
      const auto expected = static_cast<double>(ExactObjective(objective, model));
      EXPECT_NEAR(objective.Value(model), expected, 1e-12 * expected) << name << weighting;
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
