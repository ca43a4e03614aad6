#include <iostream>
#include <string>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/inputs.h"
#include "trilobe/app/result_folder.h"
#include "trilobe/brdf/measurement_stats.h"
#include "trilobe/io/csv_file.h"
#include "trilobe/io/file.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/source.h"
#include "trilobe/model/reconstruct.h"

namespace trilobe {
namespace {

Measurement MeasurementOf(const std::string& source, const SourceOptions& options) {
  if (!IsModelFile(source)) return LoadMeasurement(source, options);
  Measurement measurement{
      .source = source,
      .kind = "reconstruction",
      .table = Reconstruct(ReadModel(source).model, source, {}, options.num_threads)};
  DecideMeasured(options, &measurement);
  return measurement;
}

int RunConvert(std::span<const std::string> arguments) {
  const std::string& source = arguments[0];
  const bool csv = EndingOf(FLAGS_out) == ".csv";
  const std::string out = csv ? FLAGS_out : RequiredMerlOut("convert");
  Inputs({source}).CheckOutput(out);
  const Measurement measurement = MeasurementOf(source, SourceOptionsFromFlags());
  if (csv) {
    std::cout << "wrote " << out << ": CSV, " << WriteCsv(measurement, out) << " samples\n";
    return 0;
  }
  const BrdfTable& table = TableOf(measurement);
  WriteMerl(table, out);
  const BinCounts bins = CountBins(table);
  std::cout << "wrote " << out << ": MERL layout, " << bins.valid << " of " << bins.total
            << " bins valid\n";
  return 0;
}

}  // namespace

Command ConvertCommand() {
  return {
      .name = "convert",
      .summary = "write a measurement, or a model's reconstruction, in MERL layout or as CSV",
      .arguments = "SOURCE|MODEL",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "Evaluates the input at the bin centres of a MERL .binary file and writes that to "
          "--out, so that\nevery MERL viewer can show it. A MERL file is copied bit for bit. Of an "
          "RGL file, bins that were not\nmeasured are marked invalid (-1), unless --extrapolated "
          "is given. For a model file, all bins with both\ndirections above the surface are "
          "filled; "
          "elsewhere bins are marked invalid. With --max_angle, bins\nbeyond it are marked "
          "invalid, "
          "too, whatever the input. Scattered samples have no bins: that is an error.\nTo a FILE "
          "that ends in .csv it writes the valid samples, scattered ones too, a row each, with all "
          "their\ndigits; a whole table takes some 130 MB. A FILE whose ending says another "
          "format, as .bsdf does, is an\nerror.",
      .flags = {"out", "noise", "seed", "max_angle", "extrapolated", "threads"},
      .run = RunConvert};
}

}  // namespace trilobe
