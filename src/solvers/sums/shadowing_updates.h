#ifndef TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
#define TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_

#include <array>
#include <functional>
#include <vector>

#include "solvers/sums/cached_lookups.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// Updates of G by AWLS, node by node, for samples on no grid. A table contributes a_c G_i G_o to
// rho_c, so a sample enters by two sums over its channels,
//   A = sum w a^2,  b = sum w a (rho* - rho).
// Moving a node by delta changes G_i G_o by p = p1 delta + p2 delta^2, E by A p^2 - 2 b p, and b by
// -A p.
class ShadowingUpdates {
 public:
  // A range of samples that read a node, and its index in their cells of theta_i and theta_o (-1:
  // not read).
  struct Readers {
    int begin, end, i, o;
  };

  explicit ShadowingUpdates(CachedLookups* lookups);

  // Prepares updates of this model, whose tables must have been read into the lookups. The same
  // bits for any number of threads.
  void Read(const FactorModel& model);

  // Sets every node of a table to the minimum of E with the others held, and updates the lookups.
  // May be called for several tables in turn. `on_element`, if set, sees the model after each.
  void UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  void SetSums(int t);

  CachedLookups& lookups_;
  std::vector<std::vector<Readers>> readers_;            // [node]
  std::array<std::vector<double>, kChannels> residual_;  // rho* - rho. [samples]
  // Factor of a table's G_i G_o in each channel that it serves. [tables][.][samples]
  std::vector<std::vector<std::vector<double>>> a_;
  std::vector<double> A_, b_;  // of the current table. [samples]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
