#include <algorithm>
#include <iostream>
#include <string>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "fit/reports/print.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe {
namespace {

int RunSynth(std::span<const std::string> arguments) {
  if (arguments.empty()) {
    size_t width = 0;
    for (const SynthMaterial& material : SynthMaterials()) {
      width = std::max(width, material.name.size() + 2);
    }
    for (const SynthMaterial& material : SynthMaterials()) {
      std::cout << "  " << material.name << std::string(width - material.name.size(), ' ')
                << material.description << (material.anisotropic ? "; anisotropic" : "") << "\n";
    }
    return 0;
  }
  const std::string source = "synth:" + arguments[0];
  const SynthMaterial& material = SynthSourceOf(source).material;
  const std::string out = RequiredMeasurementOut("synth");
  Inputs().CheckOutput(out, CheckMayReplaceMeasurement);
  SourceOptions options = SourceOptionsFromFlags();
  options.as_they_are = true;
  ReplaceMeasurement(LoadMeasurement(source, options), out, options.num_threads);
  PrintLine("wrote " + out + ": " + material.description + ", noise " + Text(options.noise) +
            ", seed " + std::to_string(options.seed));
  return 0;
}

}  // namespace

Command SynthCommand() {
  return {
      .name = "synth",
      .summary = "write a synthetic measurement, or list the materials",
      .arguments = "[NAME[@GRID]]",
      .doing = "computing",
      .min_arguments = 0,
      .max_arguments = 1,
      .details =
          "Without NAME, lists the materials. With NAME, writes the material at the bin centres "
          "of a\nMERL .binary file (35 MB) to --out. --noise multiplies each value by log-normal "
          "noise of that\nrelative standard deviation and loses a few grazing bins, as in real "
          "measurements; the same\n--seed gives the same file. --missing leaves out a share of it "
          "at random. Wherever a "
          "SOURCE is asked\nfor, synth:NAME gives the same data without a file.\nAnisotropic "
          "materials come at the 288 x 288 pairs of directions of the UTIA database, to a FILE "
          "that\nends in .bin or .csv. @GRID is another grid: of THETASxPHIS directions, for a "
          ".csv, as synth:linen@9x36,\nwith theta every 10 and phi every 10 degrees, for isotropic "
          "materials, too; or, of isotropic ones,\nof theta_h x theta_d x phi_d bins, as "
          "synth:felt@30x30x60, for tries that take a second; no .binary\nfile holds these.",
      .flags = {"out", "noise", "missing", "corrupt", "seed", "data_seed", "threads"},
      .run = RunSynth};
}

}  // namespace trilobe
