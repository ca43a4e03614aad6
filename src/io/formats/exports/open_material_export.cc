#include "io/formats/exports/open_material_export.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/system/content_hash.h"
#include "io/formats/spectrum.h"
#include "io/formats/text/angle_list.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

struct OpenMaterialSize {
  int incidences, zeniths, azimuths;  // azimuths of one side of the plane of incidence
};
constexpr OpenMaterialSize kOpenMaterialSizes[] = {
    {10, 19, 13}, {16, 31, 19}, {19, 46, 31}, {31, 61, 46}, {46, 91, 61}};
constexpr int kOfColors = 3;  // so many first ones, which take seven times as many rows

const std::vector<double>& BandsOfColors() {  // [nm]
  static const std::vector<double> bands = [] {
    std::vector<double> all;
    for (int nanometers = 400; nanometers <= 700; nanometers += 50) all.push_back(nanometers);
    return all;
  }();
  return bands;
}

// From 0 to `last`, and denser towards it with a power above 1. [rad]
std::vector<double> RadiansUpTo(double last, int count, double power) {
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    angles.push_back(last * (1 - std::pow(1 - static_cast<double>(k) / (count - 1), power)));
  }
  return angles;
}

class OpenMaterialGrid {
 public:
  double median_error = 0, high_error = 0;

  OpenMaterialGrid(const ExportedBrdf& brdf, const OpenMaterialSize& size, int num_threads)
      : incidences(RadiansUpTo(kGrazingTheta, size.incidences, 1)),
        zeniths(RadiansUpTo(kGrazingTheta, size.zeniths, 1)),
        azimuths(RadiansUpTo(kPi, size.azimuths, 1.5)),
        values_(incidences.size() * zeniths.size() * azimuths.size()) {
    ParallelFor(size.incidences * size.zeniths, num_threads, [&](int row) {
      for (size_t a = 0; a < azimuths.size(); ++a) {
        const SphericalAngles at = {.theta_i = incidences[row / zeniths.size()],
                                    .phi_i = 0,
                                    .theta_o = zeniths[row % zeniths.size()],
                                    .phi_o = azimuths[a]};
        values_[row * azimuths.size() + a] = brdf.value(ToDirections(at));
      }
    });
    if (!AreGrey(values_)) ToSpectra();
    const ExportError error =
        MeasureError([this](const DirectionPair& pair) { return Interpolated(pair); }, brdf.places);
    median_error = error.median;
    high_error = error.high;
  }

  bool IsGrey() const { return spectra_.empty(); }
  int bands() const { return IsGrey() ? 1 : static_cast<int>(BandsOfColors().size()); }

  double Value(int band, size_t incidence, size_t zenith, size_t azimuth) const {
    const size_t at = IndexOf(incidence, zenith, azimuth);
    return IsGrey() ? values_[at][0] : spectra_[at * BandsOfColors().size() + band];
  }

  std::vector<double> incidences, zeniths, azimuths;  // [rad]

 private:
  size_t IndexOf(size_t incidence, size_t zenith, size_t azimuth) const {
    return (incidence * zeniths.size() + zenith) * azimuths.size() + azimuth;
  }

  // The values become the colours of their spectra.
  void ToSpectra() {
    SmoothSpectra spectrum_of(BandsOfColors());
    const SpectralColor color(BandsOfColors(), "spectra");
    for (Rgb& value : values_) {
      const std::span<const double> spectrum = spectrum_of(value);
      spectra_.insert(spectra_.end(), spectrum.begin(), spectrum.end());
      value = color(spectrum);
      for (double& x : value) x = std::max(x, 0.0);
    }
  }

  // Interpolates linearly in all three angles.
  Rgb Interpolated(const DirectionPair& pair) const {
    const SphericalAngles at = ToSphericalAngles(pair);
    const double azimuth = std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
    const BetweenNodes axes[] = {FindBetween(incidences, at.theta_i),
                                 FindBetween(zeniths, at.theta_o), FindBetween(azimuths, azimuth)};
    Rgb sum{};
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1;
      size_t index[3];
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned upper = corner >> k & 1U;
        weight *= upper == 1 ? axes[k].t : 1 - axes[k].t;
        index[k] = axes[k].lower + upper;
      }
      if (weight == 0) continue;
      const Rgb& value = values_[IndexOf(index[0], index[1], index[2])];
      for (int c = 0; c < kChannels; ++c) sum[c] += weight * value[c];
    }
    return sum;
  }

  std::vector<Rgb> values_;      // [incidence][zenith][azimuth]
  std::vector<double> spectra_;  // [incidence][zenith][azimuth][band], or empty for grey ones
};

