#include "io/formats/databases/rgl_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "io/formats/spectrum.h"
#include "tests/error_of.h"
#include "tests/io/formats/tensor_bytes.h"
#include "tests/paths.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/hemisphere_grid.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

RglBrdf Parse(const TinyRgl& file) { return RglBrdf::Parse(file.Bytes(), "tiny.bsdf"); }

Direction Spherical(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// wi with these angles, and wo its mirror image about the half vector with these.
DirectionPair Reflect(double theta_i, double phi_i, double theta_m, double phi_m) {
  const Direction wi = Spherical(theta_i, phi_i), m = Spherical(theta_m, phi_m);
  const double dot = wi[0] * m[0] + wi[1] * m[1] + wi[2] * m[2];
  return {wi, {2 * dot * m[0] - wi[0], 2 * dot * m[1] - wi[1], 2 * dot * m[2] - wi[2]}};
}

// The same material by the definition: the blended density is a function, and its integrals are
// sums over a fine lattice that contains the nodes. No running integral is stored anywhere.
class SlowRgl {
 public:
  explicit SlowRgl(const TinyRgl& file) : file_(file) {}

  Rgb Evaluate(double theta_i, double theta_m, double phi_difference, double cos_o) const {
    const double u_i = std::sqrt(2 * theta_i / kPi);
    const double u = std::sqrt(2 * theta_m / kPi);
    double v = phi_difference / (2 * kPi) + 0.5;
    while (v < 0) v += 1;
    while (v >= 1) v -= 1;

    // Weight of slice k: a hat function of theta_i.
    const std::vector<float>& nodes = file_.theta_i;
    std::vector<double> weights(nodes.size(), 0.0);
    for (size_t k = 0; k + 1 < nodes.size(); ++k) {
      if (theta_i < nodes[k] || theta_i > nodes[k + 1]) continue;
      weights[k + 1] = (theta_i - nodes[k]) / (double{nodes[k + 1]} - nodes[k]);
      weights[k] = 1 - weights[k + 1];
    }
    std::vector<double> mass(nodes.size());
    for (size_t k = 0; k < nodes.size(); ++k) {
      mass[k] = Integrate(
          1, [&](double t) { return Integrate(1, [&](double s) { return Vndf(k, s, t); }); });
    }
    const auto density = [&](double s, double t) {
      double sum = 0;
      for (size_t k = 0; k < nodes.size(); ++k) sum += weights[k] * Vndf(k, s, t) / mass[k];
      return sum;
    };
    const double y = Integrate(
        v, [&](double t) { return Integrate(1, [&](double s) { return density(s, t); }); });
    const double x = Integrate(u, [&](double s) { return density(s, v); }) /
                     Integrate(1, [&](double s) { return density(s, v); });

    const double factor = Bilinear(file_.ndf, 0, 2, file_.columns, u, v) /
                          (4 * Bilinear(file_.sigma, 0, 2, file_.columns, u_i, 0.5) * cos_o);
    Rgb rho{};
    for (size_t channel = 0; channel < 3; ++channel) {
      for (size_t k = 0; k < nodes.size(); ++k) {
        rho[channel] +=
            weights[k] * factor *
            Bilinear(file_.rgb, 3 * k + channel, file_.rgb_rows, file_.rgb_columns, x, y);
      }
      rho[channel] = std::max(rho[channel], 0.0);
    }
    return rho;
  }

 private:
  // Midpoint rule; exact for functions that are linear between the nodes.
  template <typename Function>
  static double Integrate(double end, const Function& f) {
    constexpr int kSteps = 240;  // a multiple of the cells of all tables here
    double sum = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double a = static_cast<double>(k) / kSteps;
      const double b = std::min(static_cast<double>(k + 1) / kSteps, end);
      if (a < b) sum += (b - a) * f((a + b) / 2);
    }
    return sum;
  }

  // A sum of products of hat functions.
  static double Bilinear(const std::vector<float>& values, size_t slice, int rows, int columns,
                         double x, double y) {
    double sum = 0;
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        const double hat = std::max(0.0, 1 - std::abs(x * (columns - 1) - c)) *
                           std::max(0.0, 1 - std::abs(y * (rows - 1) - r));
        sum += hat * values[(slice * rows + r) * columns + c];
      }
    }
    return sum;
  }

  double Vndf(size_t slice, double s, double t) const {
    return Bilinear(file_.vndf, slice, file_.rows, file_.columns, s, t);
  }

  const TinyRgl& file_;
};

// `spectra` in the place of `rgb`, each node's from its three numbers: a constant, and what is
// added below 490 and above 590 nm.
std::vector<TensorField> WithSpectra(const TinyRgl& file, const std::vector<float>& wavelengths) {
  std::vector<TensorField> fields = file.Fields();
  const auto rgb = std::ranges::find(fields, "rgb", &TensorField::name);
  const std::vector<uint64_t> shape = rgb->shape;
  fields.erase(rgb);
  const size_t nodes = shape[3] * shape[4];
  std::vector<float> spectra;
  for (size_t slice = 0; slice < shape[0] * shape[1]; ++slice) {
    for (const float wavelength : wavelengths) {
      for (size_t node = 0; node < nodes; ++node) {
        const float* values = &file.rgb[slice * 3 * nodes + node];
        spectra.push_back(values[0] + (wavelength < 490 ? values[nodes] : 0) +
                          (wavelength > 590 ? values[2 * nodes] : 0));
      }
    }
  }
  fields.push_back(
      FloatField("spectra", {shape[0], shape[1], wavelengths.size(), shape[3], shape[4]}, spectra));
  fields.push_back(FloatField("wavelengths", {wavelengths.size()}, wavelengths));
  return fields;
}

