#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/optical/zemax_angles.h"
#include "io/formats/spectrum.h"
#include "io/formats/text/angle_list.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

enum List { kRotation, kIncidence, kAzimuth, kRadial, kLists };

constexpr AngleList kListSpecs[kLists] = {{"SampleRotation", 0, 360},
                                          {"AngleOfIncidence", 0, 90},
                                          {"ScatterAzimuth", 0, 360},
                                          {"ScatterRadial", 0, 180}};

// Keys with one word, and which words can be read.
const std::map<std::string_view, std::vector<std::string_view>>& Words() {
  static const std::map<std::string_view, std::vector<std::string_view>> words = {
      {"Source", {"Measured"}},
      {"Symmetry",
       {"PlaneSymmetrical", "Asymmetrical", "ASymmetrical", "Asymmetrical4D", "ASymmetrical4D"}},
      {"SpectralContent", {"Monochrome", "XYZ", "RGB"}},
      {"ScatterType", {"BRDF"}}};
  return words;
}

// Names of the lines with which the blocks of data begin.
std::vector<std::string_view> BlocksOf(std::string_view content) {
  if (content == "XYZ") return {"TristimulusX", "TristimulusY", "TristimulusZ"};
  if (content == "RGB") return {"TristimulusR", "TristimulusG", "TristimulusB"};
  return {"Monochrome"};
}

bool NamesABlock(std::string_view word) {
  return word == "Monochrome" || word.starts_with("Tristimulus");
}

struct ZemaxHeader {
  std::array<std::vector<double>, kLists> angles;  // [degrees]
  std::string content;                             // the word after SpectralContent
  std::string first;  // the name of the first block of data; "": it has none
};

[[noreturn]] void FailAtZemaxWord(const TextLines& lines, std::string_view key,
                                  const std::vector<std::string_view>& known,
                                  std::string_view word) {
  if (word == "BTDF") {
    lines.Fail("ScatterType is BTDF: these are transmitted light; only reflection can be read",
               ErrorKind::kUnsupported, key, word);
  }
  std::string expected;
  for (const std::string_view one : known) {
    expected.append(expected.empty() ? "" : one == known.back() ? " and " : ", ").append(one);
  }
  lines.Fail(std::string(key) + " is " + std::string(word.substr(0, 40)) + "; only " + expected +
             " can be read");
}

void CheckIsWhole(const std::map<std::string_view, bool>& seen, const TextLines& lines) {
  for (const AngleList& list : kListSpecs) {
    if (!seen.contains(list.key)) {
      lines.Fail(std::string("the header has no ") + list.key, ErrorKind::kMissing, list.key);
    }
  }
  for (const auto& [key, values] : Words()) {
    if (key != "Source" && !seen.contains(key)) {
      lines.Fail("the header has no " + std::string(key), ErrorKind::kMissing, key);
    }
  }
}

// Reads up to the line DataBegin.
ZemaxHeader ReadZemaxHeader(TextLines* lines) {
  ZemaxHeader header;
  std::map<std::string_view, bool> seen;
  while (lines->Next()) {
    const auto words = SplitWords(lines->line());
    if (words[0] == "DataBegin") {
      CheckIsWhole(seen, *lines);
      return header;
    }
    if (words.size() == 1 && NamesABlock(words[0])) {
      header.first = words[0];
      continue;
    }
    if (words.size() != 2) {
      lines->Fail("expected a key and its value, or DataBegin", ErrorKind::kFormat, "DataBegin");
    }
    const auto list = std::ranges::find_if(
        kListSpecs, [&](const AngleList& spec) { return words[0] == spec.key; });
    const auto word = Words().find(words[0]);
    if (list != std::end(kListSpecs)) {
      seen[list->key] = true;
      header.angles[list - kListSpecs] = ReadAngleList(*list, words[1], lines);
    } else if (word != Words().end()) {
      seen[word->first] = true;
      const auto& [key, known] = *word;
      if (std::ranges::find(known, words[1]) == known.end()) {
        FailAtZemaxWord(*lines, key, known, words[1]);
      }
      if (key == "SpectralContent") header.content = words[1];
    } else {
      lines->Fail(std::string("'").append(words[0].substr(0, 40)) + "' is no key of this format",
                  ErrorKind::kUnknown, "header", words[0]);
    }
  }
  lines->Fail("the file ends before DataBegin", ErrorKind::kMissing, "DataBegin");
}

