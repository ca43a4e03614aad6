#include "fit/prune/node_elimination.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "fit/prune/reduced_quadratic.h"
#include "fit/prune/tableau.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"

namespace trilobe {
namespace {

// A stored entry of a table, in the list of those that are left.
struct Node {
  Factor factor;
  int table, entry;
  bool may_go;
  int previous = -1, next = -1;  // by number in y; -1 at the ends
  bool gone = false;
};

class Eliminator {
 public:
  Eliminator(const QuadraticModel& at_all, const FactorModel& model, const TableLayout& layout,
             const EliminationLimits& limits)
      : limits_(limits),
        reduction_(model.spec(), layout),
        scale_(reduction_.size()),
        tableau_(MakeTableau(reduction_(at_all), model)) {
    const int n = reduction_.size();
    for (int j = 0; j < n; ++j) {
      row_of_.push_back(j);
      number_of_.push_back(j);
    }
    AddNodes(model.spec(), layout);
  }

  std::vector<Elimination> Run() {
    std::vector<Elimination> order;
    if (!tableau_.valid()) return order;  // parameters so large that H overflows
    double rise = 0;
    while (static_cast<int>(order.size()) < limits_.max_count) {
      int best = -1;
      double least = std::numeric_limits<double>::infinity();
      for (int j = first_node_; j < reduction_.size(); ++j) {
        const Node& node = nodes_[j - first_node_];
        if (node.gone || !node.may_go || (node.previous < 0 && node.next < 0)) continue;
        const double rise_by_it = tableau_.Rise(ConstraintOf(j));
        if (rise_by_it < least) {
          least = rise_by_it;
          best = j;
        }
      }
      if (best < 0 || rise + least > limits_.max_rise) break;
      rise += Eliminate(best);
      rise += RestoreSigns();
      const Node& node = nodes_[best - first_node_];
      order.push_back({node.factor, node.table, node.entry, std::max(rise, 0.0)});
    }
    return order;
  }

 private:
  // In parameters z = scale y in which the diagonal of J'J is about 1.
  Tableau MakeTableau(QuadraticModel at, const FactorModel& model) {
    const int n = reduction_.size();
    const std::vector<double> y = reduction_.Restrict(model.parameters());
    scale_ = DampingMetric(reduction_.parts(), at.squared_lengths);
    for (double& s : scale_) {
      if (s == 0) s = 1;  // nothing depends on it
    }
    HoldTableSizes(reduction_.parts(), 1 + model.spec().lobes, y, scale_, &at);
    std::vector<double> z(n), A(at.H.size());
    for (int j = 0; j < n; ++j) z[j] = scale_[j] * y[j];
    const auto A_at = [&](int i, int j) -> double& { return A[static_cast<size_t>(j) * n + i]; };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        A_at(i, j) = at.H[static_cast<size_t>(j) * n + i] / (scale_[i] * scale_[j]);
      }
      A_at(j, j) += kQuadraticDamping;
    }
    Tableau tableau(std::move(A), z);
    if (!tableau.valid()) return tableau;
    for (int j = 0; j < n; ++j) {
      if (y[j] == 0 && at.gradient[j] > 0) tableau.Pivot(j);
    }
    // The model is taken for the minimum: what is left of the gradient where it is free is noise.
    for (int j = 0; j < n; ++j) {
      tableau.Set(j, tableau.free(j) ? z[j] : -at.gradient[j] / scale_[j]);
    }
    return tableau;
  }

  void AddNodes(const ModelSpec& spec, const TableLayout& layout) {
    first_node_ = reduction_.parts()[spec.lobes].begin + reduction_.parts()[spec.lobes].size;
    int j = first_node_;
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        const std::vector<int>& entries = layout.of(factor, t);
        const int begin = j, end = begin + static_cast<int>(entries.size());
        for (; j < end; ++j) {
          nodes_.push_back({.factor = factor,
                            .table = t,
                            .entry = entries[j - begin],
                            .may_go = limits_.may_thin[static_cast<int>(factor)],
                            .previous = j > begin ? j - 1 : -1,
                            .next = j + 1 < end ? j + 1 : -1});
        }
      }
    }
  }

  Node& node(int j) { return nodes_[j - first_node_]; }
  const Node& node(int j) const { return nodes_[j - first_node_]; }

  // y_j is linear between its neighbours, or equal to its only one.
  Constraint ConstraintOf(int j) const {
    const int a = node(j).previous, b = node(j).next;
    Constraint c;
    const auto add = [&](int k, double factor) { c.Add(row_of_[k], factor / scale_[k]); };
    add(j, 1);
    if (a >= 0 && b >= 0) {
      const double t =
          static_cast<double>(node(j).entry - node(a).entry) / (node(b).entry - node(a).entry);
      add(a, t - 1);
      add(b, -t);
    } else {
      add(a >= 0 ? a : b, -1);
    }
    return c;
  }

  double Eliminate(int j) {
    const Constraint c = ConstraintOf(j);
    const double rise = tableau_.Rise(c);
    if (!tableau_.free(row_of_[j])) tableau_.Pivot(row_of_[j]);
    tableau_.Impose(c);
    const int row = row_of_[j], last = number_of_[tableau_.size() - 1];
    tableau_.Remove(row);
    number_of_[row] = last;
    row_of_[last] = row;
    Node& gone = node(j);
    gone.gone = true;
    if (gone.previous >= 0) node(gone.previous).next = gone.next;
    if (gone.next >= 0) node(gone.next).previous = gone.previous;
    return rise;
  }

  // Holds parameters that went below 0, and lets go those that would rise from it; each once, so
  // that it ends. The change of the minimum.
  double RestoreSigns() {
    double change = 0;
    for (const bool free : {true, false}) {
      for (int j = 0; j < tableau_.size(); ++j) {
        if (tableau_.free(j) != free) continue;
        if (free ? tableau_.h(j) < 0 : tableau_.h(j) > 0) change += tableau_.Pivot(j);
      }
    }
    return change;
  }

  const EliminationLimits& limits_;
  const Reduction reduction_;
  std::vector<double> scale_;  // z = scale y
  Tableau tableau_;
  std::vector<int> row_of_, number_of_;  // in the tableau of a number of y, and back
  int first_node_ = 0;
  std::vector<Node> nodes_;  // of the parameters of y from the first node on
};

}  // namespace

std::vector<Elimination> OrderOfElimination(const QuadraticModel& at, const FactorModel& model,
                                            const TableLayout& layout,
                                            const EliminationLimits& limits) {
  return Eliminator(at, model, layout, limits).Run();
}

}  // namespace trilobe
