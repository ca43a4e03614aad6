#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "core/files/file.h"
#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr size_t kColumns = 7;
constexpr const char* kNames[kColumns] = {"theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"};
constexpr const char* kHeader = "theta_i,phi_i,theta_o,phi_o,r,g,b";

// Where each of kNames is in the file.
std::array<size_t, kColumns> ColumnsOf(const TextLines& lines,
                                       const std::vector<std::string>& names) {
  std::array<size_t, kColumns> columns{};
  for (size_t k = 0; k < kColumns; ++k) {
    const auto found = std::ranges::find(names, kNames[k]);
    if (found == names.end()) {
      lines.Fail(std::string("the header has no column ") + kNames[k] + "; it must be " + kHeader +
                 ", in any order");
    }
    columns[k] = static_cast<size_t>(found - names.begin());
  }
  if (names.size() != kColumns) {
    lines.Fail("the header has " + std::to_string(names.size()) + " columns; it must be " +
               kHeader + ", in any order");
  }
  return columns;
}

// With phi_i = 0 and phi_o from 0 to 360 degrees.
SphericalAngles FromIncidentPlane(const HalfDiffAngles& angles) {
  SphericalAngles at = ToSphericalAngles(ToDirections(angles));
  at.phi_o -= at.phi_i;
  at.phi_i = 0;
  if (at.phi_o < 0) at.phi_o += 2 * kPi;
  return at;
}

// Samples as comma-separated values (docs/file-formats.md): a header row that names the columns
// theta_i, phi_i, theta_o, phi_o [degrees], r, g, b [1/sr] in any order, then a row a sample; from
// a # on a line is a comment. Throws Error, with line and column, on anything else.
Measurement ParseCsv(std::string_view text, const std::string& source) {
  TextLines lines(text, source);
  if (!lines.Next()) throw Error(source + ": no header row; it must be " + kHeader);
  std::vector<std::string> names;
  for (const std::string_view cell : SplitCells(lines.line())) names.emplace_back(cell);
  const auto at = ColumnsOf(lines, names);
  const AngleColumns angle_columns{at[0], at[1], at[2], at[3]};
  SampleCollector collector(source, "CSV file of scattered samples");
  std::vector<double> numbers;
  while (lines.Next()) {
    ReadNumbers(lines, SplitCells(lines.line()), names, &numbers);
    collector.Add(ReadAngles(lines, names, numbers, angle_columns, kPi / 180),
                  {numbers[at[4]], numbers[at[5]], numbers[at[6]]});
  }
  return collector.TakeByAzimuths();
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
        << kHeader << '\n';
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

// A header that names a column theta_i.
bool LooksLikeCsv(std::string_view text) {
  TextLines lines(text, "");
  if (!lines.Next()) return false;
  const auto cells = SplitCells(lines.line());
  return std::ranges::find(cells, "theta_i") != cells.end();
}

}  // namespace

MeasurementFormat CsvFormat() {
  return {.name = "csv",
          .description = "a .csv file of samples",
          .ending = ".csv",
          .is_text = true,
          .recognise = LooksLikeCsv,
          .read = ReadBy<ParseCsv>,
          .written_as = "CSV",
          .holds_anisotropic = true,
          .write = WriteCsv};
}

}  // namespace trilobe
