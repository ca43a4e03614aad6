#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json_value.h"
#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// 700,000 rows.
constexpr JsonLimits kTableLimits = {.bytes = size_t{1} << 26, .values = size_t{1} << 22};

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

struct OpenMaterialRow {
  SphericalAngles at;
  double value = 0;  // [1/sr]; NaN: none
};

// The rows of a wavelength.
struct OpenMaterialBand {
  double wavelength = 0;  // [nm]
  std::vector<OpenMaterialRow> rows;
};

class OpenMaterialTable {
 public:
  OpenMaterialTable(std::string_view text, const std::string& source) : source_(source) {
    const JsonValue file = JsonValue::Parse(text, source, "", kTableLimits);
    const JsonValue* const brdf = Member(file, "brdf", JsonValue::Type::kObject);
    ReadUnit(*brdf);
    const JsonValue* const table = Member(*brdf, "lookupTable", JsonValue::Type::kArray);
    for (size_t k = 0; k < table->size(); ++k) AddRow((*table)[k], k);
    if (bands_.empty()) {
      throw ErrorIn(ErrorKind::kMissing, source, "lookupTable has no rows").About("lookupTable");
    }
  }

  const std::vector<OpenMaterialBand>& bands() const { return bands_; }
  bool in_decibels() const { return in_decibels_; }

 private:
  const JsonValue* Member(const JsonValue& object, const char* key, JsonValue::Type type) const {
    const JsonValue* const member =
        object.type() == JsonValue::Type::kObject ? object.Find(key) : nullptr;
    if (member == nullptr || member->type() != type) {
      throw ErrorIn(ErrorKind::kFormat, source_,
                    std::string("expected '") + key +
                        "', as the schema material_brdf of OpenMATERIAL 3D has it")
          .About(key);
    }
    return member;
  }

  // Decibels are those of a Lambertian white, f = 1 / pi.
  void ReadUnit(const JsonValue& brdf) {
    const JsonValue* const unit = brdf.Find("amplitudeUnit");
    if (unit == nullptr) return;
    const std::string text =
        unit->type() == JsonValue::Type::kString ? unit->string() : unit->type_name();
    in_decibels_ = text == "dB";
    if (in_decibels_ || text == "1/sr" || text == "sr^-1") return;
    throw ErrorIn(ErrorKind::kUnknown, source_,
                  "amplitudeUnit is " + text + ", and dB and 1/sr alone are read")
        .About("amplitudeUnit", text);
  }

  void AddRow(const JsonValue& row, size_t index) {
    const auto fail = [&](ErrorKind kind, const char* column, const std::string& problem) {
      const std::string place = std::to_string(index + 1);
      throw ErrorIn(kind, source_, "lookupTable, row " + place + ": " + problem)
          .About(std::string("lookupTable/") + place, column);
    };
    constexpr size_t kColumns = 5;
    if (row.type() != JsonValue::Type::kArray || row.size() != kColumns) {
      fail(ErrorKind::kFormat, "columns",
           "expected wavelength, incident zenith, exit zenith, exit azimuth and BRDF");
    }
    std::array<double, kColumns> numbers{};
    for (size_t k = 0; k < kColumns; ++k) {
      const JsonValue::Type type = row[k].type();
      const bool is_null = type == JsonValue::Type::kNull;
      if (type != JsonValue::Type::kNumber && !(is_null && k == kColumns - 1)) {
        fail(ErrorKind::kFormat, row[k].type_name(),
             std::string("expected a number, not ") + row[k].type_name());
      }
      numbers[k] = is_null ? kNoValue : row[k].number();
    }
    if (in_decibels_) numbers.back() = std::pow(10, numbers.back() / 10) / kPi;
    const auto& [wavelength, theta_i, theta_o, phi_o, value] = numbers;
    if (!(wavelength >= 1e-9 && wavelength <= 0.1)) {
      fail(ErrorKind::kRange, "wavelength", "the first number is no wavelength in m");
    }
    constexpr double kRounding = 1e-4;
    for (const double theta : {theta_i, theta_o}) {
      if (!(theta >= 0 && theta <= kPi / 2 + kRounding)) {
        fail(ErrorKind::kRange, "zenith", "a zenith angle is not from 0 to pi/2 rad");
      }
    }
    if (!(phi_o >= -kRounding && phi_o <= 2 * kPi + kRounding)) {
      fail(ErrorKind::kRange, "azimuth", "the azimuth is not from 0 to 2 pi rad");
    }
    const double nanometers = wavelength * 1e9;
    if (bands_.empty() || nanometers != bands_.back().wavelength) {
      bands_.push_back({.wavelength = nanometers, .rows = {}});
    }
    bands_.back().rows.push_back({{theta_i, 0, theta_o, phi_o}, value});
  }

