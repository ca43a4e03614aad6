#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/spectrum.h"
#include "io/formats/text/same_name.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

// Header of a value: the comments before it.
struct PabHeader {
  std::optional<double> theta, phi;  // of the incidence [degrees]
  bool is_known = false;             // whether there was a line `format`
  bool has_cosine = false;           // values are BSDF times cos theta_o
  bool is_xyz = false;
};

// A line that begins with #. Most keys say nothing about values.
void ReadPabComment(const TextLines& lines, PabHeader* header) {
  const auto words = SplitWords(lines.line().substr(1));
  const auto number = [&](size_t k) { return ReadNumber(lines, k, "an angle", words[k]); };
  if (words.empty()) return;
  if (words[0] == "intheta" && words.size() > 1) header->theta = number(1);
  if (words[0] == "inphi" && words.size() > 1) header->phi = number(1);
  if (words[0] == "incident_angle" && words.size() > 2) {
    header->theta = number(1);
    header->phi = number(2);
  }
  if (words[0] == "colorimetry:" && words.size() > 1) {
    header->is_xyz = SameName(words[1], "CIE-XYZ");
    if (!header->is_xyz && !SameName(words[1], "CIE-Y")) {
      lines.Fail("the colorimetry is unknown; only CIE-Y and CIE-XYZ can be read",
                 ErrorKind::kUnknown, "colorimetry", words[1]);
    }
  }
  if (words[0] == "format:" && words.size() == 4) {
    const auto is = [&](const char* name) { return SameName(words[3], name); };
    if (words[1] != "theta" || words[2] != "phi" ||
        !(is("DSF") || is("BSDF") || is("BRDF") || is("BTDF"))) {
      lines.Fail("the format is unknown; only theta phi BSDF, BRDF and DSF can be read",
                 ErrorKind::kUnknown, "format", words[3]);
    }
    if (is("BTDF")) {
      lines.Fail("these are transmitted light; only reflection can be read",
                 ErrorKind::kUnsupported, "format", words[3]);
    }
    header->is_known = true;
    header->has_cosine = is("DSF");
  }
}

// Values of a sample's back are those of a front: theta is from the normal on the side of the
// light.
void AddPabSample(const TextLines& lines, const PabHeader& header, SampleCollector* collector) {
  if (!header.is_known) {
    lines.Fail("expected a line '#format: theta phi BRDF' before the values", ErrorKind::kMissing,
               "format");
  }
  if (!header.theta || !header.phi) {
    lines.Fail("expected lines '#intheta' and '#inphi' before the values", ErrorKind::kMissing,
               "intheta, inphi");
  }
  std::vector<double> numbers;
  ReadNumbers(lines, SplitWords(lines.line()),
              header.is_xyz ? std::vector<std::string>{"theta", "phi", "X", "Y", "Z"}
                            : std::vector<std::string>{"theta", "phi", "value"},
              &numbers);
  const auto angle = [&](const char* name, double degrees, double least, double most) {
    return ReadAngle(lines, 0, name, degrees, kPi / 180, {least, most});
  };
  SphericalAngles at = {angle("intheta", *header.theta, 0, 180),
                        angle("inphi", *header.phi, -360, 720), angle("theta", numbers[0], 0, 180),
                        angle("phi", numbers[1], -360, 720)};
  if (at.theta_i > kPi / 2) {
    at.theta_i = kPi - at.theta_i;
    at.theta_o = kPi - at.theta_o;
  }
  const double factor = header.has_cosine ? 1 / std::cos(at.theta_o) : 1;
  for (size_t k = 2; k < numbers.size(); ++k) numbers[k] *= factor;
  if (header.is_xyz) {
    AddTristimulus(at, {numbers[2], numbers[3], numbers[4]}, collector);
  } else {
    collector->Add(at, {numbers[2], numbers[2], numbers[2]});
  }
}

// A measurement of pab's gonio-photometers (docs/file-formats.md): comments that name the
// incidence and what values are, then a line of theta, phi and values per direction. Files of
// several incidences may stand one after the other. Throws Error, with the line, on anything else.
Measurement ParsePab(std::string_view text, const std::string& source) {
  TextLines lines(text, source);
  SampleCollector collector(source, "pab gonio-photometer file of scattered samples");
  PabHeader header;
  while (lines.NextWithComment()) {
    if (lines.line().starts_with('#')) {
      ReadPabComment(lines, &header);
    } else {
      AddPabSample(lines, header, &collector);
    }
  }
  Measurement measurement = collector.TakeByAzimuths();
  if (header.is_xyz) {
    measurement.notes.emplace_back(std::string("read as: ").append(kTristimulusNote));
  }
  return measurement;
}

// A key of the incidence or of the format among the comments before the first value.
bool LooksLikePab(std::string_view text) {
  TextLines lines(text, "");
  while (lines.NextWithComment() && lines.line().starts_with('#')) {
    const auto words = SplitWords(lines.line().substr(1));
    if (words.size() < 2) continue;
    for (const std::string_view key : {"intheta", "inphi", "incident_angle"}) {
      if (words[0] == key && ToNumber(words[1])) return true;
    }
    if (words[0] == "format:" && words[1] == "theta") return true;
  }
  return false;
}

}  // namespace

MeasurementFormat PabFormat() {
  return {.name = "pab",
          .description = "a .dat file of pab's gonio-photometers",
          .ending = ".pab",
          .is_text = true,
          .recognise = LooksLikePab,
          .read = ReadBy<ParsePab>};
}

}  // namespace trilobe
