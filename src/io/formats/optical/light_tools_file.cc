#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/spectrum.h"
#include "io/formats/spectrum_bands.h"
#include "io/formats/text/angle_list.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr AngleList kAzimuths = {"ScatterAzimuth", 0, 360}, kRadials = {"ScatterRadial", 0, 180};

struct LightToolsHeader {
  std::vector<double> azimuths, radials;  // [degrees]
  bool tristimulus = false;
};

// Header and values of a block.
struct LightToolsBlock {
  double incidence = 0, plane = 0;  // [degrees]
  bool is_front = true, is_reflection = true;
  double band = 0;  // a wavelength [nm], or 0, 1, 2 for X, Y, Z
  std::vector<double> values = {};
};

[[noreturn]] void FailAtLightToolsWord(const TextLines& lines, std::string_view key,
                                       std::string_view word, const char* known) {
  lines.Fail(std::string(key) + " is " + std::string(word.substr(0, 40)) + "; only " + known +
                 " can be read",
             ErrorKind::kUnsupported, key, word);
}

// Reads up to the line DataBegin.
LightToolsHeader ReadLightToolsHeader(TextLines* lines) {
  LightToolsHeader header;
  while (lines->Next()) {
    const auto words = SplitWords(lines->line());
    if (words[0] == "DataBegin") {
      for (const auto& [angles, list] :
           {std::pair(&header.azimuths, &kAzimuths), std::pair(&header.radials, &kRadials)}) {
        if (angles->empty()) {
          lines->Fail(std::string("the header has no ") + list->key, ErrorKind::kMissing,
                      list->key);
        }
      }
      return header;
    }
    if (words.size() != 2) {
      lines->Fail("expected a key and its value, or DataBegin", ErrorKind::kFormat, "DataBegin");
    }
    if (words[0] == kAzimuths.key) {
      header.azimuths = ReadAngleList(kAzimuths, words[1], lines);
    } else if (words[0] == kRadials.key) {
      header.radials = ReadAngleList(kRadials, words[1], lines);
    } else if (words[0] == "SpectralContent") {
      header.tristimulus = words[1] == "XYZ";
      if (!header.tristimulus && words[1] != "Monochrome") {
        FailAtLightToolsWord(*lines, words[0], words[1], "Monochrome and XYZ");
      }
    } else if (words[0] == "Symmetry") {
      if (words[1] != "Asymmetric") FailAtLightToolsWord(*lines, words[0], words[1], "Asymmetric");
    } else if (words[0] != "Source") {
      lines->Fail(std::string("'").append(words[0].substr(0, 40)) + "' is no key of this format",
                  ErrorKind::kUnknown, "header", words[0]);
    }
  }
  lines->Fail("the file ends before DataBegin", ErrorKind::kMissing, "DataBegin");
}

// Which of the two the word is: 0 or 1.
bool IsSecond(const TextLines& lines, std::string_view key, std::string_view word,
              const char* first, const char* second) {
  if (word != first && word != second) {
    FailAtLightToolsWord(lines, key, word, (std::string(first) + " and " + second).c_str());
  }
  return word == second;
}

// Sets what a key of a block and its value say.
void SetLightToolsKey(const TextLines& lines, size_t column, std::string_view key,
                      std::string_view word, LightToolsBlock* block) {
  const auto number = [&] { return ReadNumber(lines, column, std::string(key), word); };
  const auto angle = [&](double min_deg, double max_deg) {
    const double degrees = number();
    ReadAngle(lines, column, std::string(key), degrees, kPi / 180, {min_deg, max_deg});
    return degrees;
  };
  if (key == "AOI") {
    block->incidence = std::max(angle(0, 180), 0.0);
  } else if (key == "POI") {
    block->plane = angle(-360, 360);
  } else if (key == "Side") {
    block->is_front = !IsSecond(lines, key, word, "Front", "Back");
  } else if (key == "ScatterType") {
    block->is_reflection = !IsSecond(lines, key, word, "BRDF", "BTDF");
  } else if (key == "TristimulusValue") {
    if (word == "TrisX") {
      block->band = 0;
    } else {
      block->band = IsSecond(lines, key, word, "TrisY", "TrisZ") ? 2 : 1;
    }
  } else if (key == "Wavelength" || key == "TIS") {
    const double value = number();
    if (key == "Wavelength") block->band = value;
  } else {
    lines.Fail(std::string("'").append(key.substr(0, 40)) + "' is no key of a block of data",
               ErrorKind::kUnknown, "block", key);
  }
}

