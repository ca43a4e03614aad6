// The values of a BRDF at any pairs of directions. See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "core/files/little_endian.h"
#include "experiments/program.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/node_brdf.h"

DEFINE_bool(interpolated, false,
            "of a synthetic material its measurement, linear between nodes, not its formula");
DEFINE_int32(threads, 2, "threads to use");

namespace trilobe {
namespace {

constexpr int kBlock = 4096;  // pairs: an item of work

// [pairs], from float32 [pairs][2][3], wi first.
std::vector<DirectionPair> ReadPairs(const std::string& path) {
  const std::string bytes = ReadFile(path);
  constexpr size_t kSize = 6 * sizeof(float);
  if (bytes.size() % kSize != 0) {
    throw ErrorIn(ErrorKind::kFormat, path, "not whole pairs of directions")
        .About("bytes", bytes.size());
  }
  std::vector<DirectionPair> pairs(bytes.size() / kSize);
  for (size_t k = 0; k < pairs.size(); ++k) {
    const char* const at = bytes.data() + k * kSize;
    for (int axis = 0; axis < 3; ++axis) {
      pairs[k].wi[axis] = LoadLittleEndian<float>(at + axis * sizeof(float));
      pairs[k].wo[axis] = LoadLittleEndian<float>(at + (3 + axis) * sizeof(float));
    }
    if (!(pairs[k].wi[2] > 0 && pairs[k].wo[2] > 0)) {
      throw ErrorIn(ErrorKind::kRange, path,
                    "pair " + std::to_string(k) + " is not above the surface")
          .About("pair", k);
    }
  }
  return pairs;
}

int Main(const std::string& name, const std::string& pairs_path, const std::string& out) {
  const std::vector<DirectionPair> pairs = ReadPairs(pairs_path);
  BrdfFunction brdf;
  FactorModel model;
  std::optional<NodeBrdf> nodes;
  if (IsSynthetic(name)) {
    brdf = SynthSourceOf(name).material.brdf;
    if (FLAGS_interpolated) {
      nodes = PictureDataOf(LoadMeasurement(name)).nodes;
      if (!nodes) {
        throw Error(ErrorKind::kUnsupported,
                    name + " has no azimuths; give an anisotropic material")
            .About("azimuths", name);
      }
      brdf = [&nodes](const DirectionPair& pair) { return (*nodes)(ToSphericalAngles(pair)); };
    }
  } else {
    model = ReadModel(name).model;
    brdf = [&model](const DirectionPair& pair) { return Evaluate(model, pair); };
  }
  std::vector<std::array<float, kChannels>> values(pairs.size());
  const int count = static_cast<int>(pairs.size());
  ParallelFor((count + kBlock - 1) / kBlock, FLAGS_threads, [&](int item) {
    for (int k = item * kBlock; k < std::min(count, (item + 1) * kBlock); ++k) {
      const Rgb rho = brdf(pairs[k]);
      for (int c = 0; c < kChannels; ++c) {
        values[k][c] = static_cast<float>(std::max(rho[c], 0.0));
      }
    }
  });
  WriteFile(out, [&values](std::ostream& file) {
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(values[0])));
  });
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(
      argc, argv, "brdf_values MODEL|synth:NAME PAIRS VALUES", 3,
      [](auto words) { return trilobe::Main(words[0], words[1], words[2]); });
}
