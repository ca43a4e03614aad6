#include <array>
#include <charconv>
#include <optional>
#include <string>

#include "core/files/file.h"
#include "io/formats/table_columns.h"
#include "io/formats/table_reader.h"
#include "io/formats/text_table.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr size_t kColumns = 7;

// With phi_i = 0 and phi_o from 0 to 360 degrees.
SphericalAngles FromIncidentPlane(const HalfDiffAngles& angles) {
  SphericalAngles at = ToSphericalAngles(ToDirections(angles));
  at.phi_o -= at.phi_i;
  at.phi_i = 0;
  if (at.phi_o < 0) at.phi_o += 2 * kPi;
  return at;
}

// Writes the valid samples, as many digits as read back to the same numbers, row by row. Those of a
// table stand at the centres of its bins, with phi_i = 0. Throws Error where there is none.
std::string WriteCsv(const Measurement& measurement, const std::string& path, int /*num_threads*/) {
  const std::optional<BrdfSamples> of_table =
      measurement.table ? std::optional(SamplesOf(measurement)) : std::nullopt;
  const BrdfSamples& samples = of_table ? *of_table : measurement.samples;
  if (samples.size() == 0) SamplesOf(measurement);  // throws
  WriteFile(path, [&](std::ostream& out) {
    out << "# BRDF [1/sr] of " << samples.size() << " pairs of directions [degrees]\n"
        << kUsualColumns << '\n';
    std::array<char, kColumns * 32> row;  // the longest double has 24 characters
    for (int j = 0; j < samples.size(); ++j) {
      const SphericalAngles at =
          of_table ? FromIncidentPlane(samples.Angles(j)) : samples.directions[j];
      const double numbers[kColumns] = {RadiansToDegrees(at.theta_i),
                                        RadiansToDegrees(at.phi_i),
                                        RadiansToDegrees(at.theta_o),
                                        RadiansToDegrees(at.phi_o),
                                        samples.rho[j][0],
                                        samples.rho[j][1],
                                        samples.rho[j][2]};
      char* end = row.data();
      for (const double number : numbers) {
        end = std::to_chars(end, row.data() + row.size(), number).ptr;
        *end++ = ',';
      }
      end[-1] = '\n';
      out.write(row.data(), end - row.data());
    }
  });
  return std::to_string(samples.size()) + " samples";
}

// A header that names an angle and another column, within the first lines.
bool LooksLikeCsv(std::string_view text) {
  constexpr size_t kLongest = 1 << 16;
  return FindTableHead(text.substr(0, kLongest), "", /*theta_i_is_given=*/false).has_value();
}

}  // namespace

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
