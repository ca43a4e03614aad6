#include "io/formats/exports/rgl_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats/databases/bilinear_warp.h"
#include "io/formats/databases/rgl_file.h"
#include "io/formats/databases/tensor_file.h"
#include "io/formats/exports/exported_brdf.h"
#include "io/formats/spectrum.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

struct Size {
  int theta_i, phi_i, n;
};
// Mitsuba takes square tables alone. 36 x 128 x 56 would leave chm_mint an error of 0.6 %, as large
// as 48 x 128 x 128 nearly: theta wants more nodes than phi.
constexpr Size kIsotropic[] = {{8, 1, 32},  {16, 1, 32}, {16, 1, 64},
                               {32, 1, 64}, {28, 1, 96}, {48, 1, 128}};
constexpr Size kAnisotropic[] = {{8, 9, 32}, {8, 17, 32}, {12, 25, 32}, {12, 37, 48}};
constexpr int kUsual = 4;  // so many first ones are of usual size

// Wavelengths of `spectra` [nm]. Renderers interpolate linearly between them, and repeat the first
// and the last beyond them.
constexpr double kFirstWavelength = 400, kWavelengthStep = 20;
constexpr int kWavelengths = 16;

// Nodes of ndf, sigma and vndf over u = sqrt(2 theta / pi): those of a D of 90 bins are the odd
// ones of the first, and it is linear between them as these tables are.
constexpr int kNdf = 181, kVndf = 361;

double ThetaOf(double u) { return u * u * (kPi / 2); }

Direction Reflected(const Direction& wi, const Direction& m) {
  const double twice = 2 * Dot(wi, m);
  return {twice * m[0] - wi[0], twice * m[1] - wi[1], twice * m[2] - wi[2]};
}

// A BRDF of so many bands, R, G and B or wavelengths.
struct BandsBrdf {
  int count = kChannels;
  std::function<void(const DirectionPair&, std::span<double> rho)> value;
};

// The tables of a file, from a model and the values that the file shall have, of which the model is
// the colour. The file's value is
//   rho cos theta_o = rgb(x) ndf(m) / (4 sigma(wi)),  m the half vector, x where the warp sends m.
class Tables {
 public:
  Tables(const FactorModel& model, BandsBrdf bands, double max_theta)
      : model_(model),
        bands_(std::move(bands)),
        bsdf_(model),
        least_cosine_(std::cos(std::min(max_theta, kGrazingTheta))) {
    MakeNdf();
    MakeSigma();
    MakeVndf();
  }

  // The fields of a file, but for those of colour; theta_i stands at 90 t^0.6 degrees, t from 0 to
  // 1.
  struct File {
    TensorFileWriter writer;
    std::vector<float> values;  // [phi_i][theta_i][band][n][n]
  };
  File Fields(const Size& size, const std::string& description) const {
    const auto floats = [](const std::vector<double>& values) {
      return std::vector<float>(values.begin(), values.end());
    };
    const int p = size.phi_i, t = size.theta_i, n = size.n;
    std::vector<double> theta_i, phi_i;
    for (int k = 0; k < t; ++k) {
      theta_i.push_back(kPi / 2 * std::pow(static_cast<double>(k) / (t - 1), 0.6));
    }
    for (int k = 0; k < p; ++k) phi_i.push_back(p == 1 ? 0 : -kPi + 2 * kPi * k / (p - 1));
    Values values = ValuesAt(phi_i, theta_i, n);
    File file;
    file.values = std::move(values.of_bands);
    file.writer.AddBytes("description", description);
    file.writer.AddBytes("jacobian", std::string_view("\1", 1));
    file.writer.AddFloat32("phi_i", {p}, floats(phi_i));
    file.writer.AddFloat32("theta_i", {t}, floats(theta_i));
    file.writer.AddFloat32("ndf", {ndf_.rows, ndf_.columns}, floats(ndf_.values));
    file.writer.AddFloat32("sigma", {sigma_.rows, sigma_.columns}, floats(sigma_.values));
    std::vector<float> vndf;
    for (int slice = 0; slice < p * t; ++slice) {
      vndf.insert(vndf.end(), vndf_.values.begin(), vndf_.values.end());
    }
    file.writer.AddFloat32("vndf", {p, t, vndf_.rows, vndf_.columns}, vndf);
    file.writer.AddFloat32("luminance", {p, t, n, n}, values.luminance);
    return file;
  }

 private:
  double NdfAt(double u, double phi) const {
    const double turns = phi / (2 * kPi) + 0.5;
    return ndf_.At(0, {u, turns - std::floor(turns)});
  }