TEST(RglBrdf, ReadsSpectraAsTheirColours) {
  TinyRgl file;
  file.FillRandom(5);
  std::vector<float> wavelengths;
  for (int k = 0; k < 40; ++k) wavelengths.push_back(static_cast<float>(390 + 10 * k));
  const RglBrdf spectral =
      RglBrdf::Parse(TensorBytes(WithSpectra(file, wavelengths)), "tiny_spec.bsdf");
  // The same nodes as colours, by the spectra of their three parts.
  const std::vector<double> at(wavelengths.begin(), wavelengths.end());
  const SpectralColor color(at, "test");
  std::array<Rgb, 3> parts{};
  for (int k = 0; k < 3; ++k) {
    std::vector<double> spectrum;
    for (const double x : at) spectrum.push_back(k == 0 || (k == 1 ? x < 490 : x > 590) ? 1 : 0);
    parts[k] = color(spectrum);
  }
  TinyRgl rgb = file;
  const size_t nodes = static_cast<size_t>(file.rgb_rows) * file.rgb_columns;
  for (size_t slice = 0; slice < file.theta_i.size(); ++slice) {
    for (size_t node = 0; node < nodes; ++node) {
      const size_t first = slice * 3 * nodes + node;
      for (int c = 0; c < kChannels; ++c) {
        double value = 0;
        for (int k = 0; k < 3; ++k) value += parts[k][c] * file.rgb[first + k * nodes];
        rgb.rgb[first + c * nodes] = static_cast<float>(value);
      }
    }
  }
  const RglBrdf expected = Parse(rgb);
  for (const double theta_i : {0.1, 0.5, 1.0, 1.4}) {
    const DirectionPair pair = Reflect(theta_i, 0.3, 0.05, 1.1);
    EXPECT_LT(RelativeDistance(spectral.Evaluate(pair), expected.Evaluate(pair)), 1e-6);
  }
}

TEST(RglBrdf, ReadsTheWavelengthsThatBandsNames) {
  TinyRgl file;
  file.FillRandom(5);
  const std::string bytes = TensorBytes(WithSpectra(file, {400, 450, 500, 550, 600, 640, 940}));
  const RglBrdf three = RglBrdf::Parse(bytes, "tiny_spec.bsdf", "450,550,940");
  EXPECT_EQ(three.bands_note(), "940, 550, 450 nm of 7 wavelengths as r, g, b");
  EXPECT_TRUE(three.wavelengths().empty());
  const RglBrdf one = RglBrdf::Parse(bytes, "tiny_spec.bsdf", "550");
  EXPECT_EQ(one.wavelengths(), (std::vector<double>{550}));
  EXPECT_EQ(one.bands(), 7);
  TinyRgl rgb = file;  // 940 nm is the first and third of its parts, 450 nm the first and second
  const size_t nodes = static_cast<size_t>(file.rgb_rows) * file.rgb_columns;
  for (size_t slice = 0; slice < file.theta_i.size(); ++slice) {
    for (size_t node = 0; node < nodes; ++node) {
      const size_t first = slice * 3 * nodes + node;
      const float common = file.rgb[first];
      rgb.rgb[first] = common + file.rgb[first + 2 * nodes];
      rgb.rgb[first + 2 * nodes] = common + file.rgb[first + nodes];
      rgb.rgb[first + nodes] = common;
    }
  }
  const RglBrdf expected = Parse(rgb);
  for (const double theta_i : {0.1, 0.5, 1.0, 1.4}) {
    const DirectionPair pair = Reflect(theta_i, 0.3, 0.05, 1.1);
    const Rgb is = expected.Evaluate(pair);
    EXPECT_EQ(three.Evaluate(pair), is);
    EXPECT_EQ(one.Evaluate(pair), (Rgb{is[1], is[1], is[1]}));
    EXPECT_EQ(one.Spectrum(pair), (std::vector<double>{is[1]}));
  }
}

TEST(RglBrdf, RefusesSpectraWithoutWavelengths) {
  TinyRgl file;
  file.FillRandom(5);
  std::vector<TensorField> fields = WithSpectra(file, {400, 440, 480, 520, 560, 600, 640, 680});
  const TensorField wavelengths = fields.back();
  fields.pop_back();
  EXPECT_THAT(ErrorOf([&] { RglBrdf::Parse(TensorBytes(fields), "x.bsdf"); }),
              IsError(ErrorKind::kMissing, {.key = "wavelengths"}));
  fields.push_back(FloatField("wavelengths", {7}, {400, 440, 480, 520, 560, 600, 650}));
  EXPECT_THAT(ErrorOf([&] { RglBrdf::Parse(TensorBytes(fields), "x.bsdf"); }),
              IsError(ErrorKind::kMismatch, {.key = "spectra"}));
  fields.back() = FloatField("wavelengths", {8}, {400, 440, 480, 520, 560, 600, 640, 630});
  EXPECT_THAT(ErrorOf([&] { RglBrdf::Parse(TensorBytes(fields), "x.bsdf"); }),
              IsError(ErrorKind::kRange, {.key = "wavelengths", .value = "630"}));
}

