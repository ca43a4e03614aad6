#ifndef TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
#define TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_

#include <array>
#include <functional>
#include <vector>

#include "solvers/sums/sample_lookups.h"
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

  // The lookups must outlive this.
  explicit ShadowingUpdates(const SampleLookups& lookups);

  // Prepares updates of this model, whose tables the lookups must have. The same bits for any
  // number of threads.
  void Read(const FactorModel& model);

  // Sets every node of a table to the minimum of E with the others held. May be called once for
  // each table, in turn. `on_element`, if set, sees the model after each node.
  void UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  // Calls use(begin, end, batch) for all batches, which hold the slopes a of a table's G_i G_o.
  // They are computed when they are needed: to keep them takes 72 bytes a sample.
  void ForSlopes(
      int t, const FactorModel& model,
      const std::function<void(int begin, int end, const SampleLookups::Batch&)>& use) const;
  void SetSums(int t, const FactorModel& model);

  const SampleLookups& lookups_;
  std::vector<std::vector<Readers>> readers_;                  // [node]
  std::array<std::vector<double>, kChannels> residual_;        // rho* - rho. [samples]
  std::vector<double> A_, b_, G_i_, G_o_, old_G_i_, old_G_o_;  // of the current table. [samples]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SHADOWING_UPDATES_H_