  // Reflected light of a half vector m over the albedo, for directions wi that were measured and
  // whose wo were, too: `value` is the mean of f cos theta_o, and `light` the sum of that by solid
  // angle,
  //   d omega_o = 4 (wi . m) sin theta_m d theta_m d phi_m,  d theta_m in proportion to u du.
  struct Seen {
    double value = 0, light = 0;
    bool any = false;
  };
  Seen SeenAt(double u, double phi_m) const {
    constexpr int kThetas = 8, kPhis = 12;
    const double theta_m = ThetaOf(u);
    const Direction m = ToDirection({theta_m, phi_m});
    Seen seen;
    int count = 0;
    for (int t = 0; t < kThetas; ++t) {
      const double theta_i = std::acos(1 - (t + 0.5) / kThetas * (1 - least_cosine_));
      for (int p = 0; p < kPhis; ++p) {
        const Direction wi = ToDirection({theta_i, phi_m + 2 * kPi * p / kPhis});
        const Direction wo = Reflected(wi, m);
        if (wo[2] < least_cosine_ || Dot(wi, m) <= 0) continue;
        const double albedo = std::max(Mean(bsdf_.Albedo(wi)), 1e-9);
        const double value = Mean(bsdf_.Value(wi, wo)) * wo[2] / albedo;
        seen.value += value;
        seen.light += value * Dot(wi, m) * std::sin(theta_m) * u;
        ++count;
      }
    }
    seen.any = count > 0;
    if (seen.any) seen.value /= count;
    return seen;
  }

  // Sets ndf to the mean value of each half vector, by which values change little over x; that is
  // D, times what G and F let through of it. Half vectors without a value take that of the one
  // before.
  void MakeNdf() {
    const ModelSpec& spec = model_.spec();
    const int rows = spec.anisotropic() ? 2 * std::max(spec.d_axis.phi_nodes, 24) + 1 : 2;
    ndf_ = {rows, kNdf, {}};
    for (int row = 0; row < rows; ++row) {
      const double phi = -kPi + 2 * kPi * row / (rows - 1);
      double value = 0;
      for (int k = 0; k < kNdf; ++k) {
        const Seen seen = SeenAt(static_cast<double>(k) / (kNdf - 1), phi);
        if (seen.any) value = seen.value;
        ndf_.values.push_back(value);
      }
    }
    const double largest = *std::ranges::max_element(ndf_.values);
    if (!(largest > 0)) {
      throw Error(ErrorKind::kData, "the model is black; there is nothing to write")
          .About("model", "black");
    }
    // Nowhere so small that float32 or a ratio to it suffers.
    for (double& x : ndf_.values) x = std::max(x / largest, 1e-7);
  }

  // One over the albedo, by which values change little from one theta_i to the next.
  void MakeSigma() {
    sigma_ = {2, kNdf, {}};
    for (int row = 0; row < 2; ++row) {
      for (int k = 0; k < kNdf; ++k) {
        const double theta = std::min(ThetaOf(static_cast<double>(k) / (kNdf - 1)), kGrazingTheta);
        sigma_.values.push_back(1 / std::max(Mean(bsdf_.Albedo(ToDirection({theta, 0}))), 1e-9));
      }
    }
  }

  // The density of half vectors over u, whatever their azimuth: by the light that is seen by them,
  // and so much by projected solid angle alone, that there are nodes where little is seen, too. It
  // rises as u^3 from 0.
  void MakeVndf() {
    constexpr int kPhis = 8;
    constexpr double kByArea = 2;
    const int phis = model_.spec().anisotropic() ? kPhis : 1;
    std::vector<double> light(kVndf), area(kVndf);
    for (int k = 0; k < kVndf; ++k) {
      const double u = static_cast<double>(k) / (kVndf - 1);
      for (int r = 0; r < phis; ++r) {
        const double phi = -kPi + 2 * kPi * r / phis;
        light[k] += SeenAt(u, phi).light;
      }
      area[k] = std::sin(2 * ThetaOf(u)) * u;
    }
    const auto sum = [](const std::vector<double>& values) {
      return std::max(std::accumulate(values.begin(), values.end(), 0.0), 1e-30);
    };
    const double all = sum(light), all_area = sum(area);
    vndf_ = {2, kVndf, {}};
    for (int k = 0; k < 2 * kVndf; ++k) {
      const int column = k % kVndf;
      const double u = static_cast<double>(column) / (kVndf - 1);
      vndf_.values.push_back(
          std::max(light[column] / all + kByArea * area[column] / all_area, 1e-9 * u * u * u));
    }
  }

