#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/files/little_endian.h"
#include "core/files/text_lines.h"
#include "io/formats/optical/zemax_angles.h"
#include "io/formats/spectrum.h"
#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr size_t kSsddAngles = 4;
constexpr double kMostSsddColors = 1e8;  // colours of a block

using SsddAngles = std::array<double, kSsddAngles>;  // [rad]

SphericalAngles FromSpherical(const SsddAngles& at) { return {at[0], at[1], at[2], at[3]}; }

// An angle from the mirror direction and an azimuth about it, as Zemax's.
SphericalAngles FromSpecular(const SsddAngles& at) {
  return ToSphericalAngles(
      ZemaxAngles{.rotation = kPi - at[1], .incidence = at[0], .azimuth = at[3], .radial = at[2]});
}

SphericalAngles FromHalfDifference(const SsddAngles& at) {
  SphericalAngles angles = ToSphericalAngles(
      ToDirections(HalfDiffAngles{.theta_h = at[0], .theta_d = at[2], .phi_d = at[3]}));
  angles.phi_i += at[1];
  angles.phi_o += at[1];
  return angles;
}

struct SsddParameters {
  std::string_view name;
  SphericalAngles (*angles)(const SsddAngles& at);
};
constexpr SsddParameters kSsddParameters[] = {
    {"spherical_coordinate_system", FromSpherical},
    {"specular_coordinate_system", FromSpecular},
    {"half_difference_coordinate_system", FromHalfDifference}};

// The keys before the data of a block.
struct SsddBlock {
  std::string data_type, color_model;
  const SsddParameters* parameters = nullptr;
  std::vector<double> wavelengths;                     // [nm]
  std::array<std::vector<double>, kSsddAngles> lists;  // [rad]

  size_t Channels() const {
    if (color_model == "spectrum") return wavelengths.size();
    return color_model == "monochrome" ? 1 : kChannels;
  }
  double Colors() const {
    double colors = 1;
    for (const std::vector<double>& list : lists) {
      colors *= static_cast<double>(std::max<size_t>(list.size(), 1));
    }
    return colors;
  }
  // The angles of a colour: the first list is the fastest; an empty one is 0 alone.
  SsddAngles At(size_t index) const {
    SsddAngles at{};
    for (size_t k = 0; k < kSsddAngles; ++k) {
      if (lists[k].empty()) continue;
      at[k] = lists[k][index % lists[k].size()];
      index /= lists[k].size();
    }
    return at;
  }
};

std::vector<double> NumbersBehind(const TextLines& lines,
                                  const std::vector<std::string_view>& words) {
  std::vector<double> numbers;
  for (size_t k = 1; k < words.size(); ++k) {
    numbers.push_back(ReadNumber(lines, k, std::string(words[0]), words[k]));
    if (!std::isfinite(numbers.back())) {
      lines.FailAt(k, std::string(words[0]), "expected a finite number", ErrorKind::kRange);
    }
  }
  return numbers;
}

// Takes what a line says of the block; keys that say nothing about values are passed over.
void ReadSsddKey(const TextLines& lines, const std::vector<std::string_view>& words,
                 SsddBlock* block) {
  const std::string key(words[0]);
  const std::string_view value = words.size() > 1 ? words[1] : "";
  if (key == "COLOR_MODEL") {
    constexpr std::string_view kModels[] = {"monochrome", "rgb", "xyz", "spectrum"};
    if (std::ranges::find(kModels, value) == std::end(kModels)) {
      lines.Fail("the color model is unknown; monochrome, rgb, xyz and spectrum can be read",
                 ErrorKind::kUnknown, key, value);
    }
    block->color_model = value;
  } else if (key == "WAVELENGTH_LIST") {
    block->wavelengths = NumbersBehind(lines, words);
  } else if (key == "PARAM_TYPE") {
    const auto* const found = std::ranges::find(kSsddParameters, value, &SsddParameters::name);
    if (found == std::end(kSsddParameters)) {
      lines.Fail(
          "these angles are unknown; spherical_, specular_ and half_difference_coordinate_system "
          "can be read",
          ErrorKind::kUnknown, key, value);
    }
    block->parameters = found;
  } else if (key == "PARAM4_LIST") {
    const std::vector<double> offsets = NumbersBehind(lines, words);
    if (std::ranges::any_of(offsets, [](double offset) { return offset != 0; })) {
      lines.Fail("offsets from the mirror direction are not read, as they are of refracted light",
                 ErrorKind::kUnsupported, key);
    }
  } else if (key.size() == 11 && key.starts_with("PARAM") && key.ends_with("_LIST")) {
    const size_t k = static_cast<size_t>(key[5]) - '0';
    if (k >= kSsddAngles) return;
    block->lists[k] = NumbersBehind(lines, words);
    for (double& angle : block->lists[k]) {
      angle = ReadAngle(lines, 1, key, angle, kPi / 180, {-360, 360});
    }
  }
}

