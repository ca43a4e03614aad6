#include "model/measurement/anisotropic_materials.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

Direction At(double theta_deg, double phi_deg) {
  const double theta = DegreesToRadians(theta_deg), phi = DegreesToRadians(phi_deg);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Shot silk: parts of both kinds, and a thread without tangent offsets.
Cloth Silk() {
  return {Thread{.eta = 1.345,
                 .color = {0.02, 0.2, 0.08},
                 .k_d = 0.1,
                 .gamma_s = 4,
                 .gamma_v = 8,
                 .area = 0.86,
                 .tangent_offsets = {-25, -25, 25, 25},
                 .lengths = {1.33, 2.67, 1.33}},
          Thread{.eta = 1.345,
                 .color = {0.6, 0, 0.06},
                 .k_d = 0.1,
                 .gamma_s = 5,
                 .gamma_v = 10,
                 .area = 0.14,
                 .tangent_offsets = {0, 0},
                 .lengths = {1}}};
}

// Values of a program in another language, written from the formulas alone.
TEST(Microcylinder, AgreesWithAnotherProgram) {
  const MicrocylinderBrdf silk(Silk());
  const Thread linen = {.eta = 1.46,
                        .color = {0.06, 0.24, 0.30},
                        .k_d = 0.3,
                        .gamma_s = 12,
                        .gamma_v = 24,
                        .area = 0.33,
                        .tangent_offsets = {-25, 25},
                        .lengths = {1}};
  const MicrocylinderBrdf plain({linen, linen});  // with a gap
  struct Case {
    const MicrocylinderBrdf& brdf;
    DirectionPair pair;
    Rgb rho;
  };
  const Case cases[] = {
      {silk, {At(30, 20), At(45, 200)}, {0.118913574, 0.101989338, 0.0650790287}},
      {silk, {At(60, 100), At(15, 300)}, {0.0303824814, 0.0799912966, 0.0410343703}},
      {silk, {At(75, 330), At(75, 160)}, {0.054873028, 0.0596349999, 0.0478843124}},
      {plain, {At(30, 20), At(45, 200)}, {0.0424804228, 0.0925858064, 0.109287601}},
      {plain, {At(75, 330), At(75, 160)}, {0.0237858367, 0.032153909, 0.0349432665}}};
  for (const Case& c : cases) {
    const Rgb rho = c.brdf.Published(c.pair);
    for (int k = 0; k < kChannels; ++k) EXPECT_NEAR(rho[k], c.rho[k], 1e-8 * c.rho[k]);
  }
}

TEST(Microcylinder, IsTheGeometricMeanOfBothOrders) {
  const MicrocylinderBrdf silk(Silk());
  const DirectionPair pair = {At(70, 10), At(20, 250)};
  const Rgb one = silk.Published(pair), other = silk.Published({pair.wo, pair.wi});
  const Rgb mean = silk(pair), exchanged = silk({pair.wo, pair.wi});
  for (int c = 0; c < kChannels; ++c) {
    EXPECT_NE(one[c], other[c]);  // which it is for
    EXPECT_NEAR(mean[c], std::sqrt(one[c] * other[c]), 1e-14);
    EXPECT_NEAR(exchanged[c], mean[c], 1e-14);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
