#ifndef TRILOBE_MODEL_MEASUREMENT_CORRUPTION_H_
#define TRILOBE_MODEL_MEASUREMENT_CORRUPTION_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

class Readings;

// A kind of instrument error that a measurement may suffer (docs/your-data.md).
struct CorruptionKind {
  std::string name;     // "noise"
  std::string unit;     // of the strength: "deg"
  double min = 0;       // of the strength
  double max = 0;       // of the strength
  double nothing = 0;   // the strength that changes nothing, or next to nothing
  std::string formula;  // one line: what becomes of rho
  void (*apply)(double strength, uint64_t seed, Readings* readings) = nullptr;
};

const std::vector<CorruptionKind>& CorruptionKinds();

struct Corruption {
  const CorruptionKind* kind = nullptr;
  double strength = 0;
};

// "KIND:STRENGTH,...", in the order in which they happen; none of an empty text. Throws Error for
// unknown kinds and for strengths out of their ranges.
std::vector<Corruption> ParseCorruptions(std::string_view text);

// Does that to the samples of a measurement, one kind after the other. Of the same seed the result
// is the same, for any number of threads. What can be read between samples is theirs from then on:
// the measurement loses its `look_up` and its `formula`. A value that overflows is lost. Throws
// Error where no sample is left, and where a kind reads between samples and the data do not allow
// that: tables do, and what has a `look_up` or a `formula`.
void Corrupt(const std::vector<Corruption>& corruptions, uint64_t seed, int num_threads,
             Measurement* measurement);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_CORRUPTION_H_