  struct Values {
    std::vector<float> of_bands;   // [phi_i][theta_i][band][n][n]
    std::vector<float> luminance;  // [phi_i][theta_i][n][n]
  };
  Values ValuesAt(const std::vector<double>& all_phi_i, const std::vector<double>& all_theta_i,
                  int n) const {
    Values values;
    const BilinearWarp warp(vndf_);
    const bool anisotropic = model_.spec().anisotropic();
    const double least_cosine = std::cos(kGrazingTheta);
    std::vector<std::vector<float>> by_band(bands_.count);
    std::vector<double> f(bands_.count);
    for (const double phi_i : all_phi_i) {
      for (const double theta : all_theta_i) {
        const double theta_i = std::min(theta, kGrazingTheta);
        const Direction wi = ToDirection({theta_i, phi_i});
        const double sigma = sigma_.At(0, {std::sqrt(theta_i * (2 / kPi)), 0});
        for (std::vector<float>& of_band : by_band) of_band.clear();
        for (int node = 0; node < n * n; ++node) {
          const int row = node / n, column = node % n;
          const SquarePoint x = {static_cast<double>(column) / (n - 1),
                                 static_cast<double>(row) / (n - 1)};
          const SquarePoint u = warp.Sample(0, x);
          const double theta_m = ThetaOf(u.x), turn = (u.y - 0.5) * 2 * kPi;
          const double phi_m = anisotropic ? turn : phi_i + turn;
          const Direction m = ToDirection({theta_m, phi_m});
          Direction wo = Reflected(wi, m);
          const bool above = wo[2] > 0 && Dot(wi, m) > 0;
          // Points below the horizon are read by interpolation next to it; they get values of the
          // horizon.
          wo[2] = std::max(wo[2], least_cosine);
          const double length = std::sqrt(Dot(wo, wo));
          for (double& a : wo) a /= length;
          const double ndf = NdfAt(u.x, phi_m);
          bands_.value({wi, wo}, f);
          double mean = 0;
          for (int l = 0; l < bands_.count; ++l) {
            const double value = f[l] * wo[2] * 4 * sigma / ndf;
            by_band[l].push_back(static_cast<float>(value));
            mean += value / bands_.count;
          }
          // Renderers draw x by this: what is reflected, by the solid angles of x,
          //   d omega_o = 4 (wi . m) sin theta_m (2 pi^2 u) du dv, du dv = dx dy / vndf.
          const double density = vndf_.At(0, u);
          const double spread =
              4 * Dot(wi, m) * std::sin(theta_m) * 2 * kPi * kPi * u.x / std::max(density, 1e-12);
          values.luminance.push_back(
              static_cast<float>(above ? mean * ndf / (4 * sigma) * spread : 0));
        }
        for (const std::vector<float>& of_band : by_band) {
          values.of_bands.insert(values.of_bands.end(), of_band.begin(), of_band.end());
        }
        const auto slice = std::span(values.luminance).last(static_cast<size_t>(n) * n);
        const float largest = *std::ranges::max_element(slice);
        // Positive everywhere, so that all that reflects can be drawn.
        for (float& x : slice) x = largest > 0 ? std::max(x / largest, 1e-4F) : 1;
      }
    }
    return values;
  }

  const FactorModel& model_;
  const BandsBrdf bands_;
  const Bsdf<double> bsdf_;
  const double least_cosine_;  // of what was measured
  BilinearStack ndf_, sigma_, vndf_;
};

// [slice][channel][node] of colours to [slice][wavelength][node], and what the colours lose.
std::vector<float> SpectraOf(const std::vector<float>& rgb, const std::vector<double>& wavelengths,
                             const Size& size, RglExport* result) {
  SmoothSpectra spectrum_of(wavelengths);
  const size_t nodes = static_cast<size_t>(size.n) * size.n;
  const size_t slices = rgb.size() / (nodes * kChannels);
  std::vector<float> spectra(slices * wavelengths.size() * nodes);
  int off = 0;
  for (size_t slice = 0; slice < slices; ++slice) {
    const float* from = &rgb[slice * kChannels * nodes];
    float* target = &spectra[slice * wavelengths.size() * nodes];
    for (size_t node = 0; node < nodes; ++node) {
      const auto spectrum = spectrum_of({from[node], from[nodes + node], from[2 * nodes + node]});
      for (size_t l = 0; l < wavelengths.size(); ++l) {
        target[l * nodes + node] = static_cast<float>(spectrum[l]);
      }
      result->color_error = std::max(result->color_error, spectrum_of.error());
      if (spectrum_of.error() > 1e-3) ++off;
    }
  }
  result->colors_off = off / static_cast<double>(slices * nodes);
  return spectra;
}

