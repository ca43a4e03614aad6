// Writes a few small inputs for each fuzzer: make_seeds FOLDER.

#include <exception>
#include <iostream>
#include <string>

#include "tests/io/tensor_bytes.h"
#include "trilobe/io/file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/trace_file.h"

namespace trilobe {
namespace {

void WriteSeed(const std::string& folder, const std::string& name, const std::string& bytes) {
  MakeDirectories(folder);
  WriteFile(folder + "/" + name, [&](std::ostream& out) { out << bytes; });
}

std::string SmallModel(const ModelSpec& spec) {
  ModelFile file{FactorModel(spec), std::vector<bool>(spec.num_parameters(), false), {}};
  double value = 0.1;
  for (double& x : file.model.parameters()) x = value *= 1.7;
  file.dead.back() = true;
  file.fit.source = "synth:plastic";
  return FormatModel(file);
}

std::string CompactModel(const ModelSpec& spec) {
  ModelFile file{FactorModel(spec), {}, {}};
  file.layout = TableLayout::Full(spec);
  file.layout->coloured_d = file.layout->coloured_s = false;
  file.layout->of(Factor::kD, 0) = {0, 2};
  file.layout->of(Factor::kG, 0) = {1};
  return FormatModel(file);
}

void WriteSeeds(const std::string& folder) {
  // A MERL header, and the two modes of merl_fuzzer.
  const std::string header("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12);
  WriteSeed(folder + "/merl", "header", std::string("\0", 1) + header);
  WriteSeed(folder + "/merl", "whole", std::string("\xff", 1) + std::string(16, '\x3f'));

  TinyRgl rgl;
  rgl.FillRandom(1);
  WriteSeed(folder + "/rgl", "isotropic", rgl.Bytes());
  rgl.MaskAll();
  for (int row = 0; row < rgl.rgb_rows; ++row) rgl.SetMask(0, row, rgl.rgb_columns - 1, false);
  WriteSeed(folder + "/rgl", "masked", rgl.Bytes());
  rgl.valid.clear();
  rgl.phi_i = {-3.1415927F, 0, 3.1415927F};
  rgl.FillRandom(2);
  WriteSeed(folder + "/rgl", "anisotropic", rgl.Bytes());

  const MerlGrid grid{.theta_h = 4, .theta_d = 4, .phi_d = 4};
  WriteSeed(folder + "/model", "shared", SmallModel(ModelSpec::SharedFactors(2, grid)));
  WriteSeed(folder + "/model", "independent", SmallModel(ModelSpec::IndependentG(grid)));
  WriteSeed(folder + "/model", "compact", CompactModel(ModelSpec::SharedFactors(1, grid)));

  WriteSeed(folder + "/scene", "scene", R"({"format": "trilobe-scene", "version": 1,
      "directions": {"theta_i": [0, 60]}, "channels": "luminance", "budget": {"bytes": 800},
      "leave_out": {"lobes": false}, "materials": [{"name": "a", "source": "synth:felt",
      "directions": {"list": [{"theta_i": 1, "theta_o": 2, "phi": 3}]}}]})");
  WriteSeed(folder + "/scene", "histogram",
            std::string("\1\0\0\0\1\0\0\0\1\0\0\0\0\0\0\0\0\0\0\x40", 20));

  const std::string probe = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  WriteSeed(folder + "/probe", "flat", probe + "-Y 2 +X 4\n" + std::string(32, '\x90'));
  std::string packed = probe + "-Y 4 +X 8\n";
  for (int row = 0; row < 4; ++row) {
    packed += std::string("\2\2\0\x8", 4) + "\x88\x90\x82\x80\6abcdef\x88\x40\x88\x81";
  }
  WriteSeed(folder + "/probe", "packed", packed);

  const IterationRecord records[] = {{0, 0, 1e6, false},
                                     {1, 0.25, 1.0 / 3, true, true, 0.5, 1e-3},
                                     {2, 0.5, 1.0 / 3, false, false, 0, 1e-3}};
  WriteSeed(folder + "/trace", "three", FormatTrace(records));
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_seeds FOLDER\n";
    return 1;
  }
  try {
    trilobe::WriteSeeds(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "make_seeds: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
