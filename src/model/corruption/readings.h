#ifndef TRILOBE_MODEL_CORRUPTION_READINGS_H_
#define TRILOBE_MODEL_CORRUPTION_READINGS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The valid samples of a measurement as an instrument read them, to be changed. What it sees is the
// signal, rho cos theta_i: a lit surface is darker where light comes at a slant.
class Readings {
 public:
  // Keeps references to both until it is gone.
  Readings(Measurement* measurement, int num_threads);

  int size() const { return static_cast<int>(rho_.size()); }
  // Of the bin or sample: a counter for random numbers, the same whatever else is valid.
  uint64_t number(int j) const { return table() ? bins_[j] : j; }

  const Rgb& rho(int j) const { return rho_[j]; }
  Rgb& rho(int j) { return rho_[j]; }
  bool lost(int j) const { return lost_[j] != 0; }
  void Lose(int j) { lost_[j] = 1; }

  // A table has one bin for both sides of the plane of incidence.
  bool folds_sides() const { return table(); }

  // The directions; those of a table, which knows no azimuths, with phi_i = 0.
  DirectionPair Directions(int j) const;
  Cosines CosinesOf(int j) const;
  double ThetaD(int j) const;

  // Of the mean over the channels; 0 of a black measurement.
  double MedianSignal() const;
  // Of all channels.
  double LargestSignal() const;

  // BRDF between samples, as it was before any was changed; nothing where a direction is below the
  // surface.
  using Between = std::function<std::optional<Rgb>(const DirectionPair&)>;
  Between ReadBetween() const;  // throws Error where the data do not allow it

  // Calls work(j) for each sample, from several threads.
  void ForEach(const std::function<void(int)>& work) const;

  // Writes what was changed into the measurement.
  void Store();

 private:
  bool table() const { return measurement_.table.has_value(); }

  Measurement& measurement_;
  const int num_threads_;
  std::vector<int> bins_;  // of a table
  std::vector<Rgb> rho_;
  std::vector<char> lost_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_CORRUPTION_READINGS_H_