// Colours in a file: RGB, spectra made of RGB, or given spectra.
struct FileColors {
  enum class Kind { kRgb, kMadeSpectra, kSpectra } kind = Kind::kRgb;
  std::vector<double> wavelengths = {};  // of kSpectra
};

RglExport FileOf(const Tables& tables, const Size& size, const std::string& description,
                 const FileColors& colors) {
  RglExport result = {
      .bytes = {}, .theta_i = size.theta_i, .phi_i = size.phi_i, .resolution = size.n};
  Tables::File file = tables.Fields(size, description);
  if (colors.kind == FileColors::Kind::kRgb) {
    file.writer.AddFloat32("rgb", {size.phi_i, size.theta_i, kChannels, size.n, size.n},
                           file.values);
  } else {
    std::vector<double> wavelengths = colors.wavelengths;
    if (colors.kind == FileColors::Kind::kMadeSpectra) {
      for (int l = 0; l < kWavelengths; ++l) {
        wavelengths.push_back(kFirstWavelength + l * kWavelengthStep);
      }
      file.values = SpectraOf(file.values, wavelengths, size, &result);
    }
    const int count = static_cast<int>(wavelengths.size());
    file.writer.AddFloat32("wavelengths", {count}, {wavelengths.begin(), wavelengths.end()});
    file.writer.AddFloat32("spectra", {size.phi_i, size.theta_i, count, size.n, size.n},
                           file.values);
  }
  result.bytes = file.writer.Bytes();
  return result;
}

BandsBrdf ChannelsOf(const PairBrdf& value) {
  return {.count = kChannels, .value = [value](const DirectionPair& pair, std::span<double> rho) {
            std::ranges::copy(value(pair), rho.begin());
          }};
}

RglExport Export(const FactorModel& model, const ExportedBrdf& brdf, const BandsBrdf& bands,
                 const FileColors& colors, const std::string& description, bool any_error,
                 const RglExportOptions& options) {
  std::span<const Size> sizes =
      brdf.anisotropic ? std::span<const Size>(kAnisotropic) : std::span<const Size>(kIsotropic);
  if (any_error) sizes = sizes.first(kUsual);
  const double max_error = options.max_error.value_or(brdf.anisotropic ? 0.02 : 0.005);
  const Tables tables(model, bands, options.max_theta);
  auto result = ChooseSmallest<RglExport>(
      static_cast<int>(sizes.size()),
      [&](int k) {
        RglExport made = FileOf(tables, sizes[k], description, colors);
        const RglBrdf file = RglBrdf::Parse(made.bytes, "the file to be written");
        const ExportError error = MeasureError(
            [&](const DirectionPair& pair) { return file.Evaluate(pair); }, brdf.places);
        made.median_error = error.median;
        made.high_error = error.high;
        return made;
      },
      max_error);
  if (!any_error && options.max_error) {
    RequireExact(result.bytes.size(), result.median_error, max_error);
  }
  return result;
}

FileColors ColorsAs(const RglExportOptions& options) {
  return {options.spectral ? FileColors::Kind::kMadeSpectra : FileColors::Kind::kRgb};
}

constexpr const char* kOfModel = "a microfacet model, fitted by Trilobe";

}  // namespace

RglExport ExportRgl(const FactorModel& model, const RglExportOptions& options) {
  const ExportedBrdf brdf = ExportedModel(model, options.max_theta);
  return Export(model, brdf, ChannelsOf(brdf.value), ColorsAs(options), kOfModel, false, options);
}

RglExport ExportRgl(const SpectralModel& model, const RglExportOptions& options) {
  CheckParameters(model);
  if (model.bands() < 2) {
    throw Error(ErrorKind::kUnsupported,
                "a file of spectra needs two or more wavelengths, and the model has one; leave out "
                "--spectral for a grey one")
        .About("wavelengths", model.bands());
  }
  const FactorModel rgb = model.ToRgb();
  const BandsBrdf bands = {.count = model.bands(),
                           .value = [&model](const DirectionPair& pair, std::span<double> rho) {
                             std::ranges::copy(Evaluate(model, pair), rho.begin());
                           }};
  return Export(rgb, ExportedModel(rgb, options.max_theta), bands,
                {FileColors::Kind::kSpectra, model.wavelengths()}, kOfModel, false, options);
}

RglExport ExportRgl(const FactorModel& model, const CompletedMeasurement& measured,
                    const RglExportOptions& options) {
  CheckParameters(model);
  return Export(model, {measured.value, model.spec().anisotropic(), measured.places},
                ChannelsOf(measured.value), ColorsAs(options),
                "measured values, between which a model stands that Trilobe fitted to them",
                !options.max_error, options);
}

}  // namespace trilobe