// The next block; none at DataEnd. TIS is its last key; then its values follow, an azimuth after
// the other.
std::optional<LightToolsBlock> ReadLightToolsBlock(const LightToolsHeader& header,
                                                   TextLines* lines) {
  LightToolsBlock block;
  const auto next = [&] {
    if (!lines->Next()) lines->Fail("the file ends before DataEnd", ErrorKind::kMissing, "DataEnd");
    return SplitWords(lines->line());
  };
  for (bool has_begun = false, is_whole = false; !is_whole; has_begun = true) {
    const auto words = next();
    if (!has_begun && words[0] == "DataEnd") return std::nullopt;
    if (words.size() % 2 != 0) {
      lines->Fail("expected keys and their values, as AOI 20", ErrorKind::kFormat, "block");
    }
    for (size_t k = 0; k < words.size(); k += 2) {
      SetLightToolsKey(*lines, k + 1, words[k], words[k + 1], &block);
      is_whole = is_whole || words[k] == "TIS";
    }
  }
  const size_t size = header.azimuths.size() * header.radials.size();
  while (block.values.size() < size) {
    const auto words = next();
    for (size_t k = 0; k < words.size(); ++k) {
      block.values.push_back(ReadNumber(*lines, k, "BRDF by ScatterRadial", words[k]));
    }
    if (block.values.size() > size) {
      lines->Fail("more values than the " + std::to_string(size) + " of a block",
                  ErrorKind::kMismatch, "block");
    }
  }
  return block;
}

// Values of front reflection by band, by plane and angle of incidence.
using Bands = std::map<double, std::vector<double>>;
using Incidences = std::map<std::pair<double, double>, Bands>;

struct LightToolsBlocks {
  Incidences read;
  int left_out = 0;  // of transmission or the back
};

LightToolsBlocks ReadLightToolsBlocks(const LightToolsHeader& header, TextLines* lines) {
  LightToolsBlocks blocks;
  while (std::optional<LightToolsBlock> block = ReadLightToolsBlock(header, lines)) {
    if (!block->is_front || !block->is_reflection) {
      ++blocks.left_out;
      continue;
    }
    if (!std::isfinite(block->band)) {
      lines->Fail("expected a wavelength in nm", ErrorKind::kRange, "Wavelength",
                  FactText(block->band));
    }
    Bands& bands = blocks.read[{block->plane, block->incidence}];
    if (!bands.emplace(block->band, std::move(block->values)).second) {
      lines->Fail("this block is there twice, with the same AOI, POI and wavelength",
                  ErrorKind::kConflict, "block");
    }
  }
  return blocks;
}

// The bands that all incidences have.
std::vector<double> BandsOf(const LightToolsBlocks& blocks, bool tristimulus,
                            const std::string& source) {
  if (blocks.read.empty()) {
    throw ErrorIn(ErrorKind::kUnsupported, source,
                  "it has no block of front reflection (Side Front, ScatterType BRDF); " +
                      std::to_string(blocks.left_out) + " are of transmission or the back")
        .About("blocks");
  }
  std::vector<double> bands;
  for (const auto& [band, values] : blocks.read.begin()->second) bands.push_back(band);
  const auto same = [&](const Bands& others) {
    return std::ranges::equal(bands, others, {}, {}, [](const auto& one) { return one.first; });
  };
  for (const auto& [incidence, others] : blocks.read) {
    if (!same(others) || (tristimulus && bands != std::vector<double>{0, 1, 2})) {
      std::ostringstream message;
      message << source << ": the block of AOI " << incidence.second << " and POI "
              << incidence.first << " has "
              << (tristimulus ? "not each of TrisX, TrisY and TrisZ"
                              : "other wavelengths than the first");
      throw Error(ErrorKind::kMismatch, message.str()).At(source).About("blocks", incidence.second);
    }
  }
  return bands;
}

