#include <iostream>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/inputs.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/source.h"
#include "trilobe/model/measurement_stats.h"
#include "trilobe/model/reconstruct.h"

namespace trilobe {
namespace {

int RunConvert(std::span<const std::string> arguments) {
  const std::string& source = arguments[0];
  const std::string out = RequiredOut("convert", "FILE");
  const BrdfTable table = IsModelFile(source)
                              ? Reconstruct(ReadModel(source).model, source, {}, ThreadsFromFlags())
                              : LoadSource(source, SourceOptionsFromFlags());
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
      .summary = "write a measurement, or a model's reconstruction, in MERL layout",
      .arguments = "SOURCE|MODEL",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "Evaluates the input at the bin centres of a MERL .binary file and writes that to "
          "--out, so that\nevery MERL viewer can show it. A MERL file is copied bit for bit. For "
          "a model file, all bins with\nboth directions above the surface are filled; elsewhere "
          "bins are marked invalid (-1).",
      .flags = {"out", "noise", "seed", "threads"},
      .run = RunConvert};
}

}  // namespace trilobe
