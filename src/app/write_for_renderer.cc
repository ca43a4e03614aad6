#include "app/write_for_renderer.h"

#include <gflags/gflags.h>

#include <filesystem>
#include <system_error>

#include "app/appearance_flags.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "core/files/file.h"
#include "fit/reports/print.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/export/convert.h"
#include "trilobe/io/formats/source.h"

DEFINE_double(error, 0,
              "of a .bsdf file: how far it may be off the model or the measurement, relative, in "
              "the median over directions; finer tables are taken until it is met. 0: 0.005, of an "
              "anisotropic model 0.02, or as near as files come, and of a measurement as files of "
              "usual size come");
DEFINE_bool(spectral, false,
            "of a .bsdf file: spectra in place of RGB, for spectral renderers (Mitsuba's spectral "
            "variants, pbrt-v4); the others cannot read it");
DEFINE_bool(picture, false,
            "of a .mtlx or .principled.json file: draws the model and what the file has, side by "
            "side, beside it, as .png");

namespace trilobe {
namespace {

// What can be known to fail is told before a fit, which takes seconds.
void CheckOut(const std::string& source) {
  Inputs({source}).CheckOutput(FLAGS_out);
  const std::filesystem::path folder = std::filesystem::path(FLAGS_out).parent_path();
  std::error_code ignored;
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw Error("cannot write '" + FLAGS_out + "': there is no folder '" + folder.string() +
                "'; make it first");
  }
}

ConvertOptions OptionsFromFlags(const std::string& source) {
  if (!(FLAGS_error >= 0 && FLAGS_error <= 1)) throw Error("--error must be from 0 to 1");
  ConvertOptions options{.error = FLAGS_error,
                         .spectral = FLAGS_spectral,
                         .program = ProgramName(),
                         .appearance = AppearanceOptionsFromFlags(),
                         .num_threads = ThreadsFromFlags()};
  if (FLAGS_picture) {
    const std::string ending = EndingOf(FLAGS_out) == ".json" ? ".principled.json" : ".mtlx";
    options.picture = FLAGS_out.substr(0, FLAGS_out.size() - ending.size()) + ".png";
    Inputs({source, FLAGS_probe}).CheckOutput(options.picture);
  }
  return options;
}

}  // namespace

std::vector<std::string> RendererFlags() { return {"error", "spectral", "picture", "probe"}; }

void CheckRendererFlags(const std::string& path) {
  const bool tensor = EndingOf(path) == ".bsdf";
  for (const char* const flag : {"error", "spectral"}) {
    if (tensor || IsDefault(flag)) continue;
    throw Error("--" + std::string(flag) + " goes with an --out that ends in .bsdf");
  }
  for (const char* const flag : {"picture", "probe"}) {
    if (IsStandardMaterial(path) || IsDefault(flag)) continue;
    throw Error("--" + std::string(flag) +
                " goes with an --out that ends in .mtlx or .principled.json");
  }
}

void WriteForRenderer(const std::string& source) {
  CheckRendererFlags(FLAGS_out);
  const std::string& out = FLAGS_out;
  std::vector<std::string> lines;
  if (IsModelFile(source)) {
    RefuseForModel(source, MeasurementFlags());
    CheckOut(source);
    const ConvertOptions options = OptionsFromFlags(source);
    lines = WriteForRenderer(ModelOfSource(source), source, out, options);
  } else {
    CheckOut(source);
    const ConvertOptions options = OptionsFromFlags(source);
    const Measurement measurement = LoadMeasurement(source, SourceOptionsFromFlags());
    TellNotes(measurement);
    lines = WriteForRenderer(measurement, out, options);
  }
  for (const std::string& line : lines) PrintLine(line);
}

}  // namespace trilobe
