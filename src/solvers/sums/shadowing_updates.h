#ifndef TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
#define TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_

#include <array>
#include <functional>
#include <vector>

#include "solvers/sums/cached_lookups.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// Updates of G by AWLS from samples on no grid, node by node. With all else held, what a table adds
// to rho_c is a_c G_i G_o, so that of a sample's channels only two sums count,
//   A = sum w a^2,  b = sum w a (rho* - rho),
// and a node that moves by delta, and G_i G_o by p1 delta + p2 delta^2 with it, changes E by
//   A p^2 - 2 b p,  p = p1 delta + p2 delta^2,  and b by -A p.
class ShadowingUpdates {
 public:
  // Samples that read a node: as which entry of their cells of theta_i and theta_o, -1 if not.
  struct Readers {
    int begin, end, i, o;
  };

  explicit ShadowingUpdates(CachedLookups* lookups);

  // Looks at the samples, whose tables are read by this model. The same bits for any number of
  // threads.
  void Read(const FactorModel& model);

  // Puts every node of a table of that model where E is lowest with the others held, and what is
  // read of it with it; tables may follow each other. `on_element`, if set, sees the model after
  // each.
  void UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  void SetSums(int t);

  CachedLookups& lookups_;
  std::vector<std::vector<Readers>> readers_;            // [node]
  std::array<std::vector<double>, kChannels> residual_;  // rho* - rho. [samples]
  // What a table's G_i G_o is multiplied by in each channel that it serves. [tables][.][samples]
  std::vector<std::vector<std::vector<double>>> a_;
  std::vector<double> A_, b_;  // of the table that is updated. [samples]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
