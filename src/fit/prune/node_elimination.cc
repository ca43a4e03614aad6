#include "fit/prune/node_elimination.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "core/base/multiversion.h"
#include "fit/prune/reduced_quadratic.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"

namespace trilobe {
namespace {

// to += sum_p factor[p] rows[p], for `count` rows, a multiple of 4, one after the other in memory.
TRILOBE_MULTIVERSION void AddRows(int size, size_t stride, int count, const double* factor,
                                  const double* rows, double* target) {
  for (int p = 0; p < count; p += 4) {
    const double *const a = rows + p * stride, *const b = a + stride, *const c = b + stride,
                        *const d = c + stride;
    const double f = factor[p], g = factor[p + 1], h = factor[p + 2], i = factor[p + 3];
#pragma omp simd
    for (int k = 0; k < size; ++k) target[k] += f * a[k] + g * b[k] + h * c[k] + i * d[k];
  }
}

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
    tableau_.ImposeConstraint(c);
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

Tableau::Tableau(std::vector<double> A, std::vector<double> z)
    : stride_(z.size()),
      size_(static_cast<int>(z.size())),
      T_(std::move(A)),
      U_(stride_ * kMaxWaiting),
      V_(stride_ * kMaxWaiting),
      h_(std::move(z)),
      free_(stride_, true) {
  valid_ = FactorCholesky(size_, T_.data());
  if (valid_) InvertFactored(size_, T_.data());
}

double Tableau::Pivot(int k) {
  const double pivot = At(k, k), scale = 1 / std::abs(pivot), h_k = h_[k];
  std::vector<double>& t = t_;
  t.resize(size_);
  for (int i = 0; i < size_; ++i) t[i] = At(k, i);
  t[k] = 0;
  AddOuterProduct(-1 / pivot);
  for (int i = 0; i < size_; ++i) {
    h_[i] -= t[i] * h_k / pivot;
    T_[i * stride_ + k] = T_[k * stride_ + i] = t[i] * scale;
  }
  T_[k * stride_ + k] = -1 / pivot;
  // Pending updates have nothing to add there.
  std::fill_n(U_.begin() + k * kMaxWaiting, kMaxWaiting, 0.0);
  std::fill_n(V_.begin() + k * kMaxWaiting, kMaxWaiting, 0.0);
  h_[k] = h_k * scale;
  free_[k] = !free_[k];
  return h_k * h_k / pivot;
}

double Tableau::Rise(const Constraint& c) const {
  double value = 0, variance = 0;
  for (const Term& a : c) {
    if (!free_[a.row]) continue;
    value += a.factor * h_[a.row];
    for (const Term& b : c) {
      if (free_[b.row]) variance += a.factor * b.factor * At(a.row, b.row);
    }
  }
  const int first = c.begin()->row;
  double release = 0;
  if (!free_[first]) {
    // If it would go below 0, the others of the constraint have to be 0 with it.
    const double sigma = -At(first, first);
    double follow = c.begin()->factor;
    for (const Term& a : c) {
      if (free_[a.row]) follow += a.factor * At(first, a.row);
    }
    value += follow * h_[first] / sigma;
    variance += follow * follow / sigma;
    release = h_[first] * h_[first] / sigma;
    if (!(variance > 0)) return 0;
    const double held = follow / sigma * (1 / c.begin()->factor);
    const double z = h_[first] / sigma - held * value / variance;
    if (z * c.begin()->factor < 0) {
      double rise = 0;
      for (const Term& a : c) {
        if (free_[a.row] && h_[a.row] > 0) rise += h_[a.row] * h_[a.row] / At(a.row, a.row);
      }
      return rise;
    }
  }
  return variance > 0 ? value * value / variance - release : 0;
}

void Tableau::ImposeConstraint(const Constraint& c) {
  t_.assign(size_, 0.0);
  double value = 0, variance = 0;
  for (const Term& a : c) {
    if (!free_[a.row]) continue;
    value += a.factor * h_[a.row];
    for (int i = 0; i < size_; ++i) t_[i] += a.factor * At(a.row, i);
  }
  for (const Term& a : c) {
    if (free_[a.row]) {
      variance += a.factor * t_[a.row];
    } else {
      t_[a.row] += a.factor;
    }
  }
  if (!(variance > 0)) return;
  AddOuterProduct(-1 / variance);
  for (int i = 0; i < size_; ++i) h_[i] -= t_[i] * value / variance;
}

void Tableau::Remove(int k) {
  const int last = --size_;
  for (int i = 0; i <= last; ++i) T_[k * stride_ + i] = T_[last * stride_ + i];
  for (int i = 0; i < last; ++i) T_[i * stride_ + k] = T_[i * stride_ + last];
  T_[k * stride_ + k] = T_[last * stride_ + last];
  for (std::vector<double>* const rows : {&U_, &V_}) {
    std::copy_n(rows->begin() + last * kMaxWaiting, kMaxWaiting, rows->begin() + k * kMaxWaiting);
  }
  h_[k] = h_[last];
  free_[k] = free_[last];
}

void Tableau::AddOuterProduct(double factor) {
  for (int i = 0; i < size_; ++i) {
    U_[i * kMaxWaiting + waiting_] = t_[i];
    V_[i * kMaxWaiting + waiting_] = factor * t_[i];
  }
  if (++waiting_ < kMaxWaiting) return;
  std::vector<double> rows(kMaxWaiting * stride_);  // V'
  for (int i = 0; i < size_; ++i) {
    for (int p = 0; p < kMaxWaiting; ++p) rows[p * stride_ + i] = V_[i * kMaxWaiting + p];
  }
  for (int i = 0; i < size_; ++i) {
    AddRows(size_, stride_, kMaxWaiting, U_.data() + i * kMaxWaiting, rows.data(),
            T_.data() + i * stride_);
  }
  waiting_ = 0;
}

std::vector<Elimination> OrderOfElimination(const QuadraticModel& at, const FactorModel& model,
                                            const TableLayout& layout,
                                            const EliminationLimits& limits) {
  return Eliminator(at, model, layout, limits).Run();
}

}  // namespace trilobe
