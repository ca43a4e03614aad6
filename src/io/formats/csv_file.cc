#include "io/formats/csv_file.h"

#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <string>

#include "core/files/file.h"
#include "io/formats/table_columns.h"
#include "io/formats/table_reader.h"
#include "io/formats/text_table.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr size_t kColumns = 10;

// With phi_i = 0 and phi_o from 0 to 360 degrees.
SphericalAngles FromIncidentPlane(const HalfDiffAngles& angles) {
  SphericalAngles at = ToSphericalAngles(ToDirections(angles));
  at.phi_o -= at.phi_i;
  at.phi_i = 0;
  if (at.phi_o < 0) at.phi_o += 2 * kPi;
  return at;
}

// Writes a row per sample, with as many digits as read back to the same numbers: its directions,
// its values and, unless empty, other values. Samples on a grid stand at the centres of its bins,
// with phi_i = 0.
void WriteRows(const std::string& path, const std::string& head, const BrdfSamples& samples,
               std::span<const Rgb> others) {
  WriteFile(path, [&](std::ostream& out) {
    out << head << '\n';
    std::array<char, kColumns * 32> row;  // the longest double has 24 characters
    for (int j = 0; j < samples.size(); ++j) {
      char* end = row.data();
      const auto add = [&](double number) {
        end = std::to_chars(end, row.data() + row.size(), number).ptr;
        *end++ = ',';
      };
      const SphericalAngles at =
          samples.directions.empty() ? FromIncidentPlane(samples.Angles(j)) : samples.directions[j];
      for (const double angle : {at.theta_i, at.phi_i, at.theta_o, at.phi_o}) {
        add(RadiansToDegrees(angle));
      }
      for (const double value : samples.rho[j]) add(value);
      if (!others.empty()) {
        for (const double value : others[j]) add(value);
      }
      end[-1] = '\n';
      out.write(row.data(), end - row.data());
    }
  });
}

// Writes the valid samples. Throws Error where there is none.
std::string WriteCsv(const Measurement& measurement, const std::string& path, int /*num_threads*/) {
  const std::optional<BrdfSamples> of_table =
      measurement.table ? std::optional(SamplesOf(measurement)) : std::nullopt;
  const BrdfSamples& samples = of_table ? *of_table : measurement.samples;
  if (samples.size() == 0) SamplesOf(measurement);  // throws
  const std::string count = std::to_string(samples.size());
  WriteRows(path, "# BRDF [1/sr] of " + count + " pairs of directions [degrees]\n" + kUsualColumns,
            samples, {});
  return count + " samples";
}

// A header that names an angle and another column, within the first lines.
bool LooksLikeCsv(std::string_view text) {
  constexpr size_t kLongest = 1 << 16;
  return FindTableHead(text.substr(0, kLongest), "", /*theta_i_is_given=*/false).has_value();
}

}  // namespace

void WriteBesideCsv(const BrdfSamples& measured, std::span<const Rgb> fitted,
                    const std::string& path) {
  WriteRows(path,
            "theta_i,phi_i,theta_o,phi_o,measured_r,measured_g,measured_b,fitted_r,fitted_g,"
            "fitted_b",
            measured, fitted);
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
