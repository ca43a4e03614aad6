#ifndef TRILOBE_SOLVERS_SMOOTH_ROUGHNESS_H_
#define TRILOBE_SOLVERS_SMOOTH_ROUGHNESS_H_

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// How rough the tables of a model are: the sum of squares of second differences of their
// logarithms y, so that neither scale nor a steady fall costs anything, or the fall `slope` times
// the squares of first differences.
//   R(y) = sum_tables sum_k (y_k-1 - 2 y_k + y_k+1)^2 + slope sum_k (y_k+1 - y_k)^2
// on the MERL grid. Elsewhere divided differences stand for these, and each k counts by the width
// around it, so that R is the integral of the squared second derivative whatever the nodes are:
// over theta in degrees, for D over 90 sqrt(theta / 90 degrees). Of tables over azimuths it is the
// mean over phi of that, and the mean over theta of the same along phi, periodic. Entries that no
// data touch (coverage 0) have no part; the differences reach across them.
class Roughness {
 public:
  // `coverage`: Objective::coverage().
  Roughness(const ModelSpec& spec, std::span<const double> coverage, double slope = 0);

  // `log_parameters`: in the order of FactorModel::parameters(); of d, s and unobserved entries
  // any.
  double operator()(std::span<const double> log_parameters) const;

  // Makes E + factor R of E, to second order, with *at in the logarithms.
  void AddTo(double factor, std::span<const double> log_parameters, QuadraticModel* at) const;

  // The values of these at which R is least, all others held; nothing where that leaves one of them
  // free.
  std::optional<std::vector<double>> Interpolated(std::span<const int> parameters,
                                                  std::span<const double> log_parameters) const;

 private:
  struct Difference {
    std::array<int, 3> parameter;
    std::array<double, 3> weight;

    double operator()(std::span<const double> y) const {
      return weight[0] * y[parameter[0]] + weight[1] * y[parameter[1]] +
             weight[2] * y[parameter[2]];
    }
  };

  // Along a line of parameters at these places; with a period its end meets its beginning.
  void AddLine(std::span<const int> parameters, std::span<const double> places, double period,
               double share);

  const double slope_;
  std::vector<Difference> differences_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_ROUGHNESS_H_
