#include <gflags/gflags.h>

#include <iostream>
#include <ostream>
#include <string>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "app/write_for_renderer.h"
#include "fit/reports/print.h"
#include "io/formats/utia_file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/fit/export/convert.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/corruption/corruption.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {
namespace {

Measurement MeasurementOf(const std::string& source, const std::string& out,
                          const SourceOptions& options) {
  if (!IsModelFile(source)) return LoadMeasurement(source, options);
  RefuseForModel(source, {"noise", "extrapolated", "radiometry"});
  const FactorModel model = ModelOfSource(source).model;
  if (model.spec().anisotropic() && !WritableFormat(out).holds_anisotropic) {
    throw Error("--out=" + out + ": " + source +
                " is an anisotropic model, which MERL layout cannot hold; end the name in .bin, "
                "for UTIA's directions, or in .csv");
  }
  Measurement measurement = AsMeasurement(model, source, options.num_threads, kUtiaGrid);
  CorruptBy(options, &measurement);
  DecideMeasured(options, &measurement);
  return measurement;
}

std::string ListOfCorruptions() {
  std::string text;
  for (const CorruptionKind& kind : CorruptionKinds()) {
    text += "\n  " + kind.name + ", from " + Text(kind.min) + " to " + Text(kind.max) + " [" +
            kind.unit + "]: " + kind.formula;
  }
  return text;
}

int RunConvert(std::span<const std::string> arguments) {
  const std::string& source = arguments[0];
  if (IsForRenderer(FLAGS_out)) {
    WriteForRenderer(source);
    return 0;
  }
  CheckRendererFlags(FLAGS_out);
  const std::string out = RequiredMeasurementOut("convert");
  Inputs({source}).CheckOutput(out);
  SourceOptions options = SourceOptionsFromFlags();
  options.outliers = options.dark_noise = true;  // what is copied stays as it is
  const Measurement measurement = MeasurementOf(source, out, options);
  TellNotes(measurement);
  const std::string written = WriteMeasurement(measurement, out, options.num_threads);
  PrintLine("wrote " + out + ": " + written);
  return 0;
}

}  // namespace

Command ConvertCommand() {
  return {
      .name = "convert",
      .summary = "write a measurement or a model in MERL layout, as CSV, or for a renderer",
      .arguments = "SOURCE|MODEL",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "Evaluates the input at the bin centres of a MERL .binary file and writes that to --out, "
          "so that\nevery MERL viewer can show it. A MERL file is copied bit for bit. Of an RGL "
          "file, bins that were not\nmeasured are marked invalid (-1), unless --extrapolated is "
          "given. For a model file, all bins with both\ndirections above the surface are filled; "
          "elsewhere bins are marked invalid. An\nanisotropic model is evaluated at the "
          "directions of the UTIA database, for a .bin or .csv file. With --max_angle "
          "or\n--min_theta_d, bins beyond them are marked invalid, too, whatever the input. "
          "Scattered samples have no bins: that is an error.\nTo a FILE that ends in .csv it "
          "writes the valid samples, scattered ones too, a row each, with all their\ndigits; a "
          "whole table takes some 130 MB. To a FILE that ends in .bin it writes the input at "
          "the\ndirections of the UTIA database, -1 where it was not measured; scattered samples "
          "must stand at them.\nTo a FILE that ends in .bsdf it writes an RGL tensor file, which "
          "Mitsuba 3 renders (`measured`), and with\n--spectral pbrt-v4: of a model, or of a "
          "measurement, to which a model is fitted for that, which takes\nseconds; its values are "
          "those measured, and the model's where nothing was. Of a model, to a FILE that ends in "
          ".glsl it writes\nfunctions for shaders; of both, to one that ends in .mtlx the nearest "
          "OpenPBR of MaterialX, and in\n.principled.json that of Blender's Principled BSDF, with "
          "how near it is. A FILE with another ending is an error.\n\nkinds of corruption "
          "(--corrupt=KIND:STRENGTH,...), x the strength, rho the BRDF, b = rho cos "
          "theta_i the signal:" +
          ListOfCorruptions(),
      .flags = WithSourceFlags({"out", "error", "spectral", "picture", "probe"}),
      .run = RunConvert};
}

}  // namespace trilobe
