#include "trilobe/model/weighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

const std::vector<double> kValues = {0,     5e-324, 2.2e-308, 1e-200, 1e-100, 1e-20,
                                     1e-12, 1e-9,   1e-8,     1e-6,   1e-3,   0.1,
                                     1,     3.14,   1e3,      1e6,    1e12,   1e50};
const std::vector<double> kCosines = {1, 0.999, 0.5, 0.1, 0.01, 1e-6, 1e-17};

// The table of docs/method.md, as it stands there.
const std::map<std::string, long double (*)(long double, long double)> kFormulas = {
    {"compressive",
     [](long double rho, long double cos_i) {
       const long double slope = rho == 0 ? cos_i : std::log1p(rho * cos_i) / rho;
       return slope * slope;
     }},
    {"log",
     [](long double rho, long double cos_i) {
       const long double slope = cos_i / (1 + rho * cos_i);
       return slope * slope;
     }},
    {"percentage",
     [](long double rho, long double) { return 1 / ((rho + 1e-3L) * (rho + 1e-3L)); }},
    {"cosine", [](long double, long double cos_i) { return cos_i * cos_i; }},
    {"uniform", [](long double, long double) { return 1.0L; }},
};

TEST(Weighting, AgreesWithItsFormula) {
  ASSERT_EQ(Weightings().size(), kFormulas.size());
  for (const Weighting& weighting : Weightings()) {
    const auto formula = kFormulas.at(weighting.name);
    for (const double rho : kValues) {
      for (const double cos_i : kCosines) {
        const double weight = weighting.weight(rho, cos_i);
        const long double expected = formula(rho, cos_i);
        // Weights of highlights at 1e50/sr near the horizon may leave the range of double below.
        const double least = std::numeric_limits<double>::min();
        ASSERT_NEAR(weight, static_cast<double>(expected),
                    2e-15 * static_cast<double>(expected) + least)
            << weighting.name << " at " << rho << ", " << cos_i;
        ASSERT_TRUE(std::isfinite(weight) && weight >= 0);
        if (cos_i >= 1e-6) {
          ASSERT_GT(weight, 0) << weighting.name << " at " << rho;
        }
      }
    }
  }
}

TEST(Weighting, NeverRisesWithTheMeasuredValue) {
  for (const Weighting& weighting : Weightings()) {
    for (const double cos_i : kCosines) {
      for (double rho = 1e-12; rho < 1e12; rho *= 1.1) {
        ASSERT_LE(weighting.weight(rho * 1.1, cos_i), weighting.weight(rho, cos_i) * (1 + 1e-14))
            << weighting.name << " at " << rho;
      }
    }
  }
}

// The limit towards black, docs/method.md: cos^2, across the switch to the series.
TEST(Weighting, CompressiveTendsToTheCosine) {
  const auto weight = FindWeighting("compressive").weight;
  for (const double cos_i : {1.0, 0.3, 0.01}) {
    EXPECT_DOUBLE_EQ(weight(0, cos_i), cos_i * cos_i);
    EXPECT_DOUBLE_EQ(weight(5e-324, cos_i), cos_i * cos_i);
    EXPECT_NEAR(weight(0.9999e-9 / cos_i, cos_i), weight(1.0001e-9 / cos_i, cos_i),
                1e-12 * cos_i * cos_i);
  }
}

TEST(Weighting, ScaleFreeOnesIgnoreTheMeasuredValue) {
  for (const Weighting& weighting : Weightings()) {
    const bool depends = weighting.weight(1, 0.5) != weighting.weight(2, 0.5);
    EXPECT_EQ(weighting.scale_free, !depends) << weighting.name;
    EXPECT_FALSE(weighting.description.empty());
  }
}

TEST(Weighting, ByName) {
  EXPECT_EQ(Weightings().front().name, "compressive");
  EXPECT_EQ(&FindWeighting("cosine"), &Weightings()[3]);
  try {
    FindWeighting("nonesuch");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "unknown weighting 'nonesuch'; known: compressive, log, percentage, cosine, "
                 "uniform");
  }
}

}  // namespace
}  // namespace trilobe
