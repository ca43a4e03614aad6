#ifndef TRILOBE_IO_SOURCE_H_
#define TRILOBE_IO_SOURCE_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "trilobe/io/synth.h"
#include "trilobe/model/brdf_table.h"

namespace trilobe {

// A measurement by the name that a user types: a path to a MERL `.binary` or RGL `*_rgb.bsdf` file
// (told apart by content), or `synth:NAME`. Noise and seed matter to `synth:` only, `extrapolated`
// to RGL files.
// Throws Error.
struct SourceOptions {
  double noise = 0.0;  // relative standard deviation of the multiplicative noise
  uint64_t seed = 1;
  int num_threads = 1;
  double max_angle_deg = 90;  // theta_i and theta_o beyond it do not count as measured
  bool extrapolated = false;  // what the authors of a file made up counts as measured
};
BrdfTable LoadSource(const std::string& source, const SourceOptions& options = {});

// Whether the source is synth:NAME, and if it is, what it names. Throws Error for an unknown NAME.
bool IsSynthetic(std::string_view source);
const SynthMaterial& SynthMaterialOf(std::string_view source);

// The measurement in the bytes of a file, whose name `source` is. Throws Error.
BrdfTable ParseSource(std::string_view bytes, const std::string& source,
                      const SourceOptions& options = {});

// What LoadSource and ParseSource do last: decides, by the options, which bins of a table that was
// read count as measured.
void DecideMeasured(const SourceOptions& options, BrdfTable* table);

}  // namespace trilobe

#endif  // TRILOBE_IO_SOURCE_H_
