#include "model/appearance/color.h"

#include <gtest/gtest.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

void ExpectLab(const Rgb& linear, const Lab& expected) {
  const Lab lab = ToLab(linear);
  for (int k = 0; k < 3; ++k) {
    // The figures have been computed with one or two more digits of the matrix.
    EXPECT_NEAR(lab[k], expected[k], 0.03) << k;
  }
}

// Published figures of sRGB for D65 (Lindbloom's calculator).
TEST(ColorTest, LabOfWhatIsKnown) {
  ExpectLab({1, 1, 1}, {100, 0, 0});
  ExpectLab({0, 0, 0}, {0, 0, 0});
  ExpectLab({1, 0, 0}, {53.2408, 80.0925, 67.2032});
  ExpectLab({0, 1, 0}, {87.7347, -86.1827, 83.1793});
  ExpectLab({0, 0, 1}, {32.2970, 79.1875, -107.8602});
  const double grey = LinearizeSrgb(128.0 / 255);
  ExpectLab({grey, grey, grey}, {53.5850, 0, 0});
  ExpectLab({0.18, 0.18, 0.18}, {49.4961, 0, 0});
  ExpectLab({0.008, 0.008, 0.008}, {7.2264, 0, 0});  // on the straight piece
}

TEST(ColorTest, WhiteAndGreysHaveNoColour) {
  for (const double y : {1e-6, 0.001, 0.0089, 0.3, 1.0}) {
    const Lab lab = ToLab({y, y, y});
    EXPECT_NEAR(lab[1], 0, 1e-12) << y;
    EXPECT_NEAR(lab[2], 0, 1e-12) << y;
  }
}

TEST(ColorTest, DifferenceIsADistance) {
  EXPECT_DOUBLE_EQ(LabDifference({50, 3, 0}, {50, 0, 4}), 5);
  EXPECT_EQ(LabDifference({1, 2, 3}, {1, 2, 3}), 0);
}

TEST(ColorTest, LuminanceIsThatOfBt709) {
  EXPECT_DOUBLE_EQ(Luminance({1, 0, 0}), 0.2126);
  EXPECT_DOUBLE_EQ(Luminance({0, 1, 0}), 0.7152);
  EXPECT_DOUBLE_EQ(Luminance({0, 0, 1}), 0.0722);
}

TEST(ColorTest, SrgbCurve) {
  EXPECT_NEAR(EncodeSrgb(0.18), 0.46135613, 1e-8);
  EXPECT_NEAR(EncodeSrgb(0.5), 0.73535698, 1e-8);
  EXPECT_NEAR(LinearizeSrgb(0.5), 0.21404114, 1e-8);
  EXPECT_EQ(EncodeSrgb(0), 0);
  EXPECT_NEAR(EncodeSrgb(1), 1, 1e-15);
  EXPECT_EQ(EncodeSrgb(-3), 0);
  EXPECT_EQ(EncodeSrgb(7), EncodeSrgb(1));
}

TEST(ColorTest, SrgbCurveIsInvertedEverywhere) {
  for (int k = 0; k <= 1000; ++k) {
    const double code = k / 1000.0;
    // The standard's two pieces meet only about so well.
    EXPECT_NEAR(EncodeSrgb(LinearizeSrgb(code)), code, 1e-7) << code;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
