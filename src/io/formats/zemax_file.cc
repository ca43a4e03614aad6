#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

enum List { kRotation, kIncidence, kAzimuth, kRadial, kLists };

struct ListSpec {
  const char* key;
  double min_deg, max_deg;
};
constexpr ListSpec kListSpecs[kLists] = {{"SampleRotation", 0, 360},
                                         {"AngleOfIncidence", 0, 90},
                                         {"ScatterAzimuth", 0, 360},
                                         {"ScatterRadial", 0, 180}};

// Keys with one word, and which words can be read.
const std::map<std::string_view, std::vector<std::string_view>>& Words() {
  static const std::map<std::string_view, std::vector<std::string_view>> words = {
      {"Source", {"Measured"}},
      {"Symmetry",
       {"PlaneSymmetrical", "Asymmetrical", "ASymmetrical", "Asymmetrical4D", "ASymmetrical4D"}},
      {"SpectralContent", {"Monochrome"}},
      {"ScatterType", {"BRDF"}}};
  return words;
}

// What to do about a word that cannot be read.
std::string AdviceFor(std::string_view word) {
  if (word == "XYZ" || word == "RGB") return "; export one channel as Monochrome, or all as CSV";
  if (word == "Asymmetric") return ", and this is a file of LightTools; save it as CSV";
  return "";
}

using Header = std::array<std::vector<double>, kLists>;  // [degrees]

std::vector<double> ReadNumbersOfLine(const TextLines& lines, size_t count, const char* what) {
  const std::vector<std::string> names(count, what);
  std::vector<double> numbers;
  ReadNumbers(lines, SplitWords(lines.line()), names, &numbers);
  return numbers;
}

// Angles that ascend, on the line after the one that gives their number.
std::vector<double> ReadList(const ListSpec& spec, std::string_view count_text, TextLines* lines) {
  const auto count = ToNumber(count_text);
  constexpr double kMost = 10000;
  if (!count || !(*count >= 1 && *count <= kMost) || *count != std::floor(*count)) {
    lines->Fail(std::string("expected the number of angles after ") + spec.key);
  }
  if (!lines->Next()) lines->Fail(std::string("the angles of ") + spec.key + " are missing");
  std::vector<double> angles = ReadNumbersOfLine(*lines, static_cast<size_t>(*count), spec.key);
  for (size_t k = 0; k < angles.size(); ++k) {
    std::ostringstream problem;
    if (!(angles[k] >= spec.min_deg && angles[k] <= spec.max_deg)) {
      problem << angles[k] << " is no such angle; expected degrees from " << spec.min_deg << " to "
              << spec.max_deg;
    } else if (k > 0 && !(angles[k] > angles[k - 1])) {
      problem << angles[k] << " must be above the angle before it, " << angles[k - 1];
    } else {
      continue;
    }
    lines->FailAt(k, spec.key, problem.str());
  }
  return angles;
}

// Up to the line DataBegin.
Header ReadHeader(TextLines* lines) {
  Header header;
  std::map<std::string_view, bool> seen;
  while (lines->Next()) {
    const auto words = SplitWords(lines->line());
    if (words[0] == "DataBegin") {
      for (const ListSpec& spec : kListSpecs) {
        if (!seen[spec.key]) lines->Fail(std::string("the header has no ") + spec.key);
      }
      for (const auto& [key, values] : Words()) {
        if (key != "Source" && !seen[key]) lines->Fail("the header has no " + std::string(key));
      }
      return header;
    }
    if (words.size() == 1 && words[0] == "Monochrome") continue;  // names the block of data
    if (words.size() != 2) lines->Fail("expected a key and its value, or DataBegin");
    const auto list = std::ranges::find_if(
        kListSpecs, [&](const ListSpec& spec) { return words[0] == spec.key; });
    const auto word = Words().find(words[0]);
    if (list != std::end(kListSpecs)) {
      seen[list->key] = true;
      header[list - kListSpecs] = ReadList(*list, words[1], lines);
    } else if (word != Words().end()) {
      seen[word->first] = true;
      if (std::ranges::find(word->second, words[1]) == word->second.end()) {
        lines->Fail(std::string(words[0]) + " is " + std::string(words[1].substr(0, 40)) +
                    "; only " + std::string(word->second.front()) + " can be read" +
                    AdviceFor(words[1]));
      }
    } else {
      lines->Fail("'" + std::string(words[0].substr(0, 40)) + "' is no key of this format");
    }
  }
  lines->Fail("the file ends before DataBegin");
}