void CheckSsddBlock(const TextLines& lines, const SsddBlock& block) {
  const auto lacks = [&](const char* key) {
    lines.Fail(std::string("expected a line ") + key + " before DATA", ErrorKind::kMissing, key);
  };
  if (block.color_model.empty()) lacks("COLOR_MODEL");
  if (block.color_model == "spectrum" && block.wavelengths.empty()) lacks("WAVELENGTH_LIST");
  if (block.parameters == nullptr) lacks("PARAM_TYPE");
  for (const size_t k : {0, 2, 3}) {
    const char* const key = k == 0 ? "PARAM0_LIST" : k == 2 ? "PARAM2_LIST" : "PARAM3_LIST";
    if (block.lists[k].empty()) lacks(key);
  }
  if (block.Colors() * static_cast<double>(block.Channels()) > kMostSsddColors) {
    lines.Fail("the lists make more than 100 million values", ErrorKind::kLimit, "DATA");
  }
}

// Adds the colours of a block, in their order, to a measurement.
class SsddSamples {
 public:
  SsddSamples(const SsddBlock& block, const std::string& source, const SourceOptions& options)
      : block_(block), collector_(source, "SSDD file of scattered samples") {
    if (block.color_model == "spectrum") bands_.emplace(block.wavelengths, options.bands, source);
  }

  void Add(const std::vector<double>& values) {
    const SphericalAngles at = block_.parameters->angles(block_.At(added_++));
    if (bands_) {
      bands_->Add(at, values, &collector_);
    } else if (block_.color_model == "xyz") {
      // Relative to white, as AddTristimulus takes them.
      constexpr std::array<double, 3> kWhite = {0.95047, 1, 1.08883};
      AddTristimulus(at, {values[0] / kWhite[0], values[1], values[2] / kWhite[2]}, &collector_);
    } else {
      const size_t last = values.size() - 1;
      collector_.Add(
          at, {values[0], values[std::min<size_t>(1, last)], values[std::min<size_t>(2, last)]});
    }
  }

  Measurement Take() {
    // An azimuth of the light, or of the half vector, is given for anisotropic materials alone.
    Measurement measurement =
        block_.lists[1].size() > 1 ? collector_.TakeByAzimuths() : collector_.Take();
    if (bands_) {
      measurement.bands = bands_->all();
      measurement.notes.push_back("read as: " + bands_->Note());
    }
    return measurement;
  }

 private:
  const SsddBlock& block_;
  SampleCollector collector_;
  std::optional<SpectrumBands> bands_;
  size_t added_ = 0;
};

std::vector<std::string> NamesOf(const SsddBlock& block) {
  std::vector<std::string> names;
  for (size_t k = 0; k < block.Channels(); ++k) names.push_back("value " + std::to_string(k + 1));
  return names;
}

