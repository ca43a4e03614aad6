#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/files/little_endian.h"
#include "core/files/text_lines.h"
#include "io/formats/spectrum.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr std::string_view kStream = "#BEGIN_STREAM";

// --- Inputs of a sample --------------------------------------------------------------------------

// The first numbers of a sample: what they are called, whether they tell azimuths apart, and the
// directions of the light (L) and of the view (V) that they stand for. Angles in radians.
struct AltaInput {
  std::string_view name;
  std::vector<std::string> numbers;
  bool has_azimuths;
  DirectionPair (*directions)(const double* x);
};

const std::vector<AltaInput>& AltaInputs() {
  static const std::vector<AltaInput> inputs = {
      {"SPHERICAL_TL_PL_TV_PV",
       {"theta_l", "phi_l", "theta_v", "phi_v"},
       true,
       [](const double* x) {
         return DirectionPair{ToDirection({x[0], x[1]}), ToDirection({x[2], x[3]})};
       }},
      {"ISOTROPIC_TV_TL_DPHI",
       {"theta_v", "theta_l", "dphi"},
       false,
       [](const double* x) {
         return DirectionPair{ToDirection({x[1], 0}), ToDirection({x[0], x[2]})};
       }},
      {"ISOTROPIC_TL_TV_PROJ_DPHI",
       {"theta_l", "theta_v cos dphi", "theta_v sin dphi"},
       false,
       [](const double* x) {
         return DirectionPair{ToDirection({x[0], 0}),
                              ToDirection({std::hypot(x[1], x[2]), std::atan2(x[2], x[1])})};
       }},
      {"RUSIN_TH_TD_PD",
       {"theta_h", "theta_d", "phi_d"},
       false,
       [](const double* x) {
         return ToDirections(HalfDiffAngles{x[0], x[1], x[2]});
       }},
      {"RUSIN_TH_PH_TD_PD",
       {"theta_h", "phi_h", "theta_d", "phi_d"},
       true,
       [](const double* x) {
         const auto [wi, wo] = ToDirections(HalfDiffAngles{x[0], x[2], x[3]});
         return DirectionPair{TurnedAboutNormal(wi, x[1]), TurnedAboutNormal(wo, x[1])};
       }},
      {"CARTESIAN",
       {"V.x", "V.y", "V.z", "L.x", "L.y", "L.z"},
       true,
       [](const double* x) {
         return DirectionPair{{x[3], x[4], x[5]}, {x[0], x[1], x[2]}};
       }},
  };
  return inputs;
}

// --- The header ----------------------------------------------------------------------------------

struct AltaHeader {
  const AltaInput* input = nullptr;
  std::string output;
  size_t values = 0;     // of a sample
  size_t intervals = 0;  // of confidence, numbers for each value: 0, 1, 2
  bool is_binary = false;
  std::optional<double> samples = {};  // of a binary file
};

size_t ReadAltaCount(const TextLines& lines, std::string_view word, int most) {
  const std::optional<int> count = ToInteger(word);
  if (!count || *count < 0 || *count > most) {
    lines.Fail("expected a whole number up to " + std::to_string(most) + ", not '" +
               std::string(word.substr(0, 40)) + "'");
  }
  return static_cast<size_t>(*count);
}

void CheckAltaHeader(const TextLines& lines, const std::map<std::string, std::string>& seen,
                     size_t numbers, const AltaHeader& header) {
  for (const char* const key : {"#DIM", "#PARAM_IN", "#PARAM_OUT"}) {
    if (!seen.contains(key)) {
      lines.Fail(std::string("the header before it has no ") + key, ErrorKind::kMissing, key);
    }
  }
  if (header.input == nullptr) {
    std::string known;
    for (const AltaInput& input : AltaInputs()) {
      known.append(known.empty() ? "" : ", ").append(input.name);
    }
    lines.Fail("PARAM_IN is " + seen.at("#PARAM_IN").substr(0, 40) +
                   "; only what names both directions can be read: " + known,
               ErrorKind::kUnsupported, "#PARAM_IN", seen.at("#PARAM_IN"));
  }
  const bool is_color = header.output == "RGB_COLOR" || header.output == "XYZ_COLOR";
  if (!is_color && !header.output.starts_with("INV_STERADIAN")) {
    lines.Fail("PARAM_OUT is " + header.output.substr(0, 40) +
               "; only INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR, RGB_COLOR and XYZ_COLOR can be "
               "read");
  }
  if (numbers != header.input->numbers.size() ||
      (header.values != 3 && (is_color || header.values != 1))) {
    lines.Fail("DIM is " + seen.at("#DIM").substr(0, 40) + ", and " +
                   std::string(header.input->name) + " has " +
                   std::to_string(header.input->numbers.size()) + " numbers, " + header.output +
                   (is_color ? " 3" : " 1 or 3"),
               ErrorKind::kMismatch, "#DIM", seen.at("#DIM"));
  }
}

