// A reader on arbitrary bytes, which it may refuse with an Error; what it accepts must keep what
// the reader promises. reader_fuzzer --reader=NAME takes the format of measurements of that name or
// one of kReaders; libFuzzer leaves options with two dashes alone.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/names.h"
#include "fit/scene/scene_file.h"
#include "io/formats/databases/merl_file.h"
#include "io/formats/databases/rgl_file.h"
#include "io/formats/databases/utia_file.h"
#include "io/pictures/image_file.h"
#include "model/measurement/anisotropy.h"
#include "model/measurement/note_symptoms.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/model/appearance/environment.h"

namespace trilobe {
namespace {

constexpr const char* kSource = "fuzz";

void Require(bool promise) {
  if (!promise) std::abort();
}

// What `read` returns; nothing where it refuses.
template <typename Read>
auto Accepted(const Read& read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const Error&) {
    return std::nullopt;
  }
}

// --- Measurements --------------------------------------------------------------------------------

void CheckScattered(const Measurement& measurement) {
  const BinCounts& counts = measurement.counts;
  CheckSamples(measurement.samples);
  Require(!measurement.table && counts.valid == measurement.samples.size());
  Require(measurement.samples.directions.size() == measurement.samples.rho.size());
  Require(counts.valid + counts.below_surface + counts.non_finite + counts.negative +
              counts.missing + counts.extrapolated + counts.beyond_nodes +
              counts.below_min_theta_d ==
          counts.total);
  for (const SphericalAngles& angles : measurement.samples.directions) {
    Require(angles.theta_i <= measurement.max_theta && angles.theta_o <= measurement.max_theta);
  }
  Require(std::isfinite(ReciprocityError(measurement).median));
  const double share = AnisotropyOf(measurement).share;
  Require(share >= 0 && share <= 1 + 1e-9);
  Measurement limited = measurement;
  LimitAngles(1, &limited);
  Require(limited.counts.valid + limited.counts.beyond_max_angle == counts.valid);
  Measurement lit = measurement;
  LeaveOutOwnShadow(&lit);
  Require(lit.counts.valid + lit.counts.below_min_theta_d ==
          counts.valid + counts.below_min_theta_d);
}

// No input is long enough to be a MERL file of the usual grid. Of a small one that is written as
// MERL's are, the table is what the bytes hold, bit for bit.
void FuzzMerl(std::string_view bytes) {
  const auto table = Accepted([&] { return ParseMerl(bytes, kSource); });
  if (!table) return;
  const MerlGrid& grid = table->grid;
  Require(grid.size() > 0 && grid.size() < 1000000);
  for (const auto& plane : table->stored) Require(plane.size() == static_cast<size_t>(grid.size()));
  const int32_t dimensions[] = {grid.theta_h, grid.theta_d, grid.phi_d};
  const bool is_plain = bytes.size() == 12 + 3 * sizeof(double) * grid.size() &&
                        std::memcmp(bytes.data(), dimensions, sizeof(dimensions)) == 0;
  if (!is_plain) return;
  std::string stored;
  for (const auto& plane : table->stored) {
    stored.append(reinterpret_cast<const char*>(plane.data()), plane.size() * sizeof(double));
  }
  Require(bytes.substr(12) == stored);
}

// Finite and >= 0 in all directions; and the samples of an anisotropic material.
void FuzzRgl(std::string_view bytes) {
  const auto brdf = Accepted([&] { return RglBrdf::Parse(bytes, kSource); });
  if (!brdf) return;
  const Direction directions[] = {{0, 0, 1},          {0.6, 0, 0.8}, {0, -0.8, 0.6},
                                  {-0.6, 0.64, 0.48}, {-1, 0, 1e-9}, {0.6, 0, -0.8}};
  for (const Direction& wi : directions) {
    for (const Direction& wo : directions) {
      for (const double rho : brdf->Evaluate({wi, wo})) Require(std::isfinite(rho) && rho >= 0);
    }
  }
  if (brdf->isotropic()) return;
  for (const bool extrapolated : {false, true}) {
    CheckScattered(brdf->Sample(kSource, extrapolated));
  }
}

// As they are, and as a file of the right size that repeats them, with the radiometry that the
// first byte says, on a grid of few nodes (files of UTIA's own have 2 MB).
void FuzzUtia(std::string_view bytes) {
  if (bytes.size() < 2) return;
  const auto first = static_cast<unsigned char>(bytes[0]);
  bytes.remove_prefix(1);
  const HemisphereGrid grid = first % 2 == 0 ? HemisphereGrid{.thetas = 2, .phis = 4}
                                             : HemisphereGrid{.thetas = 3, .phis = 2};
  const std::vector<UtiaRadiometry>& radiometries = UtiaRadiometries();
  const std::string& radiometry = radiometries[first / 2 % radiometries.size()].name;
  Accepted([&] { return ParseUtia(bytes, kSource, radiometry, grid); });
  const size_t needed =
      sizeof(double) * kChannels * static_cast<size_t>(grid.nodes() * grid.nodes());
  std::string repeated;
  while (repeated.size() < needed) repeated += bytes;
  repeated.resize(needed);
  CheckScattered(ParseUtia(repeated, kSource, radiometry, grid));
}

// How a text table may be read: as it says itself, and by flags.
const std::vector<SourceOptions>& TableOptions() {
  static const std::vector<SourceOptions> options = {
      {},
      {.columns = "theta_o,-,f", .theta_i_deg = 30},
      {.columns = "theta_o/phi_o", .theta_i_deg = 30},
      {.columns = "theta_o/theta_i"},
      {.columns = "theta_i=i,f=g", .theta_o_deg = 45},
      {.rows = "f=1"},
      {.cosine = 1, .scale = 0.01, .azimuth_from_mirror = true, .outliers = true}};
  return options;
}

// Of scattered samples.
void FuzzFormat(const MeasurementFormat& format, std::string_view bytes) {
  for (const SourceOptions& options : TableOptions()) {
    const auto measurement = Accepted([&] { return format.read(bytes, kSource, options); });
    if (measurement) CheckScattered(*measurement);
    if (format.name != "csv") break;
  }
}

// A file that nobody has named, as a command reads it: in UTF-16, foreign, of any format of
// scattered samples; by the options that its size says. What is told of it, too. Outliers of an RGL
// file's table take seconds.
void FuzzSource(std::string_view bytes) {
  const MeasurementFormat* const format = RecogniseFormat(bytes);
  if (format != nullptr && format->name == "rgl") return;
  const SourceOptions& options = TableOptions()[bytes.size() % TableOptions().size()];
  auto measurement = Accepted([&] { return Source("fuzz.txt", std::string(bytes)).Read(options); });
  if (!measurement || measurement->table) return;
  CheckScattered(*measurement);
  NoteSymptoms(1, &*measurement);
  for (const std::string& note : measurement->notes) {
    Require(note.find('\n') == std::string::npos);
  }
}

// --- What else is read ---------------------------------------------------------------------------

// Survives being written and read again.
void FuzzModel(std::string_view text) {
  const auto file = Accepted([&] { return ParseModel(text, kSource); });
  if (!file) return;
  const std::string formatted = FormatModel(*file);
  const ModelFile again = ParseModel(formatted, kSource);
  const auto x = file->model.parameters(), y = again.model.parameters();
  Require(file->model.spec() == again.model.spec() && x.size() == y.size() &&
          std::memcmp(x.data(), y.data(), x.size_bytes()) == 0 &&
          file->unobserved == again.unobserved);
  Require(FormatModel(again) == formatted);
}

void FuzzTrace(std::string_view text) {
  const auto records = Accepted([&] { return ParseTrace(text, kSource); });
  if (records) Require(ParseTrace(FormatTrace(*records), kSource) == *records);
}

// And a histogram of directions in the same bytes.
void FuzzScene(std::string_view text) {
  const auto scene = Accepted([&] { return ParseScene(text, kSource); });
  if (scene) Require(!scene->materials.empty());
  const auto histogram = Accepted([&] { return ParseHistogram(text, kSource); });
  if (histogram) Require(histogram->counts.size() == static_cast<size_t>(histogram->grid.size()));
}

// Finite and >= 0, and gives finite lights, unless there is no light.
void FuzzProbe(std::string_view bytes) {
  const auto probe = Accepted([&] { return ParseProbe(bytes, kSource); });
  if (!probe) return;
  Require(probe->radiance.size() == static_cast<size_t>(probe->width) * probe->height);
  for (const Rgb& radiance : probe->radiance) {
    for (const double x : radiance) Require(std::isfinite(x) && x >= 0);
  }
  const auto lights = Accepted([&] { return DrawLights(*probe, 30); });
  if (!lights) return;
  for (const Light& light : *lights) {
    for (int k = 0; k < 3; ++k) {
      Require(std::isfinite(light.direction[k]) && std::isfinite(light.irradiance[k]));
    }
  }
}

// --- Which of them -------------------------------------------------------------------------------

struct Reader {
  std::string_view name;
  void (*fuzz)(std::string_view bytes);
};
constexpr Reader kReaders[] = {{"source", FuzzSource}, {"merl", FuzzMerl},   {"rgl", FuzzRgl},
                               {"utia", FuzzUtia},     {"model", FuzzModel}, {"trace", FuzzTrace},
                               {"scene", FuzzScene},   {"probe", FuzzProbe}};

std::function<void(std::string_view)> fuzz;

std::function<void(std::string_view)> FuzzOf(std::string_view name) {
  const auto* const found = std::ranges::find(kReaders, name, &Reader::name);
  if (found != std::end(kReaders)) return found->fuzz;
  const MeasurementFormat& format = FindNamed("reader", name, MeasurementFormats());
  return [&format](std::string_view bytes) { FuzzFormat(format, bytes); };
}

}  // namespace
}  // namespace trilobe

// NOLINTNEXTLINE(readability-non-const-parameter): libFuzzer says what it is given.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--reader=";
  std::string_view name;
  for (const std::string_view argument : std::span(*argv, *argc)) {
    if (argument.starts_with(kOption)) name = argument.substr(kOption.size());
  }
  try {
    trilobe::fuzz = trilobe::FuzzOf(name);
  } catch (const trilobe::Error& error) {
    std::cerr << error.what() << '\n';
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  trilobe::fuzz({reinterpret_cast<const char*>(data), size});
  return 0;
}