TEST(RglFile, AgreesWithTheDefinitionOnUnevenTables) {
  TinyRgl file;
  file.FillRandom(7);
  for (float& value : file.rgb) value -= 0.1F;  // some colours dip below 0
  // The azimuth of wi must not matter to an isotropic material, so sigma must not depend on it.
  for (int c = 0; c < file.columns; ++c) file.sigma[file.columns + c] = file.sigma[c];
  const RglBrdf brdf = Parse(file);
  EXPECT_TRUE(brdf.isotropic());
  const SlowRgl slow(file);
  std::mt19937 random(1);
  const auto uniform = [&random](double a, double b) {
    return a + (b - a) * static_cast<double>(random()) / 4294967296.0;
  };
  for (int n = 0; n < 12;) {
    const double theta_i = uniform(0.01, 1.5), phi_i = uniform(-3, 3);
    const double theta_m = uniform(0.01, 1.2), phi_m = uniform(-3, 3);
    const DirectionPair pair = Reflect(theta_i, phi_i, theta_m, phi_m);
    // A half vector turned away from wi stands for another one.
    const double cos_d = (pair.wi[0] + pair.wo[0]) * pair.wi[0] +
                         (pair.wi[1] + pair.wo[1]) * pair.wi[1] +
                         (pair.wi[2] + pair.wo[2]) * pair.wi[2];
    if (pair.wo[2] < 0.05 || cos_d < 0.05 || pair.wi[2] + pair.wo[2] < 0.05) continue;
    const double sign = Spherical(theta_m, phi_m)[0] * (pair.wi[0] + pair.wo[0]) +
                        Spherical(theta_m, phi_m)[1] * (pair.wi[1] + pair.wo[1]) +
                        Spherical(theta_m, phi_m)[2] * (pair.wi[2] + pair.wo[2]);
    if (sign <= 0) continue;
    ++n;
    const Rgb expected = slow.Evaluate(theta_i, theta_m, phi_m - phi_i, pair.wo[2]);
    const Rgb actual = brdf.Evaluate(pair);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], 1e-4 * (1 + expected[c]));
  }
}

TEST(RglFile, ConstantTablesGiveAValueByHand) {
  TinyRgl file;
  file.FillConstant(/*ndf_value=*/2, /*sigma_value=*/0.5, /*rgb_value=*/3);
  const RglBrdf brdf = Parse(file);
  for (const double phi : {0.0, 1.0, 3.1, -2.0}) {
    const DirectionPair pair = Reflect(0.7, phi, 0.3, phi + 0.2);
    for (const double value : brdf.Evaluate(pair)) {
      EXPECT_NEAR(value, 3 * 2 / (4 * 0.5) / pair.wo[2], 1e-12);
    }
  }
}

TEST(RglFile, AConstantDensityWarpsNothing) {
  TinyRgl file;
  file.FillConstant(4, 1, 0);
  // rgb = (x, y, 1) at the nodes, so that its bilinear lookup returns the point itself.
  for (size_t t = 0; t < file.theta_i.size(); ++t) {
    for (int r = 0; r < file.rgb_rows; ++r) {
      for (int c = 0; c < file.rgb_columns; ++c) {
        const auto index = [&](size_t channel) {
          return ((3 * t + channel) * file.rgb_rows + r) * file.rgb_columns + c;
        };
        file.rgb[index(0)] = static_cast<float>(c) / static_cast<float>(file.rgb_columns - 1);
        file.rgb[index(1)] = static_cast<float>(r) / static_cast<float>(file.rgb_rows - 1);
        file.rgb[index(2)] = 1;
      }
    }
  }
  const RglBrdf brdf = Parse(file);
  const double theta_m = 0.4, difference = -0.9;
  const DirectionPair pair = Reflect(0.5, 3.0, theta_m, 3.0 + difference);
  const Rgb rho = brdf.Evaluate(pair);
  EXPECT_NEAR(rho[0] * pair.wo[2], std::sqrt(2 * theta_m / kPi), 1e-6);
  EXPECT_NEAR(rho[1] * pair.wo[2], difference / (2 * kPi) + 0.5, 1e-6);
  EXPECT_NEAR(rho[2] * pair.wo[2], 1, 1e-12);
}

TEST(RglFile, DensityAndAreaMayVanishInPlaces) {
  TinyRgl file;
  file.FillRandom(3);
  // Only the first row of each slice has any density: no conditional on the others.
  for (size_t i = 0; i < file.vndf.size(); ++i) {
    if (i / file.columns % file.rows > 0) file.vndf[i] = 0;
  }
  std::fill_n(file.sigma.begin(), 2, 0.0F);  // and for small theta_i
  file.sigma[file.columns] = file.sigma[file.columns + 1] = 0.0F;
  const RglBrdf brdf = Parse(file);
  bool any_positive = false;
  for (double theta_i = 0; theta_i < 1.57; theta_i += 0.1) {
    for (double phi = -3; phi < 3; phi += 0.5) {
      const DirectionPair pair = Reflect(theta_i, 0, 0.3, phi);
      for (const double value : brdf.Evaluate(pair)) {
        EXPECT_TRUE(std::isfinite(value) && value >= 0) << value;
        any_positive |= value > 0;
      }
    }
  }
  EXPECT_TRUE(any_positive);
  EXPECT_EQ(brdf.Evaluate(Reflect(0.05, 0, 0.01, 0)), (Rgb{0, 0, 0}));
}

