#include "model/measurement/note_symptoms.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "model/measurement/sample_symptoms.h"
#include "model/measurement/symptoms.h"

namespace trilobe {

namespace {

// Nothing is bright, and something was measured.
bool IsDark(const Measurement& measurement) {
  bool is_dark = true, measured = false;
  const auto add = [&](double x) {
    is_dark &= !(x > 0);
    measured |= x == 0;
  };
  if (measurement.table) {
    for (const auto& plane : measurement.table->stored) std::ranges::for_each(plane, add);
  } else {
    for (const Rgb& rho : measurement.samples.rho) std::ranges::for_each(rho, add);
  }
  return is_dark && measured;
}

}  // namespace

void NoteSymptoms(int num_threads, Measurement* measurement) {
  if (IsDark(*measurement)) {
    measurement->notes.emplace_back(
        "all values are 0, and a fit to them is black: see that the file was written whole" +
        std::string(measurement->table ? "" : ", and which column holds the values (--columns)"));
    return;
  }
  const std::vector<std::string> told = measurement->table
                                            ? SymptomsOf(*measurement->table, num_threads)
                                            : SymptomsOfSamples(*measurement);
  std::ranges::copy(told, std::back_inserter(measurement->notes));
}

bool AllAreZero(const BrdfSamples& samples) {
  return std::ranges::all_of(samples.rho, [](const Rgb& rho) { return rho == Rgb{}; });
}

}  // namespace trilobe