// Reads up to the first sample, where `lines` is then, or to the line #BEGIN_STREAM of a binary
// file.
AltaHeader ReadAltaHeader(TextLines* lines) {
  AltaHeader header;
  std::map<std::string, std::string> seen;
  size_t numbers = 0;
  bool more = lines->NextWithComment();
  for (; more && lines->line() != kStream; more = lines->NextWithComment()) {
    const auto words = SplitWords(lines->line());
    if (words[0][0] != '#') {
      if (seen.empty()) continue;  // what is before the header
      break;
    }
    const std::string key(words[0]);
    const std::string_view word = words.size() > 1 ? words[1] : "";
    if (key == "#DIM" && words.size() == 3) {
      numbers = ReadAltaCount(*lines, words[1], 1000);
      header.values = ReadAltaCount(*lines, words[2], 1000);
      seen[key] = std::string(words[1]) + " " + std::string(words[2]);
    } else if (key == "#PARAM_IN") {
      const auto found = std::ranges::find(AltaInputs(), word, &AltaInput::name);
      header.input = found == AltaInputs().end() ? nullptr : &*found;
      seen[key] = word;
    } else if (key == "#PARAM_OUT") {
      header.output = seen[key] = word;
    } else if (key == "#VS") {
      header.intervals = ReadAltaCount(*lines, word, 2);
    } else if (key == "#FORMAT") {
      header.is_binary = word == "binary";
    } else if (key == "#SAMPLE_COUNT") {
      header.samples = ReadNumber(*lines, 1, "SAMPLE_COUNT", word);
    } else if ((key == "#ENDIAN" && word != "little") ||
               (key == "#PRECISION" && word != "ieee754-double")) {
      lines->Fail(key.substr(1) + " is " + std::string(word.substr(0, 40)) +
                      "; only ieee754-double and little can be read",
                  ErrorKind::kUnsupported, key, word);
    }
  }
  CheckAltaHeader(*lines, seen, numbers, header);
  if (header.is_binary && (lines->line() != kStream || !header.samples)) {
    lines->Fail("the header of a binary file has no SAMPLE_COUNT or no BEGIN_STREAM",
                ErrorKind::kMissing, "#SAMPLE_COUNT");
  }
  if (!more) lines->Fail("the file ends before its first sample", ErrorKind::kMissing, "samples");
  return header;
}

// --- Samples -------------------------------------------------------------------------------------

// Adds the sample of a row; its numbers must be finite, and angles within two turns.
template <typename Fail>
void AddAltaRow(const AltaHeader& header, const double* row, const Fail& fail,
                SampleCollector* collector) {
  const AltaInput& input = *header.input;
  for (size_t k = 0; k < input.numbers.size(); ++k) {
    if (!(std::abs(row[k]) <= 4 * kPi)) {
      fail(k, input.numbers[k], "it is no number of radians, or of a direction of length 1");
    }
  }
  const DirectionPair pair = input.directions(row);
  SphericalAngles at = ToSphericalAngles(pair);
  if (!input.has_azimuths) {  // the light at 0
    at.phi_o -= at.phi_i;
    at.phi_i = 0;
  }
  const double* const values = row + input.numbers.size();
  const double scale =
      header.output == "INV_STERADIAN_COSINE_FACTOR" ? 1 / std::cos(at.theta_o) : 1;
  Rgb rho{};
  for (size_t c = 0; c < kChannels; ++c) rho[c] = scale * values[header.values == 1 ? 0 : c];
  if (header.output == "XYZ_COLOR") {
    AddTristimulus(at, rho, collector);
  } else {
    collector->Add(at, rho);
  }
}

