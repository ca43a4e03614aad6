#ifndef TRILOBE_MODEL_MEASUREMENT_CORRUPTED_READINGS_H_
#define TRILOBE_MODEL_MEASUREMENT_CORRUPTED_READINGS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The valid samples of a measurement as raw readings, to be modified. An instrument sees the signal
// rho cos theta_i, which is smaller for oblique light.
class Readings {
 public:
  // Keeps a reference to `measurement`.
  Readings(Measurement* measurement, int num_threads);

  int size() const { return static_cast<int>(rho_.size()); }
  // Number of the bin or sample: a counter for random numbers that does not depend on validity.
  uint64_t number(int j) const { return table() ? bins_[j] : j; }

  const Rgb& rho(int j) const { return rho_[j]; }
  Rgb& rho(int j) { return rho_[j]; }
  bool lost(int j) const { return lost_[j] != 0; }
  void Lose(int j) { lost_[j] = 1; }

  // Whether one bin stands for both sides of the plane of incidence, as in a table.
  bool folds_sides() const { return table(); }

  // The directions; phi_i = 0 in a table, which has no azimuths.
  DirectionPair Directions(int j) const;
  Cosines CosinesOf(int j) const;
  double ThetaD(int j) const;

  // Median signal, mean over the channels; 0 for a black measurement.
  double MedianSignal() const;
  // Largest signal of all channels.
  double LargestSignal() const;

  // The unmodified BRDF, interpolated between samples; nothing if a direction is below the surface.
  using Between = std::function<std::optional<Rgb>(const DirectionPair&)>;
  Between ReadBetween() const;  // throws Error where the data do not allow it

  // Calls work(j) for each sample, from several threads.
  void ForEach(const std::function<void(int)>& work) const;

  // Writes the changes into the measurement.
  void Store();

 private:
  void ScaleSpectra();

  bool table() const { return measurement_.table.has_value(); }

  Measurement& measurement_;
  const int num_threads_;
  std::vector<int> bins_;  // of a table
  std::vector<Rgb> rho_;
  std::vector<char> lost_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_CORRUPTED_READINGS_H_