  std::string source_;
  bool in_decibels_ = false;
  std::vector<OpenMaterialBand> bands_;
};

bool SameDirections(const OpenMaterialBand& a, const OpenMaterialBand& b) {
  return std::ranges::equal(a.rows, b.rows, [](const auto& one, const auto& other) {
    return one.at.theta_i == other.at.theta_i && one.at.theta_o == other.at.theta_o &&
           one.at.phi_o == other.at.phi_o;
  });
}

// A table of ASAM OpenMATERIAL 3D, schema `material_brdf` (docs/file-formats.md): rows by
// wavelength, with angles and the BRDF; one wavelength counts for all channels. Azimuths are
// counted from that of the incident direction. Throws Error, with the row, on anything else.
Measurement ParseOpenMaterial(std::string_view text, const std::string& source,
                              const SourceOptions& options) {
  const OpenMaterialTable table(text, source);
  const std::vector<OpenMaterialBand>& bands = table.bands();
  std::vector<double> wavelengths;
  for (const OpenMaterialBand& band : bands) {
    wavelengths.push_back(band.wavelength);
    if (!SameDirections(band, bands[0])) {
      throw ErrorIn(ErrorKind::kMismatch, source,
                    "lookupTable has other directions at " +
                        std::to_string(std::lround(band.wavelength)) + " nm than at " +
                        std::to_string(std::lround(bands[0].wavelength)) +
                        " nm; give a file of each wavelength")
          .About("lookupTable", std::lround(band.wavelength));
    }
  }
  SpectrumBands spectra(wavelengths, options.bands, source);
  SampleCollector collector(source, "OpenMATERIAL 3D table of scattered samples");
  std::vector<double> spectrum(bands.size());
  for (size_t k = 0; k < bands[0].rows.size(); ++k) {
    std::ranges::transform(bands, spectrum.begin(),
                           [&](const OpenMaterialBand& band) { return band.rows[k].value; });
    spectra.Add(bands[0].rows[k].at, spectrum, &collector, /*nan_is_gap=*/true);
  }
  Measurement measurement = collector.Take();
  measurement.bands = spectra.all();
  measurement.notes.push_back(
      "read as: " + spectra.Note() +
      (table.in_decibels() ? ", decibels of a Lambertian white as 10^(dB/10) / pi" : "") +
      ", azimuths from that of the light; --azimuth=from_mirror takes them from the mirror "
      "direction");
  return measurement;
}

bool LooksLikeOpenMaterial(std::string_view text) {
  return text.find("material_brdf_schema") != std::string_view::npos ||
         text.find("\"lookupTable\"") != std::string_view::npos;
}

}  // namespace

MeasurementFormat OpenMaterialFormat() {
  return {.name = "openmaterial",
          .description = "an OpenMATERIAL 3D .xompt table",
          .ending = ".xompt",
          .is_text = true,
          .is_json = true,
          .recognise = LooksLikeOpenMaterial,
          .read = ParseOpenMaterial};
}

}  // namespace trilobe
