#ifndef TRILOBE_IO_SOURCE_H_
#define TRILOBE_IO_SOURCE_H_

#include <cstdint>
#include <string>

#include "trilobe/model/brdf_table.h"

namespace trilobe {

// A measurement by the name that a user types: a path to a MERL `.binary` or RGL `*_rgb.bsdf` file
// (told apart by content), or `synth:NAME`. Noise and seed matter to `synth:` only.
// Throws Error.
struct SourceOptions {
  double noise = 0.0;  // relative standard deviation of the multiplicative noise
  uint64_t seed = 1;
  int num_threads = 1;
};
BrdfTable LoadSource(const std::string& source, const SourceOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_IO_SOURCE_H_