void ReadAltaText(const AltaHeader& header, TextLines* lines, SampleCollector* collector) {
  const size_t needed = header.input->numbers.size() + header.values;
  const size_t most = needed + header.intervals * header.values;
  std::vector<double> row;
  for (bool more = true; more; more = lines->Next()) {
    if (lines->line()[0] == '#') continue;
    const auto words = SplitWords(lines->line());
    if (words.size() < needed || words.size() > most) {
      lines->Fail(std::to_string(words.size()) + " numbers; expected " + std::to_string(needed) +
                      (most > needed ? " to " + std::to_string(most) : "") + ", as DIM says",
                  ErrorKind::kFormat, "columns", std::to_string(words.size()));
    }
    row.clear();
    for (size_t k = 0; k < needed; ++k) {
      const bool is_input = k < header.input->numbers.size();
      row.push_back(
          ReadNumber(*lines, k, is_input ? header.input->numbers[k] : header.output, words[k]));
    }
    const auto fail = [&](size_t k, const std::string& name, const std::string& problem) {
      lines->FailAt(k, name, problem, ErrorKind::kRange, words[k]);
    };
    AddAltaRow(header, row.data(), fail, collector);
  }
}

void ReadAltaStream(const AltaHeader& header, std::string_view bytes, const std::string& source,
                    SampleCollector* collector) {
  const size_t begin = std::min(bytes.find('\n', bytes.find(kStream)), bytes.size() - 1) + 1;
  bytes.remove_prefix(begin);
  const size_t numbers = header.input->numbers.size() + header.values * (1 + header.intervals);
  const size_t size = numbers * sizeof(double);
  const size_t most = bytes.size() / size;
  if (!(*header.samples >= 0 && *header.samples <= static_cast<double>(most))) {
    throw ErrorIn(ErrorKind::kFormat, source,
                  "truncated: " + std::to_string(bytes.size()) +
                      " bytes of samples, and its header announces more; get it once more")
        .About("SAMPLE_COUNT", *header.samples);
  }
  std::vector<double> row(numbers);
  for (size_t j = 0; j < static_cast<size_t>(*header.samples); ++j) {
    for (size_t k = 0; k < numbers; ++k) {
      row[k] = LoadLittleEndian<double>(bytes.data() + j * size + k * sizeof(double));
    }
    const auto fail = [&](size_t k, const std::string& name, const std::string& problem) {
      throw ErrorIn(ErrorKind::kFormat, source,
                    "sample " + std::to_string(j + 1) + ", number " + std::to_string(k + 1) + " (" +
                        name + "): " + problem)
          .About(name, j + 1);
    };
    AddAltaRow(header, row.data(), fail, collector);
  }
}

// A data file of Inria's ALTA, text or binary (docs/file-formats.md): a header of lines #DIM,
// #PARAM_IN, #PARAM_OUT, then a sample per line, or little-endian float64 after #BEGIN_STREAM.
// Throws Error, with the line or the sample, on anything else.
Measurement ParseAlta(std::string_view bytes, const std::string& source) {
  TextLines lines(bytes, source);
  const AltaHeader header = ReadAltaHeader(&lines);
  SampleCollector collector(source, "ALTA file of scattered samples");
  if (header.is_binary) {
    ReadAltaStream(header, bytes, source, &collector);
  } else {
    ReadAltaText(header, &lines, &collector);
  }
  Measurement measurement =
      header.input->has_azimuths ? collector.TakeByAzimuths() : collector.Take();
  if (header.output == "INV_STERADIAN_COSINE_FACTOR") {
    measurement.notes.emplace_back("read as: f cos theta_o, divided by cos theta_o");
  } else if (header.output == "XYZ_COLOR") {
    measurement.notes.emplace_back(std::string("read as: ").append(kTristimulusNote));
  }
  return measurement;
}

// Comments name dimensions and parametrisations.
bool LooksLikeAlta(std::string_view text) {
  constexpr size_t kLongestHeader = 1 << 16;
  TextLines lines(text.substr(0, kLongestHeader), "");
  bool has_dim = false;
  while (lines.NextWithComment()) {
    has_dim = has_dim || lines.line().starts_with("#DIM");
    if (has_dim && lines.line().starts_with("#PARAM_")) return true;
  }
  return false;
}

}  // namespace

MeasurementFormat AltaFormat() {
  return {.name = "alta",
          .description = "an ALTA .alta file",
          .ending = ".alta",
          .is_text = true,
          .recognise = LooksLikeAlta,
          .read = ReadBy<ParseAlta>};
}

}  // namespace trilobe
