#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "solvers/gaussian_filter.h"
#include "solvers/sums/cell_sums.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/folded_grid.h"
#include "trilobe/model/objective/spline_cells.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// A least-squares problem in the nodes of one table, read linearly: each sample touches a node and
// the next. Sums of w r p and of w p p, p the derivatives and r the residual.
struct ChainSums {
  std::vector<double> gradient, diagonal, beside;  // [nodes]; beside: of a node and the next

  explicit ChainSums(int nodes) : gradient(nodes), diagonal(nodes), beside(nodes) {}

  void Add(int k, double w, double r, double p0, double p1) {
    gradient[k] += w * r * p0;
    gradient[k + 1] += w * r * p1;
    diagonal[k] += w * p0 * p0;
    diagonal[k + 1] += w * p1 * p1;
    beside[k] += w * p0 * p1;
  }

  // The table after each node in turn has gone where the sum of squares is lowest, not below 0; a
  // node that no sample touches stays.
  std::vector<double> Swept(std::span<const double> table) const {
    std::vector<double> swept(table.begin(), table.end());
    for (size_t k = 0; k < swept.size(); ++k) {
      if (!(diagonal[k] > 0)) continue;
      // The next node has not moved yet.
      const double moved_before = k > 0 ? swept[k - 1] - table[k - 1] : 0;
      const double step = (gradient[k] - (k > 0 ? beside[k - 1] * moved_before : 0)) / diagonal[k];
      if (std::isfinite(step)) swept[k] = std::max(0.0, swept[k] + step);
    }
    return swept;
  }
};

// Updates of G with G and the cosines linear between the nodes, in theta_i and theta_o.
class LinearShadowing {
 public:
  explicit LinearShadowing(const FoldedGrid& folded) : folded_(folded), cosines_(folded.g_nodes) {
    const CatmullRom spline(folded.g_nodes);
    for (int k = 0; k < folded.g_nodes; ++k) cosines_[k] = std::cos(spline.NodeAngle(k));
  }

  // Puts one table where it is best as G(theta_i) with G(theta_o) held, and as G(theta_o) with
  // G(theta_i) held, on average. A folded sample stands for both orders of its directions, so that
  // the two are the same.
  void Update(int table, FactorModel* model) const {
    const ModelSpec& spec = model->spec();
    const std::vector<double> amplitudes = LobeAmplitudes(folded_.grid, *model);
    ChainSums sums(spec.g_axis.size);
    const auto [first, last] = spec.channels(Factor::kG, table);
    for (int c = first; c < last; ++c) AddChannel(table, c, *model, amplitudes, &sums);
    const std::span<double> G = model->table(Factor::kG, table);
    std::ranges::copy(sums.Swept(G), G.begin());
  }

 private:
  static double At(std::span<const double> table, int k, double v) {
    return (0.5 - v) * table[k] + (0.5 + v) * table[k + 1];
  }

  void AddChannel(int table, int c, const FactorModel& model, const std::vector<double>& amplitudes,
                  ChainSums* sums) const {
    const ModelSpec& spec = model.spec();
    const FoldedGrid& at = folded_;
    for (int row = 0; row < at.num_rows(); ++row) {
      for (int j = at.row_begin[row]; j < at.row_begin[row + 1]; ++j) {
        const int i = at.interval_i[j], o = at.interval_o[j];
        const double inverse = 1 / (At(cosines_, i, at.t_i[j]) * At(cosines_, o, at.t_o[j]));
        double rho = model.d()[c], y = 0;
        for (int m = 0; m < spec.lobes; ++m) {
          const double a = amplitudes[(c * spec.lobes + m) * at.num_rows() + row] * inverse;
          const std::span<const double> G = model.G(m, c);
          rho += a * At(G, i, at.t_i[j]) * At(G, o, at.t_o[j]);
          if (spec.serves(Factor::kG, table, m, c)) y += a;
        }
        const double w = at.weight[c][j], r = at.rho[c][j] - rho;
        const std::span<const double> G = model.table(Factor::kG, table);
        const double y_i = y * At(G, o, at.t_o[j]), y_o = y * At(G, i, at.t_i[j]);
        sums->Add(i, w, r, y_i * (0.5 - at.t_i[j]), y_i * (0.5 + at.t_i[j]));
        sums->Add(o, w, r, y_o * (0.5 - at.t_o[j]), y_o * (0.5 + at.t_o[j]));
      }
    }
  }

