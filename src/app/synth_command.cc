#include <iostream>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/inputs.h"
#include "trilobe/app/print.h"
#include "trilobe/app/result_folder.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/source.h"
#include "trilobe/io/synth.h"

namespace trilobe {
namespace {

int RunSynth(std::span<const std::string> arguments) {
  if (arguments.empty()) {
    for (const SynthMaterial& material : SynthMaterials()) {
      std::cout << "  " << material.name << std::string(12 - material.name.size(), ' ')
                << material.description << "\n";
    }
    return 0;
  }
  const SynthMaterial& material = FindSynthMaterial(arguments[0]);
  const std::string out = RequiredMerlOut("synth");
  Inputs().CheckOutput(out);
  const SourceOptions options = SourceOptionsFromFlags();
  WriteMerl(Synthesize(material, options.noise, options.seed, {}, options.num_threads), out);
  std::cout << "wrote " << out << ": " << material.description << ", noise " << Text(options.noise)
            << ", seed " << options.seed << "\n";
  return 0;
}

}  // namespace

Command SynthCommand() {
  return {
      .name = "synth",
      .summary = "write a synthetic measurement in MERL layout, or list the materials",
      .arguments = "[NAME]",
      .min_arguments = 0,
      .max_arguments = 1,
      .details =
          "Without NAME, lists the materials. With NAME, writes the material at the bin centres "
          "of a\nMERL .binary file (35 MB) to --out. --noise multiplies each value by log-normal "
          "noise of that\nrelative standard deviation and loses a few grazing bins, as in real "
          "measurements; the same\n--seed gives the same file. Wherever a SOURCE is asked for, "
          "synth:NAME gives the same data\nwithout a file.",
      .flags = {"out", "noise", "seed", "threads"},
      .run = RunSynth};
}

}  // namespace trilobe