// The light comes from theta = `incidence`, phi = 180 degrees - `rotation`. Seen from the mirror
// direction, azimuth 0 is towards the normal, and azimuths run counterclockwise about that
// direction as it leaves the sample. All in radians.
SphericalAngles AnglesOf(double rotation, double incidence, double azimuth, double radial) {
  const double s = std::sin(incidence), c = std::cos(incidence);
  // In the frame in which the mirror direction is (s, 0, c): towards the normal (-c, 0, s), and
  // across (0, -1, 0).
  const double along = std::sin(radial) * std::cos(azimuth);
  const double across = std::sin(radial) * std::sin(azimuth);
  const double x = std::cos(radial) * s - along * c;
  const double y = -across;
  const double z = std::cos(radial) * c + along * s;
  const auto turned = [](double phi) {
    const double turns = phi / (2 * kPi);
    return 2 * kPi * (turns - std::floor(turns));
  };
  return {incidence, turned(kPi - rotation), std::atan2(std::hypot(x, y), z),
          turned(std::atan2(y, x) - rotation)};
}

// How many entries there are without a last one that repeats the first a whole turn later.
size_t Distinct(const std::vector<double>& degrees) {
  return degrees.size() - (degrees.size() > 1 && degrees.back() - degrees.front() == 360 ? 1 : 0);
}

// A BRDF in the tabular text format of Zemax OpticStudio (`.bsdf`, docs/file-formats.md), by sample
// rotation, angle of incidence, and azimuth and distance about the direction of mirror reflection
// [degrees]; one channel, which counts for all three. A value of exactly 0 is a gap. Azimuths
// matter where there are several sample rotations. Throws Error, with the line, on anything else.
Measurement ParseZemax(std::string_view text, const std::string& source) {
  TextLines lines(text, source);
  const Header header = ReadHeader(&lines);
  const auto& [rotations, incidences, azimuths, radials] = header;
  const auto next = [&](const char* what) {
    if (!lines.Next()) lines.Fail(std::string("the file ends before ") + what);
  };
  SampleCollector collector(source, "Zemax BSDF file of scattered samples");
  for (size_t r = 0; r < rotations.size(); ++r) {
    for (const double incidence : incidences) {
      next("TIS");
      if (SplitWords(lines.line())[0] != "TIS") {
        lines.Fail("expected TIS, at the beginning of an angle of incidence");
      }
      for (size_t a = 0; a < azimuths.size(); ++a) {
        next("the last azimuth");
        const std::vector<double> values =
            ReadNumbersOfLine(lines, radials.size(), "BRDF by ScatterRadial");
        if (r >= Distinct(rotations) || a >= Distinct(azimuths)) continue;
        for (size_t k = 0; k < radials.size(); ++k) {
          if (radials[k] == 0 && a > 0) continue;  // the mirror direction, again
          const SphericalAngles at =
              AnglesOf(DegreesToRadians(rotations[r]), DegreesToRadians(incidence),
                       DegreesToRadians(azimuths[a]), DegreesToRadians(radials[k]));
          if (values[k] == 0 && std::max(at.theta_i, at.theta_o) < kPi / 2) {
            collector.LeaveOut(&BinCounts::missing);
          } else {
            collector.Add(at, {values[k], values[k], values[k]});
          }
        }
      }
    }
  }
  next("DataEnd");
  if (lines.line() != "DataEnd") lines.Fail("expected DataEnd: there are more data than angles");
  Measurement measurement = collector.Take();
  measurement.anisotropic = Distinct(rotations) > 1;
  return measurement;
}

// The first of the keys, with the only value that it has.
bool LooksLikeZemax(std::string_view text) {
  TextLines lines(text, "");
  if (!lines.Next()) return false;
  const auto words = SplitWords(lines.line());
  return words.size() == 2 && words[0] == "Source" && words[1] == "Measured";
}

}  // namespace

MeasurementFormat ZemaxFormat() {
  return {.name = "zemax",
          .description = "a Zemax .bsdf file",
          .ending = ".bsdf",
          .is_text = true,
          .recognise = LooksLikeZemax,
          .read = ReadBy<ParseZemax>};
}

}  // namespace trilobe