TEST(RglFile, IsFiniteForExtremeTablesAndDirections) {
  TinyRgl file;
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  file.FillConstant(kMax, kTiny, kMax);
  std::ranges::fill(file.vndf, kMax);
  file.vndf[0] = kTiny;
  const RglBrdf brdf = Parse(file);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Direction> directions = {{0, 0, 1},        {1, 0, 1e-300}, {1, 0, 5e-324},
                                             {0, 0, 5e-324},   {nan, 0, 1},    {infinity, 0, 1},
                                             {0, 1, infinity}, {0.6, 0, 0.8}};
  for (const Direction& wi : directions) {
    for (const Direction& wo : directions) {
      for (const double value : brdf.Evaluate({wi, wo})) {
        EXPECT_TRUE(std::isfinite(value) && value >= 0) << value;
      }
    }
  }
}

TEST(RglFile, IsBlackBelowTheSurface) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  const RglBrdf brdf = Parse(file);
  const Direction up = Spherical(0.3, 0), down = Spherical(2.0, 0), level = {1, 0, 0};
  EXPECT_EQ(brdf.Evaluate({up, down}), (Rgb{0, 0, 0}));
  EXPECT_EQ(brdf.Evaluate({down, up}), (Rgb{0, 0, 0}));
  EXPECT_EQ(brdf.Evaluate({up, level}), (Rgb{0, 0, 0}));
  EXPECT_GT(brdf.Evaluate({up, up})[0], 0);
}

TEST(RglFile, InterpolatesOverPhiWhenAnisotropic) {
  TinyRgl file;
  file.phi_i = {-3.1415927F, 0, 3.1415927F};
  file.FillConstant(4, 1, 1);
  const size_t slice = file.rgb.size() / 3;
  std::fill_n(file.rgb.begin() + slice, slice, 5.0F);  // phi_i = 0
  const RglBrdf brdf = Parse(file);
  EXPECT_FALSE(brdf.isotropic());
  for (const double phi : {kPi / 2, -kPi / 2}) {
    const DirectionPair pair = Reflect(0.5, phi, 0.2, 1.0);
    EXPECT_NEAR(brdf.Evaluate(pair)[0] * pair.wo[2], 3, 1e-6);
  }
  EXPECT_THAT(ErrorOf([&] { TabulateRgl(brdf, "tiny.bsdf"); }),
              IsError(ErrorKind::kUnsupported, {.file = "tiny.bsdf", .key = "phi_i"}));
}

// A reciprocal BRDF that changes when it is turned and mirrored.
Rgb Grained(const DirectionPair& pair) {
  const auto& [wi, wo] = pair;
  const Direction h = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const double x = h[0] / h[2], y = h[1] / h[2];
  return {0.1 + std::exp(-4 * x * x - 20 * y * y - 6 * x * y), 0.3 + 0.1 * std::sin(3 * x + y),
          0.5 + 0.2 * wi[1] * wo[1] + 0.1 * (wi[0] + wo[0])};
}