void GoTo(const char* what, TextLines* lines) {
  if (!lines->Next()) {
    lines->Fail(std::string("the file ends before ") + what, ErrorKind::kMissing, what);
  }
}

// The values of a block, by rotation, incidence, azimuth and distance, after DataBegin.
std::vector<double> ReadZemaxBlock(const ZemaxHeader& header, TextLines* lines) {
  const auto& [rotations, incidences, azimuths, radials] = header.angles;
  std::vector<double> values;
  for (size_t k = 0; k < rotations.size() * incidences.size(); ++k) {
    GoTo("TIS", lines);
    if (SplitWords(lines->line())[0] != "TIS") {
      lines->Fail("expected TIS, at the beginning of an angle of incidence", ErrorKind::kFormat,
                  "TIS");
    }
    for (size_t a = 0; a < azimuths.size(); ++a) {
      GoTo("the last azimuth", lines);
      const std::vector<double> row =
          ReadNumbersOfLine(*lines, radials.size(), "BRDF by ScatterRadial");
      values.insert(values.end(), row.begin(), row.end());
    }
  }
  GoTo("DataEnd", lines);
  if (lines->line() != "DataEnd") {
    lines->Fail("expected DataEnd: there are more data than angles", ErrorKind::kMismatch,
                "DataEnd");
  }
  return values;
}

// One block, or three, in the order that SpectralContent says.
std::vector<std::vector<double>> ReadZemaxBlocks(const ZemaxHeader& header, TextLines* lines) {
  const std::vector<std::string_view> names = BlocksOf(header.content);
  if (names.size() > 1 && header.first != names[0]) {
    lines->Fail("expected the line " + std::string(names[0]) + " before DataBegin",
                ErrorKind::kMissing, names[0]);
  }
  std::vector<std::vector<double>> blocks = {ReadZemaxBlock(header, lines)};
  while (blocks.size() < names.size()) {
    const std::string name(names[blocks.size()]);
    GoTo(name.c_str(), lines);
    if (lines->line() != name) lines->Fail("expected " + name, ErrorKind::kFormat, name);
    GoTo("DataBegin", lines);
    if (lines->line() != "DataBegin") {
      lines->Fail("expected DataBegin", ErrorKind::kFormat, "DataBegin");
    }
    blocks.push_back(ReadZemaxBlock(header, lines));
  }
  return blocks;
}

// A BRDF in the tabular text format of Zemax OpticStudio (`.bsdf`, docs/file-formats.md), by sample
// rotation, angle of incidence, and azimuth and distance about the direction of mirror reflection
// [degrees]; a block of one channel, which counts for all three, or three blocks. A value of
// exactly 0 is a gap. Azimuths matter where there are several sample rotations. Throws Error, with
// the line, on anything else.
Measurement ParseZemax(std::string_view text, const std::string& source) {
  TextLines lines(text, source);
  const ZemaxHeader header = ReadZemaxHeader(&lines);
  const std::vector<std::vector<double>> blocks = ReadZemaxBlocks(header, &lines);
  const auto& [rotations, incidences, azimuths, radials] = header.angles;
  SampleCollector collector(source, "Zemax BSDF file of scattered samples");
  size_t next = 0;
  const auto add = [&](double rotation, double incidence, double azimuth, double radial) {
    const size_t k = next++;
    const auto value = [&](size_t c) { return blocks[blocks.size() == 1 ? 0 : c][k]; };
    const Rgb values = {value(0), value(1), value(2)};
    const SphericalAngles at =
        ToSphericalAngles(ZemaxAngles{DegreesToRadians(rotation), DegreesToRadians(incidence),
                                      DegreesToRadians(azimuth), DegreesToRadians(radial)});
    if (values == Rgb{} && std::max(at.theta_i, at.theta_o) < kPi / 2) {
      collector.LeaveOut(&BinCounts::missing);
    } else if (header.content == "XYZ") {
      AddTristimulus(at, values, &collector);
    } else {
      collector.Add(at, values);
    }
  };
  for (size_t r = 0; r < Distinct(rotations); ++r) {
    for (const double incidence : incidences) {
      for (size_t a = 0; a < azimuths.size(); ++a) {
        for (const double radial : radials) {
          if (a >= Distinct(azimuths) || (radial == 0 && a > 0)) {
            ++next;  // it is there twice
          } else {
            add(rotations[r], incidence, azimuths[a], radial);
          }
        }
      }
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = Distinct(rotations) > 1;
  if (header.content == "XYZ") {
    measurement.notes.emplace_back(std::string("read as: ").append(kTristimulusNote));
  }
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