// "[5.5e-07,0.1,0.2,3.14,5.00000e-02]" and so on, sorted by columns as the schema asks for.
std::string FormatRows(const OpenMaterialGrid& grid, const std::vector<double>& metres) {
  std::string text;
  const auto append_row = [&](int band, size_t i, size_t o, size_t a, double azimuth) {
    text += text.empty() ? "[" : ",\n[";
    for (const double number : {metres[band], grid.incidences[i], grid.zeniths[o], azimuth}) {
      text += Text(number, 6) + ',';
    }
    AppendNumber(grid.Value(band, i, o, a), &text);
    text += ']';
  };
  const size_t last = grid.azimuths.size() - 1;
  for (int band = 0; band < grid.bands(); ++band) {
    for (size_t i = 0; i < grid.incidences.size(); ++i) {
      for (size_t o = 0; o < grid.zeniths.size(); ++o) {
        for (size_t a = 0; a <= last; ++a) append_row(band, i, o, a, grid.azimuths[a]);
        for (size_t a = last - 1; a > 0; --a) {
          append_row(band, i, o, a, 2 * kPi - grid.azimuths[a]);
        }
      }
    }
  }
  return text;
}

// 32 digits as 8-4-4-4-12.
std::string UuidOf(const std::string& digits) {
  std::string uuid;
  for (size_t k = 0; k < digits.size(); ++k) {
    if (k == 8 || k == 12 || k == 16 || k == 20) uuid += '-';
    uuid += digits[k];
  }
  return uuid;
}

std::string FormatOpenMaterial(const OpenMaterialGrid& grid, const std::string& name) {
  std::vector<double> metres = {5.5e-7};
  if (!grid.IsGrey()) {
    metres = BandsOfColors();
    for (double& metre : metres) metre /= 1e9;
  }
  const std::string rows = FormatRows(grid, metres);
  const nlohmann::ordered_json metadata = {
      {"name", name},
      {"description",
       "BRDF [1/sr]; azimuths are counted from that of the light, pi is the mirror direction."},
      {"uuid", UuidOf(ContentHash(rows))},
      {"materialVersion", "1.0.0"},
      {"openMaterial3dVersion", "1.1.0"},
      {"copyrights", {"not stated"}},
      {"license", "not stated"},
      {"authors", {"written by Trilobe"}},
      {"sources", "a model fitted to a measurement"}};
  return "{\"$schema\": "
         "\"https://raw.githubusercontent.com/asam-ev/OpenMATERIAL-3D/refs/tags/v1.1.0/schemas/"
         "material_brdf_schema.json\",\n\"metadata\": " +
         JsonText(metadata) + ",\n\"brdf\": {\"wavelengths\": " + nlohmann::json(metres).dump() +
         ",\n\"lookupTable\": [\n" + rows + "]}}\n";
}

}  // namespace

OpenMaterialExport ExportOpenMaterial(const ExportedBrdf& brdf, const std::string& name,
                                      int num_threads) {
  if (brdf.anisotropic) {
    throw Error(
        ErrorKind::kUnsupported,
        "a table of OpenMATERIAL 3D has no azimuth of the light, and so no anisotropic material; "
        "write .bsdf, .zemax.bsdf or .xml")
        .About("anisotropic");
  }
  constexpr double kMaxError = 0.005;
  const auto make = [&](int k) {
    return OpenMaterialGrid(brdf, kOpenMaterialSizes[k], num_threads);
  };
  OpenMaterialGrid grid = make(0);
  const int count = grid.IsGrey() ? static_cast<int>(std::size(kOpenMaterialSizes)) : kOfColors;
  grid = ChooseSmallest<OpenMaterialGrid>(count, make, kMaxError);
  return {.bytes = FormatOpenMaterial(grid, name),
          .colored = !grid.IsGrey(),
          .incidences = static_cast<int>(grid.incidences.size()),
          .zeniths = static_cast<int>(grid.zeniths.size()),
          .azimuths = static_cast<int>(2 * grid.azimuths.size() - 2),
          .median_error = grid.median_error,
          .high_error = grid.high_error};
}

}  // namespace trilobe