// A file of a known BRDF: `rgb` is what the format defines where its nodes are, which are found by
// bisection of running integrals on a fine lattice (exact between the nodes of the density).
TinyRgl FileOf(const std::function<Rgb(const DirectionPair&)>& brdf, double phi_begin,
               double phi_end) {
  TinyRgl file;
  file.phi_i.clear();
  for (int k = 0; k < 5; ++k) {
    file.phi_i.push_back(static_cast<float>(phi_begin + (phi_end - phi_begin) * k / 4));
  }
  file.theta_i = {0, 0.5F, 1.1F, 1.5707964F};
  file.rgb_rows = 7;
  file.rgb_columns = 5;
  file.FillRandom(11);
  for (float& value : file.ndf) value += 0.5F;
  for (float& value : file.sigma) value += 0.5F;
  for (float& value : file.vndf) value += 0.1F;
  // A circle ends where it begins, and the normal has one azimuth.
  for (std::vector<float>* table : {&file.ndf, &file.sigma}) {
    std::copy_n(table->begin(), file.columns, table->begin() + file.columns);
  }
  for (size_t slice = 0; slice < file.phi_i.size() * file.theta_i.size(); ++slice) {
    const auto first = file.vndf.begin() + slice * file.rows * file.columns;
    std::copy_n(first, file.columns, first + (file.rows - 1) * file.columns);
  }
  constexpr int kFine = 240;  // a multiple of the cells of the density
  const auto bilinear = [](const float* values, int rows, int columns, double x, double y) {
    const int r = std::min(static_cast<int>(y * (rows - 1)), rows - 2);
    const int c = std::min(static_cast<int>(x * (columns - 1)), columns - 2);
    const double v = y * (rows - 1) - r, u = x * (columns - 1) - c;
    const float* p = values + r * columns + c;
    return (1 - v) * ((1 - u) * p[0] + u * p[1]) + v * ((1 - u) * p[columns] + u * p[columns + 1]);
  };
  // Solves int_0^x f / int_0^1 f = `part` for x, f being linear in cells of 1 / kFine.
  const auto find = [](const std::function<double(double)>& f, double part) {
    const auto integral = [&](double end) {
      double sum = 0;
      for (int k = 0; k < kFine && k < end * kFine; ++k) {
        const double a = static_cast<double>(k) / kFine;
        const double b = std::min(static_cast<double>(k + 1) / kFine, end);
        sum += (b - a) * f((a + b) / 2);
      }
      return sum;
    };
    const double total = integral(1);
    double begin = 0, end = 1;
    for (int k = 0; k < 45; ++k) {
      const double middle = (begin + end) / 2;
      (integral(middle) < part * total ? begin : end) = middle;
    }
    return (begin + end) / 2;
  };
  const size_t thetas = file.theta_i.size();
  for (size_t slice = 0; slice < file.phi_i.size() * thetas; ++slice) {
    const float* density = &file.vndf[slice * file.rows * file.columns];
    const double theta_i = std::min<double>(file.theta_i[slice % thetas], kPi / 2);
    const double phi_i = file.phi_i[slice / thetas];
    const auto row_total = [&](double y) {  // integral of a bilinear row, by the trapezoidal rule
      double sum = 0;
      for (int c = 0; c < file.columns; ++c) {
        const double weight = c == 0 || c == file.columns - 1 ? 0.5 : 1;
        sum += weight * bilinear(density, file.rows, file.columns,
                                 static_cast<double>(c) / (file.columns - 1), y);
      }
      return sum;
    };
    for (int r = 0; r < file.rgb_rows; ++r) {
      const double v = find(row_total, static_cast<double>(r) / (file.rgb_rows - 1));
      for (int c = 0; c < file.rgb_columns; ++c) {
        const double u =
            find([&](double x) { return bilinear(density, file.rows, file.columns, x, v); },
                 static_cast<double>(c) / (file.rgb_columns - 1));
        const DirectionPair pair = Reflect(theta_i, phi_i, u * u * kPi / 2, (v - 0.5) * 2 * kPi);
        const bool above = pair.wi[2] > 0 && pair.wo[2] > 0;
        const Rgb rho = above ? brdf(pair) : Rgb{};
        const double sigma =
            bilinear(file.sigma.data(), 2, file.columns, std::sqrt(2 * theta_i / kPi),
                     std::fmod(phi_i / (2 * kPi) + 1.5, 1.0));
        const double factor =
            4 * sigma * pair.wo[2] / bilinear(file.ndf.data(), 2, file.columns, u, v);
        for (size_t channel = 0; channel < 3; ++channel) {
          file.rgb[((3 * slice + channel) * file.rgb_rows + r) * file.rgb_columns + c] =
              static_cast<float>(rho[channel] * factor);
        }
      }
    }
  }
  return file;
}

TEST(RglFile, SamplesAnAnisotropicMaterialAtItsNodes) {
  const TinyRgl file = FileOf(Grained, -kPi, kPi);
  const RglBrdf brdf = Parse(file);
  const Measurement measurement = brdf.Sample("tiny.bsdf", false);
  EXPECT_TRUE(measurement.anisotropic);
  EXPECT_EQ(measurement.source, "tiny.bsdf");
  // Each of 4 phi_i and 4 theta_i: theta_m = 0 once, 6 azimuths x 4 other theta_m.
  EXPECT_EQ(measurement.counts.total, 4 * 4 * 25);
  EXPECT_EQ(measurement.counts.valid + measurement.counts.below_surface, 4 * 4 * 25);
  EXPECT_GT(measurement.counts.valid, 100);
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const DirectionPair pair = ToDirections(measurement.samples.directions[j]);
    const Rgb expected = Grained(pair), looked_up = brdf.Evaluate(pair);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(measurement.samples.rho[j][c], expected[c], 1e-5 * (1 + expected[c])) << j;
      // At theta_i = 0 a direction does not tell which phi_i it came from.
      if (pair.wi[2] < 1) {
        EXPECT_NEAR(looked_up[c], expected[c], 1e-3 * (1 + expected[c])) << j;
      }
    }
  }
  const Measurement loaded = Source("tiny.bsdf", file.Bytes()).Read();
  EXPECT_EQ(loaded.samples.rho, measurement.samples.rho);
  EXPECT_FALSE(loaded.table);
  EXPECT_TRUE(loaded.look_up);
  EXPECT_GT(AtNodes(loaded, HemisphereGrid(), 1).counts.valid, 60000);
}

// theta_i is float32, and may come a rounding below 0, where no direction is.
TEST(RglFile, AThetaJustBelow0Is0) {
  TinyRgl file = FileOf(Grained, -kPi, kPi);
  const Measurement expected = Parse(file).Sample("tiny.bsdf", false);
  ASSERT_EQ(file.theta_i.front(), 0);
  file.theta_i.front() = -1e-5F;
  const Measurement measurement = Parse(file).Sample("tiny.bsdf", false);
  CheckSamples(measurement.samples);
  EXPECT_EQ(measurement.samples.rho, expected.samples.rho);
}

