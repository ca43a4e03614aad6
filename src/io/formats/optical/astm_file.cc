#include <algorithm>
#include <optional>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// Meaning and position of the values of a line.
struct Columns {
  std::vector<std::string> names;
  AngleColumns angles;
  std::vector<size_t> values;            // one, R, G, B, or a spectrum
  std::vector<double> wavelengths = {};  // [nm] of a spectrum
};

struct Header {
  Columns columns;
  std::string points;  // how many lines follow, where it says so
};

constexpr const char* kExpected =
    "expected theta_i,phi_i,theta_s,phi_s and R,G,B, or wavelengths as 400nm, or one value";

// 400 for "400nm".
std::optional<double> WavelengthOf(std::string_view name) {
  if (!name.ends_with("nm")) return std::nullopt;
  name.remove_suffix(2);
  return ToNumber(name);
}

Columns ReadVars(const TextLines& lines, std::string_view vars) {
  Columns columns;
  for (const std::string_view cell : SplitCells(vars)) columns.names.emplace_back(cell);
  const std::vector<std::string>& names = columns.names;
  std::vector<bool> is_angle(names.size());
  const auto find = [&](const char* name) {
    const auto found = static_cast<size_t>(std::ranges::find(names, name) - names.begin());
    if (found == names.size()) {
      lines.Fail(std::string("VARS has no ") + name + "; " + kExpected, ErrorKind::kMissing, name);
    }
    is_angle[found] = true;
    return found;
  };
  columns.angles = {find("theta_i"), find("phi_i"), find("theta_s"), find("phi_s")};
  for (size_t k = 0; k < names.size(); ++k) {
    if (is_angle[k]) continue;
    columns.values.push_back(k);
    if (const auto wavelength = WavelengthOf(names[k])) columns.wavelengths.push_back(*wavelength);
  }
  const size_t n = columns.values.size();
  if (n == 1) return columns;
  if (columns.wavelengths.empty() && n == kChannels) {
    const char* const channels[kChannels] = {"R", "G", "B"};
    for (int c = 0; c < kChannels; ++c) columns.values[c] = find(channels[c]);
  } else if (n == 0 || columns.wavelengths.size() != n) {
    lines.Fail("VARS names " + std::to_string(n) + " values that are no colour; " + kExpected,
               ErrorKind::kUnknown, "VARS", std::to_string(n));
  }
  return columns;
}

Header ReadHeader(TextLines* lines, const std::string& source) {
  Header header;
  while (lines->Next()) {
    const std::string_view line = lines->line();
    const size_t end = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view key = line.substr(0, end), value = line.substr(end);
    if (key == "NUM_POINTS") {
      const auto words = SplitWords(value);
      if (words.size() != 1 || !ToNumber(words[0])) {
        lines->Fail("expected one number after NUM_POINTS", ErrorKind::kFormat, "NUM_POINTS");
      }
      header.points = words[0];
    } else if (key == "VARS") {
      header.columns = ReadVars(*lines, value);
      return header;
    }
  }
  throw ErrorIn(ErrorKind::kMissing, source,
                std::string("no line VARS, which names the columns; ") + kExpected)
      .About("VARS");
}

// Angle-resolved scatter in the text format of ASTM E1392-96, as Cornell published measurements in
// it and as libbsdf reads it (`.astm`, docs/file-formats.md): a header line a key, of which
// NUM_POINTS and VARS are read; VARS is the last and names the columns of the lines that follow,
// theta_i, phi_i, theta_s, phi_s [rad], and values [1/sr]: R, G, B, or a spectrum (`400nm`, ...,
// which becomes a colour as SpectrumBands says), or one value, which is taken for all channels.
// Throws Error, with line and column, on anything else.
Measurement ParseAstm(std::string_view text, const std::string& source,
                      const SourceOptions& options) {
  TextLines lines(text, source);
  const auto [columns, points] = ReadHeader(&lines, source);
  std::optional<SpectrumBands> bands;
  if (!columns.wavelengths.empty()) bands.emplace(columns.wavelengths, options.bands, source);
  SampleCollector collector(source, "ASTM E1392 file of scattered samples");
  std::vector<double> numbers, values;
  int read = 0;
  while (lines.Next()) {
    ReadNumbers(lines, SplitCells(lines.line()), columns.names, &numbers);
    const SphericalAngles angles = ReadAngles(lines, columns.names, numbers, columns.angles, 1);
    values.clear();
    for (const size_t k : columns.values) values.push_back(numbers[k]);
    if (bands) {
      bands->Add(angles, values, &collector);
    } else {
      const bool grey = values.size() == 1;
      collector.Add(angles, {values[0], values[grey ? 0 : 1], values[grey ? 0 : 2]});
    }
    ++read;
  }
  if (!points.empty() && *ToNumber(points) != read) {
    throw ErrorIn(ErrorKind::kMismatch, source,
                  std::to_string(read) + " lines of data, and NUM_POINTS announces " + points +
                      "; get the file once more")
        .About("NUM_POINTS", points);
  }
  Measurement measurement = collector.TakeByAzimuths();
  if (!bands) return measurement;
  measurement.bands = bands->all();
  measurement.notes.push_back("read as: " + bands->Note());
  return measurement;
}

// A header of keys, of which VARS is the last.
bool LooksLikeAstm(std::string_view text) {
  constexpr size_t kLongestHeader = 1 << 16;
  TextLines lines(text.substr(0, kLongestHeader), "");
  while (lines.Next()) {
    if (lines.line().starts_with("VARS ") || lines.line().starts_with("VARS\t")) return true;
  }
  return false;
}

}  // namespace

MeasurementFormat AstmFormat() {
  return {.name = "astm",
          .description = "an ASTM E1392 .astm file",
          .ending = ".astm",
          .is_text = true,
          .recognise = LooksLikeAstm,
          .read = ParseAstm};
}

}  // namespace trilobe
