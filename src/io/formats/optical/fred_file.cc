#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr std::string_view kFredType = "bsdf_data";

struct FredOptions {
  double unit = kPi / 180;  // of angles [rad]
  double scale = 1;         // of values
};

// "format angles=deg bsdf=value scale=1".
FredOptions ReadFredFormat(const TextLines& lines) {
  FredOptions format;
  const auto words = SplitWords(lines.line());
  for (size_t k = 1; k < words.size(); ++k) {
    const size_t equals = std::min(words[k].find('='), words[k].size() - 1);
    const std::string key(words[k].substr(0, equals));
    const std::string_view value = words[k].substr(equals + 1);
    if (key == "angles" && (value == "deg" || value == "rad")) {
      format.unit = value == "deg" ? kPi / 180 : 1;
    } else if (key == "scale") {
      format.scale = ReadNumber(lines, k, key, value);
      if (!(format.scale > 0 && format.scale < 1e12)) {
        lines.FailAt(k, key, "expected a scale", ErrorKind::kRange);
      }
    } else if (key != "bsdf" || value != "value") {
      lines.FailAt(k, "format",
                   std::string("'")
                       .append(words[k].substr(0, 40))
                       .append("' cannot be read; only angles=deg, angles=rad, bsdf=value and "
                               "scale= can"));
    }
  }
  return format;
}

// A direction; theta < 0 is beyond the normal.
struct FredAngles {
  double theta, phi;  // [rad], theta >= 0
};
FredAngles ReadFredAngles(const TextLines& lines, const std::vector<double>& numbers,
                          const FredOptions& format) {
  const double theta = ReadAngle(lines, 0, "theta", numbers[0], format.unit, {-180, 180});
  const double phi = ReadAngle(lines, 1, "phi", numbers[1], format.unit, {-360, 360});
  return {std::abs(theta), theta < 0 ? phi + kPi : phi};
}

// A table of scattered light of Photon Engineering's FRED (docs/file-formats.md): the line `type
// bsdf_data`, a line `format`, then a line of two numbers per direction of incidence, theta and
// phi, each followed by lines of three, theta, phi and the BSDF [1/sr] of a direction. The mirror
// direction has the azimuth of the incidence, so that light comes from the azimuth opposite. Throws
// Error, with the line, on anything else.
Measurement ParseFred(std::string_view text, const std::string& source) {
  TextLines lines(text, source);
  SampleCollector collector(source, "FRED file of scattered samples");
  FredOptions format;
  std::optional<FredAngles> incidence;
  bool has_type = false;
  std::vector<double> numbers;
  while (lines.Next()) {
    const auto words = SplitWords(lines.line());
    if (words[0] == "type") {
      has_type = words.size() == 2 && words[1] == kFredType;
      if (!has_type) {
        lines.Fail("expected type " + std::string(kFredType), ErrorKind::kFormat, "type");
      }
      continue;
    }
    if (!has_type) {
      lines.Fail("expected type " + std::string(kFredType) + " before all else",
                 ErrorKind::kMissing, "type");
    }
    if (words[0] == "format") {
      format = ReadFredFormat(lines);
      continue;
    }
    if (words.size() != 2 && words.size() != 3) {
      lines.Fail("expected theta and phi of the incidence, or theta, phi and the BSDF",
                 ErrorKind::kFormat, "columns", std::to_string(words.size()));
    }
    ReadNumbers(lines, words,
                words.size() == 2 ? std::vector<std::string>{"theta", "phi"}
                                  : std::vector<std::string>{"theta", "phi", "BSDF"},
                &numbers);
    const FredAngles angles = ReadFredAngles(lines, numbers, format);
    if (words.size() == 2) {
      incidence = angles;
    } else if (!incidence) {
      lines.Fail("expected a line of theta and phi of the incidence before its values",
                 ErrorKind::kMissing, "incidence");
    } else {
      const double value = numbers[2] * format.scale;
      collector.Add({incidence->theta, incidence->phi + kPi, angles.theta, angles.phi},
                    {value, value, value});
    }
  }
  if (!incidence) {
    lines.Fail("the file ends before the first direction of incidence", ErrorKind::kMissing,
               "incidence");
  }
  return collector.TakeByAzimuths();
}

bool LooksLikeFred(std::string_view text) {
  TextLines lines(text, "");
  if (!lines.Next()) return false;
  const auto words = SplitWords(lines.line());
  return words.size() == 2 && words[0] == "type" && words[1] == kFredType;
}

}  // namespace

MeasurementFormat FredFormat() {
  return {.name = "fred",
          .description = "a FRED table",
          .ending = ".fred",
          .is_text = true,
          .recognise = LooksLikeFred,
          .read = ReadBy<ParseFred>};
}

}  // namespace trilobe
