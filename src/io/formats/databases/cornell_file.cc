#include <optional>
#include <span>
#include <sstream>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// The number of wavelengths, then as many, on one line or several.
std::vector<double> ReadWavelengths(TextLines* lines, const std::string& source) {
  constexpr double kMost = 10000;
  const auto number = [&](std::string_view word, size_t column, const char* name) {
    const std::optional<double> value = ToNumber(word);
    if (!value) lines->FailAt(column, name, "expected a number", ErrorKind::kFormat, word);
    return *value;
  };
  if (!lines->Next()) {
    throw ErrorIn(ErrorKind::kMissing, source, "no line; expected the number of wavelengths")
        .About("wavelengths");
  }
  const double count = number(lines->line(), 0, "number of wavelengths");
  if (!(count >= 1 && count <= kMost && count == static_cast<int>(count))) {
    lines->Fail("expected the number of wavelengths, from 1 to 10000", ErrorKind::kFormat,
                "wavelengths");
  }
  std::vector<double> wavelengths;
  while (wavelengths.size() < static_cast<size_t>(count)) {
    if (!lines->Next()) {
      throw ErrorIn(ErrorKind::kFormat, source,
                    "the file ends after " + std::to_string(wavelengths.size()) + " of " +
                        std::to_string(static_cast<int>(count)) + " wavelengths")
          .About("wavelengths", wavelengths.size());
    }
    const auto words = SplitWords(lines->line());
    for (size_t k = 0; k < words.size(); ++k) {
      wavelengths.push_back(number(words[k], k, "wavelength"));
    }
    if (wavelengths.size() > static_cast<size_t>(count)) {
      lines->Fail(
          "more wavelengths than the " + std::to_string(static_cast<int>(count)) + " announced",
          ErrorKind::kMismatch, "wavelengths", std::to_string(wavelengths.size()));
    }
  }
  return wavelengths;
}

// Spectra measured by the gonioreflectometer of Cornell's Program of Computer Graphics, as pbrt-v2
// has them (`.brdf`, docs/file-formats.md): the number of wavelengths, these [nm], then a line a
// sample with theta_i, phi_i, theta_o, phi_o [rad] and the BRDF [1/sr] at each wavelength. They
// become colours as SpectrumBands says. Throws Error, with line and column, on anything else.
Measurement ParseCornell(std::string_view text, const std::string& source,
                         const SourceOptions& options) {
  TextLines lines(text, source);
  const std::vector<double> wavelengths = ReadWavelengths(&lines, source);
  SpectrumBands bands(wavelengths, options.bands, source);
  std::vector<std::string> names = {"theta_i", "phi_i", "theta_o", "phi_o"};
  const size_t angles = names.size();
  for (const double wavelength : wavelengths) {
    std::ostringstream name;
    name << wavelength << " nm";
    names.push_back(name.str());
  }
  SampleCollector collector(source, "Cornell file of scattered spectra");
  std::vector<double> numbers;
  while (lines.Next()) {
    ReadNumbers(lines, SplitWords(lines.line()), names, &numbers);
    bands.Add(ReadAngles(lines, names, numbers, {}, 1), std::span(numbers).subspan(angles),
              &collector);
  }
  Measurement measurement = collector.Take();
  measurement.bands = bands.all();
  measurement.notes.push_back("read as: " + bands.Note());
  return measurement;
}

// The number of wavelengths alone on its line, then the first of them [nm].
bool LooksLikeCornell(std::string_view text) {
  TextLines lines(text, "");
  if (!lines.Next()) return false;
  const double count = ToNumber(lines.line()).value_or(0);
  if (!lines.Next()) return false;
  const double first = ToNumber(SplitWords(lines.line())[0]).value_or(0);
  return count >= 2 && count <= 10000 && first >= 200 && first <= 3000;
}

}  // namespace

MeasurementFormat CornellFormat() {
  return {.name = "cornell",
          .description = "a Cornell .brdf file of spectra",
          .ending = ".brdf",
          .is_text = true,
          .recognise = LooksLikeCornell,
          .read = ParseCornell};
}

}  // namespace trilobe
