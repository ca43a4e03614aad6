#include "io/formats/text/csv_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "io/formats/text/column_layout.h"
#include "io/formats/text/matrix_table.h"
#include "io/formats/text/table_reader.h"
#include "io/formats/text/text_table.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// Spherical angles with phi_i = 0 and phi_o from 0 to 360 degrees.
SphericalAngles FromIncidentPlane(const HalfDiffAngles& angles) {
  SphericalAngles at = ToSphericalAngles(ToDirections(angles));
  at.phi_o -= at.phi_i;
  at.phi_i = 0;
  if (at.phi_o < 0) at.phi_o += 2 * kPi;
  return at;
}

// The angle that reads back to the same radians: 15 for what was read as 15, and not
// 14.999999999999998.
double InDegrees(double radians) {
  constexpr double kSteps = 1e9;  // a degree
  const double degrees = RadiansToDegrees(radians);
  const double rounded = std::round(degrees * kSteps) / kSteps;
  return DegreesToRadians(rounded) == radians ? rounded : degrees;
}

// Writes a row per sample, with as many digits as read back to the same numbers: its directions,
// and so many columns of values. Samples on a grid stand at the centres of its bins,
// with phi_i = 0.
void WriteRows(
    const std::string& path, const std::string& head, const BrdfSamples& samples, size_t columns,
    const std::function<void(int, std::span<double>)>& values,
    const BeforeRenaming& before_renaming = [](std::string_view) {}) {
  WriteFile(
      path,
      [&](std::ostream& out) {
        out << head << '\n';
        std::vector<double> of_row(columns);
        std::vector<char> row((kAngles + columns) * 32);  // the longest double has 24 characters
        for (int j = 0; j < samples.size(); ++j) {
          char* end = row.data();
          const auto add = [&](double number) {
            end = std::to_chars(end, row.data() + row.size(), number).ptr;
            *end++ = ',';
          };
          const SphericalAngles at = samples.directions.empty()
                                         ? FromIncidentPlane(samples.Angles(j))
                                         : samples.directions[j];
          for (const double angle : {at.theta_i, at.phi_i, at.theta_o, at.phi_o}) {
            add(InDegrees(angle));
          }
          values(j, of_row);
          for (const double value : of_row) add(value);
          end[-1] = '\n';
          out.write(row.data(), end - row.data());
        }
      },
      before_renaming);
}

// Writes the valid samples. Throws Error where there is none.
std::string WriteCsv(const Measurement& measurement, const std::string& path, int /*num_threads*/,
                     const BeforeRenaming& before_renaming) {
  const std::optional<BrdfSamples> of_table =
      measurement.table ? std::optional(SamplesOf(measurement)) : std::nullopt;
  const BrdfSamples& samples = of_table ? *of_table : measurement.samples;
  if (samples.size() == 0) SamplesOf(measurement);  // throws
  const std::string count = std::to_string(samples.size());
  WriteRows(
      path, "# BRDF [1/sr] of " + count + " pairs of directions [degrees]\n" + kUsualColumns,
      samples, kChannels,
      [&](int j, std::span<double> row) { std::ranges::copy(samples.rho[j], row.begin()); },
      before_renaming);
  return count + " samples";
}

// A header that names an angle and another column, or those of a matrix, within the first lines.
bool LooksLikeCsv(std::string_view text) {
  constexpr size_t kLongest = 1 << 16;
  text = text.substr(0, kLongest);
  if (text.starts_with("TracePro")) return false;  // has such a line further on
  return FindTableHead(text, "", /*theta_is_given=*/false).has_value() || HasAxes(text);
}

}  // namespace

void WriteBesideCsv(const BrdfSamples& measured, std::span<const Rgb> fitted,
                    const std::string& path) {
  WriteRows(path,
            "theta_i,phi_i,theta_o,phi_o,measured_r,measured_g,measured_b,fitted_r,fitted_g,"
            "fitted_b",
            measured, 2 * kChannels, [&](int j, std::span<double> row) {
              std::ranges::copy(measured.rho[j], row.begin());
              std::ranges::copy(fitted[j], row.begin() + kChannels);
            });
}

void WriteSpectraCsv(const BrdfSamples& at, std::span<const double> wavelengths,
                     const std::function<void(int, std::span<double>)>& spectrum,
                     const std::string& path) {
  std::ostringstream head;
  head << "# BRDF [1/sr] of " << at.size() << " pairs of directions [degrees] at "
       << wavelengths.size() << " wavelengths [nm]\ntheta_i,phi_i,theta_o,phi_o";
  for (const double wavelength : wavelengths) head << "," << wavelength << "nm";
  WriteRows(path, head.str(), at, wavelengths.size(), spectrum);
}

MeasurementFormat CsvFormat() {
  return {.name = "csv",
          .description = "a .csv file of samples",
          .ending = ".csv",
          .is_text = true,
          .recognise = LooksLikeCsv,
          .read = ReadTextTable,
          .written_as = "CSV",
          .holds_anisotropic = true,
          .write = WriteCsv};
}

}  // namespace trilobe
