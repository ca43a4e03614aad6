#include "solvers/sums/spline_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(SplineMoments, AreTheSumsOfTheirTerms) {
  for (const int count : {0, 1, 7, 256}) {
    Random random(count);
    std::vector<double> w1(count), w2(count), t_i(count), t_o(count);
    for (int n = 0; n < count; ++n) {
      w1[n] = random.Normal();
      w2[n] = random.Uniform();
      t_i[n] = random.Uniform(-0.5, 0.5);
      t_o[n] = random.Uniform(-0.5, 0.5);
    }
    SplineMoments moments;
    moments.first[1][2] = 100;  // sums go on from what is there
    AddSplineMoments(count, w1.data(), w2.data(), t_i.data(), t_o.data(), &moments);
    const auto term = [](double v, int k, int degree) {
      return std::pow(0.5 + v, k) * std::pow(0.5 - v, degree - k);
    };
    const auto expected = [&](const std::vector<double>& w, int l, int k, int degree) {
      long double sum = 0;
      for (int n = 0; n < count; ++n) {
        sum += w[n] * term(t_o[n], l, degree) * term(t_i[n], k, degree);
      }
      return static_cast<double>(sum);
    };
    for (int l = 0; l < SplineMoments::kFirst; ++l) {
      for (int k = 0; k < SplineMoments::kFirst; ++k) {
        const double before = l == 1 && k == 2 ? 100 : 0;
        EXPECT_NEAR(moments.first[l][k], before + expected(w1, l, k, 3), 1e-13 * (1 + before));
      }
    }
    for (int l = 0; l < SplineMoments::kSecond; ++l) {
      for (int k = 0; k < SplineMoments::kSecond; ++k) {
        EXPECT_NEAR(moments.second[l][k], expected(w2, l, k, 6), 1e-13);
      }
    }
  }
}

// At the end of an interval only one term is left: the sums of the others stay exactly 0.
TEST(SplineMoments, VanishAtTheEndsExactly) {
  const double w = 1e22, start = -0.5, end = 0.5;
  SplineMoments moments;
  AddSplineMoments(1, &w, &w, &start, &end, &moments);
  for (int l = 0; l < SplineMoments::kSecond; ++l) {
    for (int k = 0; k < SplineMoments::kSecond; ++k) {
      EXPECT_EQ(moments.second[l][k], l == 6 && k == 0 ? w : 0);
    }
  }
  EXPECT_EQ(moments.first[3][0], w);
  EXPECT_EQ(moments.first[2][1], 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