Measurement ReadSsddData(const SsddBlock& block, bool is_binary, std::string_view binary,
                         TextLines* lines, const SourceOptions& options,
                         const std::string& source) {
  SsddSamples samples(block, source, options);
  const auto colors = static_cast<size_t>(block.Colors());
  const size_t channels = block.Channels();
  std::vector<double> values(channels);
  if (is_binary) {
    if (binary.size() < colors * channels * sizeof(float)) {
      lines->Fail("truncated: " + std::to_string(binary.size()) + " bytes of data, and the lists " +
                      "announce " + std::to_string(colors * channels * sizeof(float)) +
                      "; get the file once more",
                  ErrorKind::kMismatch, "DATA");
    }
    for (size_t index = 0; index < colors; ++index) {
      for (size_t c = 0; c < channels; ++c) {
        values[c] = LoadLittleEndian<float>(binary.data() + (index * channels + c) * sizeof(float));
      }
      samples.Add(values);
    }
    return samples.Take();
  }
  const std::vector<std::string> names = NamesOf(block);
  for (size_t index = 0; index < colors; ++index) {
    if (!lines->Next()) {
      lines->Fail("the file ends after " + std::to_string(index) + " of " + std::to_string(colors) +
                      " colours; get it once more",
                  ErrorKind::kMismatch, "DATA");
    }
    ReadNumbers(*lines, SplitWords(lines->line()), names, &values);
    samples.Add(values);
  }
  return samples.Take();
}

// Surface scattering distribution data, the format of libbsdf and BSDFProcessor ("SSDD file format
// specification", version 0.2; docs/file-formats.md): keys, a line each, then the colours of a
// table over the lists of angles, the first list fastest. The block of the BRDF is read; those of
// transmission and of mirrors are not. Throws Error, with the line, on anything else.
Measurement ParseSsdd(std::string_view text, const std::string& source,
                      const SourceOptions& options) {
  TextLines lines(text, source);
  std::optional<SsddBlock> block;
  std::string others;
  while (lines.Next()) {
    const std::vector<std::string_view> words = SplitWords(lines.line());
    if (words[0] == "DATA_TYPE") {
      block.emplace();
      block->data_type = words.size() > 1 ? words[1] : "";
      if (block->data_type != "brdf") others += (others.empty() ? "" : ", ") + block->data_type;
    } else if (words[0] == "DATA" && block) {
      const std::string_view mode = words.size() > 1 ? words[1] : "";
      const bool is_binary = mode == "binary";
      if (!is_binary && mode != "ascii") {
        lines.Fail("expected DATA ascii or DATA binary", ErrorKind::kUnknown, "DATA", mode);
      }
      if (block->data_type != "brdf" && !is_binary) continue;  // its numbers are no keys
      if (block->data_type != "brdf") {
        lines.Fail("binary data of '" + block->data_type +
                       "' before those of a BRDF are not read; put the BRDF first",
                   ErrorKind::kUnsupported, "DATA");
      }
      CheckSsddBlock(lines, *block);
      const char* const begin = lines.whole_line().data() + lines.whole_line().size();
      const size_t at = std::min<size_t>(begin - text.data(), text.size());
      const size_t line_end = std::min(text.find('\n', at), text.size() - 1);
      return ReadSsddData(*block, is_binary, text.substr(line_end + 1), &lines, options, source);
    } else if (block) {
      ReadSsddKey(lines, words, &*block);
    }
  }
  throw ErrorIn(ErrorKind::kMissing, source,
                others.empty() ? "no block DATA_TYPE brdf, with its DATA"
                               : "there is no BRDF, but " + others + "; only reflection is read")
      .About("DATA_TYPE");
}

// VERSION, and DATA_TYPE among the keys before the first data.
bool LooksLikeSsdd(std::string_view text) {
  TextLines lines(text, "");
  if (!lines.Next() || SplitWords(lines.line())[0] != "VERSION") return false;
  while (lines.Next()) {
    const std::string_view key = SplitWords(lines.line())[0];
    if (key == "DATA_TYPE") return true;
    if (key == "DATA") return false;
  }
  return false;
}

}  // namespace

MeasurementFormat SsddFormat() {
  return {.name = "ssdd",
          .description = "a libbsdf .ssdd file",
          .ending = ".ssdd",
          .is_text = true,
          .recognise = LooksLikeSsdd,
          .read = ParseSsdd};
}

}  // namespace trilobe