// Directions that a symmetry repeats are not in the file, but in the samples and the function.
TEST(RglFile, UndoesTheSymmetriesThatFilesLeaveOut) {
  const auto turned_alike = [](const DirectionPair& pair) {
    const Rgb a = Grained(pair);
    const Rgb b =
        Grained({{-pair.wi[0], -pair.wi[1], pair.wi[2]}, {-pair.wo[0], -pair.wo[1], pair.wo[2]}});
    return Rgb{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  };
  const auto mirrored_alike = [&](const DirectionPair& pair) {
    const Rgb a = turned_alike(pair);
    const Rgb b = turned_alike(
        {{-pair.wi[0], pair.wi[1], pair.wi[2]}, {-pair.wo[0], pair.wo[1], pair.wo[2]}});
    return Rgb{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  };
  const auto check = [](const TinyRgl& file, const auto& expected_brdf, int per_theta) {
    const RglBrdf brdf = Parse(file);
    const Measurement measurement = brdf.Sample("tiny.bsdf", false);
    EXPECT_EQ(measurement.counts.total, 4 * per_theta * 25);
    std::array<int, 4> quadrants{};
    for (int j = 0; j < measurement.samples.size(); ++j) {
      const DirectionPair pair = ToDirections(measurement.samples.directions[j]);
      ++quadrants[(pair.wi[0] > 0) + 2 * (pair.wi[1] > 0)];
      const Rgb expected = expected_brdf(pair), looked_up = brdf.Evaluate(pair);
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_NEAR(measurement.samples.rho[j][c], expected[c], 1e-5 * (1 + expected[c])) << j;
        // Between the parts of the circle that repeat, phi_i may be the node on either side.
        if (std::min(std::abs(pair.wi[0]), std::abs(pair.wi[1])) > 1e-6) {
          EXPECT_NEAR(looked_up[c], expected[c], 1e-3 * (1 + expected[c])) << j;
        }
      }
    }
    EXPECT_THAT(quadrants, testing::Each(testing::Gt(50)));
  };
  check(FileOf(turned_alike, -kPi, 0), turned_alike, 2 * 4);
  check(FileOf(mirrored_alike, -kPi, -kPi / 2), mirrored_alike, 4 * 3 + 2 * 2);
}

TEST(RglFile, LeavesOutNodesThatWereNotMeasured) {
  TinyRgl file = FileOf(Grained, -kPi, kPi);
  file.MaskAll();
  for (int slice = 0; slice < 5 * 4; ++slice) file.SetMask(slice, 2, 1, false);
  const Measurement all = Parse(file).Sample("x", true), part = Parse(file).Sample("x", false);
  EXPECT_EQ(all.counts.extrapolated + all.counts.beyond_nodes, 0);
  EXPECT_GT(part.counts.extrapolated, 0);
  EXPECT_LE(part.counts.extrapolated, 4 * 4);
  // The last theta_i but one, 1.1, is the last with data; samples with a theta_o above it are
  // beyond, too.
  EXPECT_GT(part.counts.beyond_nodes, 0);
  EXPECT_NEAR(part.max_theta, 1.1, 1e-6);
  EXPECT_EQ(part.counts.valid + part.counts.extrapolated + part.counts.beyond_nodes,
            all.counts.valid);
  EXPECT_EQ(part.counts.below_surface, all.counts.below_surface);
  const std::string bytes = file.Bytes();
  EXPECT_EQ(Source("x", bytes).Read({.extrapolated = true}).counts.valid, all.counts.valid);
}

TEST(TabulateRgl, EvaluatesBinCentresOnAnyNumberOfThreads) {
  TinyRgl file;
  file.FillRandom(5);
  const RglBrdf brdf = Parse(file);
  const MerlGrid grid{.theta_h = 12, .theta_d = 11, .phi_d = 10};
  const BrdfTable table = TabulateRgl(brdf, "tiny", grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    const Rgb rho = brdf.Evaluate(ToDirections(grid.Center(bin)));
    for (int c = 0; c < kChannels; ++c) {
      if (above[bin]) {
        EXPECT_DOUBLE_EQ(table.Value(c, bin), rho[c]);
      } else {
        EXPECT_EQ(table.stored[c][bin], -1);
      }
    }
  }
  EXPECT_EQ(TabulateRgl(brdf, "tiny", grid, 3).stored, table.stored);
}

std::optional<Error> ParseError(const std::string& bytes) {
  return ErrorOf([&] { RglBrdf::Parse(bytes, "tiny.bsdf"); });
}

std::optional<Error> FieldsError(const std::vector<TensorField>& fields) {
  return ParseError(TensorBytes(fields));
}

TEST(RglFile, RecognisesTheMagic) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  const auto is_rgl = [](std::string_view bytes) {
    const MeasurementFormat* const format = RecogniseFormat(bytes);
    return format != nullptr && format->name == "rgl";
  };
  EXPECT_TRUE(is_rgl(file.Bytes()));
  EXPECT_FALSE(is_rgl("tensor_file"));  // without the final 0
  EXPECT_FALSE(is_rgl(""));
  EXPECT_THAT(ParseError(""),
              IsError(ErrorKind::kFormat, {.file = "tiny.bsdf", .key = "tensor_file"}));
}