  const FoldedGrid& folded_;
  std::vector<double> cosines_;  // [nodes]
};

// Minimiser of a unimodal function on [0, 1], to 1e-3 (Kiefer 1953).
double GoldenSection(const std::function<double(double)>& f) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double a = 0, b = 1, x = b - ratio, y = ratio;
  double at_x = f(x), at_y = f(y);
  while (b - a > 1e-3) {
    if (at_x <= at_y) {
      b = y;
      y = x;
      at_y = at_x;
      x = b - ratio * (b - a);
      at_x = f(x);
    } else {
      a = x;
      x = y;
      at_x = at_y;
      y = a + ratio * (b - a);
      at_y = f(y);
    }
  }
  return at_x <= at_y ? x : y;
}

FactorModel Between(const FactorModel& from, const FactorModel& end, double t) {
  FactorModel result = from;
  for (size_t k = 0; k < result.parameters().size(); ++k) {
    result.parameters()[k] += t * (end.parameters()[k] - from.parameters()[k]);
  }
  return result;
}

// The fit of Bagher, Snyder, Nowrouzezahrai 2016, as far as it is known (docs/solvers.md): d, s, D
// and F as in awls; G as LinearShadowing has it, smoothed, and taken back along the line to where
// E is lowest should that have raised it.
class AwlsGss : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("awls_gss", objective, options, model);
    if (objective.folded() == nullptr) {
      throw ErrorIn(ErrorKind::kUnsupported, objective.samples().source,
                    "solver awls_gss needs samples on a MERL grid "
                    "whose bins the model's tables have, and "
                    "highlights without a stretch; use --solver=awls")
          .About("solver", "awls_gss");
    }
    CellSums cells(*objective.folded(), objective.spec());
    const LinearShadowing shadowing(*objective.folded());
    FactorModel current = *model;
    for (bool go_on = run.Start(); go_on;) {
      {
        const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
        cells.Accumulate(current, objective.num_threads());
      }
      {
        const ScopedTimer timer = run.Time(&PhaseSeconds::linear_algebra);
        cells.UpdateAll(options.on_element, &current);
      }
      const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
      const double E = UpdateG(objective, shadowing, options.g_filter_sigma, &current);
      if (options.on_element) options.on_element(current);
      go_on = run.Record(current, {.objective = E});
    }
    return run.Finish();
  }

  // Returns E.
  static double UpdateG(const Objective& objective, const LinearShadowing& shadowing, double sigma,
                        FactorModel* model) {
    const FactorModel before = *model;
    const double E = objective.Value(before);
    for (int t = 0; t < before.spec().num_tables(Factor::kG); ++t) shadowing.Update(t, model);
    if (sigma > 0) SmoothG(sigma, objective.coverage(), model);
    const FactorModel after = *model;
    double reached = objective.Value(after);
    if (reached <= E) return reached;
    *model = Between(before, after, GoldenSection([&](double t) {
                       return objective.Value(Between(before, after, t));
                     }));
    reached = objective.Value(*model);
    if (reached <= E) return reached;
    *model = before;
    return E;
  }
};

}  // namespace

SolverEntry AwlsGssEntry() {
  return {.name = "awls_gss",
          .description = "awls with G as Bagher et al. have it: linear, averaged, golden section",
          .reference = "Bagher, Snyder, Nowrouzezahrai 2016, as Peng, Zheng, Lv, section 2.3, tell",
          .options = {"g_filter_sigma"},
          .make = [] { return std::make_unique<AwlsGss>(); }};
}

}  // namespace trilobe