// A BRDF in the text format of LightTools (`.bsdf`, docs/file-formats.md), as libbsdf reads it: the
// blocks of front reflection, by plane (POI) and angle (AOI) of incidence, azimuth and angle from
// the normal [degrees]. Light comes from the azimuth 90 degrees + POI. A block per wavelength makes
// spectra. Azimuths matter where there are several planes. Throws Error, with the line, on anything
// else.
Measurement ParseLightTools(std::string_view text, const std::string& source,
                            const SourceOptions& options) {
  TextLines lines(text, source);
  const LightToolsHeader header = ReadLightToolsHeader(&lines);
  const LightToolsBlocks blocks = ReadLightToolsBlocks(header, &lines);
  const std::vector<double> bands = BandsOf(blocks, header.tristimulus, source);
  std::optional<SpectrumBands> spectra;
  if (!header.tristimulus) spectra.emplace(bands, options.bands, source);
  SampleCollector collector(source, "LightTools BSDF file of scattered samples");
  std::vector<double> values;
  for (const auto& [incidence, by_band] : blocks.read) {
    size_t k = 0;
    for (size_t a = 0; a < header.azimuths.size(); ++a) {
      for (const double radial : header.radials) {
        values.clear();
        for (const auto& [band, of_band] : by_band) values.push_back(of_band[k]);
        ++k;
        if (a >= Distinct(header.azimuths) || (radial == 0 && a > 0)) continue;  // there twice
        const SphericalAngles at = {DegreesToRadians(incidence.second),
                                    DegreesToRadians(90 + incidence.first),
                                    DegreesToRadians(radial), DegreesToRadians(header.azimuths[a])};
        if (header.tristimulus) {
          AddTristimulus(at, {values[0], values[1], values[2]}, &collector);
        } else {
          spectra->Add(at, values, &collector);
        }
      }
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = blocks.read.begin()->first.first != blocks.read.rbegin()->first.first;
  if (spectra) measurement.bands = spectra->all();
  std::ostringstream note;
  note << "read as: front reflection";
  if (header.tristimulus) note << ", " << kTristimulusNote;
  if (spectra && bands[0] > 0) note << ", " << spectra->Note();
  if (blocks.left_out > 0) {
    note << "; " << blocks.left_out << " blocks of transmission or the back are left out";
  }
  measurement.notes.push_back(note.str());
  return measurement;
}

// A header as Zemax has it, with a symmetry that Zemax has not, or blocks that begin with AOI.
bool LooksLikeLightTools(std::string_view text) {
  constexpr size_t kLongestHeader = 1 << 16;
  TextLines lines(text.substr(0, kLongestHeader), "");
  for (bool first = true; lines.Next(); first = false) {
    const auto words = SplitWords(lines.line());
    if (first && words[0] != "Source" && words[0] != "Symmetry") return false;
    if (words[0] == "Symmetry" && words.size() == 2 && words[1] == "Asymmetric") return true;
    if (words[0] == "AOI") return true;
    if (words[0] == "TIS") return false;
  }
  return false;
}

}  // namespace

MeasurementFormat LightToolsFormat() {
  return {.name = "lighttools",
          .description = "a LightTools .bsdf file",
          .ending = ".bsdf",
          .is_text = true,
          .recognise = LooksLikeLightTools,
          .read = ParseLightTools};
}

}  // namespace trilobe