TEST(RglFile, RefusesEveryTruncation) {
  TinyRgl file;
  file.FillRandom(1);
  const std::string bytes = file.Bytes();
  for (size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THAT(ParseError(bytes.substr(0, length)),
                IsError(ErrorKind::kFormat, {.file = "tiny.bsdf"}))
        << length;
  }
}

TEST(RglFile, RefusesAWrongHeader) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  std::string bytes = file.Bytes();
  bytes[12] = 2;
  EXPECT_THAT(ParseError(bytes),
              IsError(ErrorKind::kUnsupported, {.key = "version", .value = "2.0"}));
  bytes = file.Bytes();
  bytes.replace(14, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(ParseError(bytes), IsError(ErrorKind::kUnknown,
                                         {.file = "tiny.bsdf", .value = "0"}));  // 4 billion fields
}

TEST(RglFile, RefusesFieldsThatReachPastTheFile) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  const std::vector<std::vector<uint64_t>> shapes = {
      {uint64_t{1} << 63, 2},                  // the product wraps to 0
      {uint64_t{1} << 32, uint64_t{1} << 32},  // so does this one
      {(uint64_t{1} << 62) + 1, 4},            // to a small number
      {~uint64_t{0}, ~uint64_t{0}},
      {2, 1000000},
      {2, 0}};
  for (const auto& shape : shapes) {
    std::vector<TensorField> fields = file.Fields();
    fields[2].shape = shape;
    EXPECT_THAT(FieldsError(fields),
                IsError(ErrorKind::kFormat, {.file = "tiny.bsdf", .key = "ndf"}));
  }
  for (const int64_t offset : {int64_t{1000000}, std::numeric_limits<int64_t>::max(),
                               static_cast<int64_t>(file.Bytes().size()) - 1}) {
    std::vector<TensorField> fields = file.Fields();
    fields[4].offset = offset;
    EXPECT_THAT(FieldsError(fields),
                IsError(ErrorKind::kFormat, {.key = "vndf", .value = "beyond the file"}));
  }
  std::vector<TensorField> fields = file.Fields();
  fields[3].shape.assign(255, 1);
  EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kMismatch, {.key = "sigma", .value = "255"}));
  fields[3].shape.assign(255, 2);
  EXPECT_THAT(FieldsError(fields),
              IsError(ErrorKind::kFormat, {.key = "sigma", .value = "beyond the file"}));
}

TEST(RglFile, RefusesFieldsThatShareANameOrBytes) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  std::vector<TensorField> fields = file.Fields();
  fields.push_back(fields[2]);
  EXPECT_THAT(FieldsError(fields),
              IsError(ErrorKind::kConflict, {.file = "tiny.bsdf", .key = "ndf"}));
  // sigma where ndf is, and in the header.
  fields = file.Fields();
  const size_t ndf = file.Bytes().find(fields[2].data);
  fields[3].offset = static_cast<int64_t>(ndf) + 4;
  EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kConflict, {.key = "sigma", .value = "292"}));
  fields = file.Fields();
  fields[3].offset = 14;
  EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kConflict, {.key = "sigma", .value = "14"}));
}

TEST(RglFile, RefusesUnknownTypesAndMissingFields) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  for (const uint8_t dtype : std::array<uint8_t, 3>{0, 12, 255}) {
    std::vector<TensorField> fields = file.Fields();
    fields[5].dtype = dtype;
    EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kUnknown, {.key = "rgb"}));
  }
  std::vector<TensorField> fields = file.Fields();
  fields[5].dtype = 9;  // float16: known, but not what rgb must be
  EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kFormat, {.key = "rgb", .value = "9"}));
  for (size_t k = 0; k < file.Fields().size(); ++k) {
    fields = file.Fields();
    const std::string name = fields[k].name;
    fields[k].name = "other\n";
    EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kMissing, {.key = name}));
  }
}

TEST(RglFile, RefusesWrongShapes) {
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  const auto with_shape = [&](size_t field, const std::vector<uint64_t>& shape) {
    std::vector<TensorField> fields = file.Fields();
    fields[field].shape = shape;
    return FieldsError(fields);
  };
  EXPECT_THAT(with_shape(0, {1, 1}), IsError(ErrorKind::kMismatch, {.key = "phi_i", .value = "2"}));
  EXPECT_THAT(with_shape(2, {1, 10}), IsError(ErrorKind::kRange, {.key = "ndf"}));
  EXPECT_THAT(with_shape(3, {10, 1}), IsError(ErrorKind::kRange, {.key = "sigma"}));
  EXPECT_THAT(with_shape(4, {1, 2, 6, 5}), IsError(ErrorKind::kMismatch, {.key = "vndf"}));
  EXPECT_THAT(with_shape(5, {1, 3, 2, 3, 4}), IsError(ErrorKind::kMismatch, {.key = "rgb"}));
  EXPECT_THAT(with_shape(5, {1, 3, 36}),
              IsError(ErrorKind::kMismatch, {.key = "rgb", .value = "3"}));
}

