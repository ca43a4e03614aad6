#include <gflags/gflags.h>

#include <iostream>
#include <optional>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "core/files/file.h"
#include "fit/reports/print.h"
#include "io/pictures/plots.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/formats/trace_file.h"

DEFINE_string(trace, "", "trace.csv of a fit, to draw its convergence");

namespace trilobe {
namespace {

int RunPlot(std::span<const std::string> arguments) {
  const std::string folder = RequiredOut("plot", "DIR");
  std::vector<std::string> read(arguments.begin(), arguments.end());
  for (const std::string& path : {FLAGS_trace, FLAGS_probe}) read.push_back(path);
  const Inputs inputs(read);
  for (const char* const name : kPictureNames) {
    inputs.CheckOutput(folder + "/" + name);
  }
  if (arguments.size() == 1) RefuseForModel(arguments[0], MeasurementFlags());
  const ModelFile file = ModelOfSource(arguments[0]);
  std::optional<Measurement> measured;
  PictureData data;
  if (arguments.size() > 1) {
    measured = MeasurementOfSource(arguments[1], SourceOptionsFromFlags());
    PrintNotes(*measured);
    data = PictureDataOf(*measured);
  }
  std::vector<IterationRecord> trace;
  if (!FLAGS_trace.empty()) trace = ReadTrace(FLAGS_trace);
  CheckDrawable(file, trace);
  MakeDirectories(folder);
  for (const std::string& path :
       DrawPictures(file, data, trace, folder, AppearanceOptionsFromFlags())) {
    PrintLine("wrote " + path);
  }
  return 0;
}

}  // namespace

Command PlotCommand() {
  return {.name = "plot",
          .summary = "draw a model's factors, its fit to a measurement, and a trace",
          .arguments = "MODEL [SOURCE]",
          .doing = "drawing",
          .min_arguments = 1,
          .max_arguments = 2,
          .details =
              "Writes PNG pictures into the folder --out, by gnuplot:\n"
              "  factors.png  D, F, G and the coefficients d, s\n"
              "  slices.png   measured against fitted values over an angle (with SOURCE)\n"
              "  spheres.png  measured, fitted and their difference on a sphere; without\n"
              "               SOURCE, or if its samples are few, the model alone\n"
              "  cloth.png    the same on draped cloth (where SOURCE is anisotropic)\n"
              "  trace.png    E over iterations and seconds (with --trace)",
          .flags = WithSourceFlags({"out", "trace", "probe"}),
          .run = RunPlot};
}

}  // namespace trilobe
