#ifndef TRILOBE_FIT_BAND_SUMS_H_
#define TRILOBE_FIT_BAND_SUMS_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// E of each band as a function of its parameters y = [d | s (lobes) | tables of F], with D and G
// held. A sample reads the entries k and k + 1 of F, and its value is v'z with
//   v = (d, s^m F[k], s^m F[k + 1]),  z = (1, (1 - t) b^m, t b^m),  b^m = D^m G^m G^m / (cos cos),
// so E = sum over k of v'W v - 2 v'u + c, where W = sum w z z' is the same for all bands.
class BandSums {
 public:
  // Makes one pass over the samples, which must have spectra.
  BandSums(const Objective& objective, const FactorModel& rgb);

  int bands() const { return static_cast<int>(energy_.size()); }
  int lobes() const { return lobes_; }
  int num_parameters() const { return 1 + lobes_ + tables_ * entries_; }
  int num_F() const { return tables_ * entries_; }
  // d, s of each lobe, and each F.
  std::vector<FactorModel::Part> Parts() const;

  double Value(int band, std::span<const double> y) const;
  // Quadratic model of E of a band at y, with J'J in the place of the Hessian.
  QuadraticModel Linearized(int band, std::span<const double> y) const;
  // E of a black model. [bands]
  const std::vector<double>& energy() const { return energy_; }

 private:
  struct Cell {
    std::vector<double> W;  // [n][n], n = 1 + 2 lobes
    std::vector<double> u;  // [bands][n]
  };
  int TableOf(int lobe) const { return tables_ > 1 ? lobe : 0; }
  void SetV(size_t k, std::span<const double> y, std::span<double> v) const;

  int lobes_, tables_, entries_;
  size_t n_;
  std::vector<Cell> cells_;  // [entries - 1]
  std::vector<double> energy_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_BAND_SUMS_H_