TEST(RglFile, RefusesImpossibleNumbers) {
  const auto error_of = [](auto spoil) {
    TinyRgl file;
    file.FillConstant(1, 1, 1);
    spoil(&file);
    return ParseError(file.Bytes());
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error_of([](TinyRgl* file) { file->rgb[7] = kNan; }),
              IsError(ErrorKind::kRange, {.key = "rgb", .value = "7"}));
  EXPECT_THAT(error_of([](TinyRgl* file) { file->ndf[3] = kInfinity; }),
              IsError(ErrorKind::kRange, {.key = "ndf", .value = "3"}));
  EXPECT_THAT(error_of([](TinyRgl* file) { file->sigma[2] = -1; }),
              IsError(ErrorKind::kRange, {.key = "sigma", .value = "2"}));
  EXPECT_THAT(error_of([](TinyRgl* file) { file->vndf[11] = -1e-9F; }),
              IsError(ErrorKind::kRange, {.key = "vndf", .value = "11"}));
  EXPECT_THAT(error_of([](TinyRgl* file) { std::fill_n(file->vndf.begin() + 20, 20, 0.0F); }),
              IsError(ErrorKind::kData, {.key = "vndf", .value = "1"}));
  EXPECT_THAT(error_of([](TinyRgl* file) {
                file->theta_i = {0, 1, 1};
              }),
              IsError(ErrorKind::kRange, {.key = "theta_i", .value = "1"}));
  EXPECT_THAT(error_of([](TinyRgl* file) {
                file->theta_i = {0, 45, 90};
              }),
              IsError(ErrorKind::kRange, {.key = "theta_i", .value = "45"}));
  EXPECT_THAT(error_of([](TinyRgl* file) {
                file->theta_i = {-0.5F, 0, 1};
              }),
              IsError(ErrorKind::kRange, {.key = "theta_i", .value = "-0.5"}));
  EXPECT_THAT(error_of([](TinyRgl* file) {
                file->theta_i = {0, 1, 0.5F};
              }),
              IsError(ErrorKind::kRange, {.key = "theta_i", .value = "0.5"}));
  EXPECT_THAT(error_of([](TinyRgl* file) { file->phi_i = {180}; }),
              IsError(ErrorKind::kRange, {.key = "phi_i", .value = "180"}));
  EXPECT_THAT(error_of([](TinyRgl* file) {
                file->phi_i = {0, 1};
                file->FillConstant(1, 1, 1);
              }),
              IsError(ErrorKind::kFormat, {.key = "phi_i"}));
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  std::vector<TensorField> fields = file.Fields();
  fields.back().data = std::string(1, '\0');
  EXPECT_THAT(FieldsError(fields), IsError(ErrorKind::kFormat, {.key = "jacobian"}));
}

// Real measurements, where they are at hand.
std::vector<std::string> MeasuredFiles() {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(MeasuredData("rgl"), error)) {
    if (entry.path().extension() == ".bsdf") paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  return paths;
}

TEST(RglFile, RealMeasurementsAreFinitePositiveAndNearlyReciprocal) {
  const std::vector<std::string> paths = MeasuredFiles();
  if (paths.empty()) GTEST_SKIP() << "no RGL files in " << MeasuredData("rgl");
  std::vector<double> medians;
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const RglBrdf brdf = RglBrdf::Parse(ReadFile(path), path);
    ASSERT_TRUE(brdf.isotropic());
    std::mt19937 random(1);
    const auto uniform = [&random](double a, double b) {
      return a + (b - a) * static_cast<double>(random()) / 4294967296.0;
    };
    std::vector<double> errors;
    for (int n = 0; n < 4000; ++n) {
      const Direction wi = Spherical(uniform(0, 1.1), uniform(-kPi, kPi));
      const Direction wo = Spherical(uniform(0, 1.1), uniform(-kPi, kPi));
      const Rgb forth = brdf.Evaluate({wi, wo}), back = brdf.Evaluate({wo, wi});
      for (int c = 0; c < kChannels; ++c) {
        ASSERT_TRUE(std::isfinite(forth[c]) && forth[c] >= 0);
        if (forth[c] + back[c] > 0) {
          errors.push_back(std::abs(forth[c] - back[c]) / (forth[c] + back[c]) * 2);
        }
      }
    }
    ASSERT_GT(errors.size(), 6000);
    std::ranges::nth_element(errors, errors.begin() + errors.size() / 2);
    medians.push_back(errors[errors.size() / 2]);
    // Mirrors are measured, and interpolated, no better than this.
    EXPECT_LT(medians.back(), 0.3);
  }
  // Diffuse materials agree within a few percent; a misread table or cosine would not.
  EXPECT_LT(*std::ranges::min_element(medians), 0.03);
}

TEST(TabulateRgl, FillsTheWholeMerlGridFromARealMeasurement) {
  const std::vector<std::string> paths = MeasuredFiles();
  if (paths.empty()) GTEST_SKIP() << "no RGL files in " << MeasuredData("rgl");
  const BrdfTable table =
      TabulateRgl(RglBrdf::Parse(ReadFile(paths[0]), paths[0]), paths[0], {}, 2);
  EXPECT_EQ(std::ranges::count_if(table.stored[0], [](double x) { return x >= 0; }), 1096216);
  EXPECT_LT(std::ranges::count(ValidBins(table), true), 1096216);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
