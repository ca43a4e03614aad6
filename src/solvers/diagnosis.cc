#include "solvers/diagnosis.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>
#include <vector>

#include "core/algebra/symmetric_matrix.h"
#include "trilobe/core/base/check.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

std::vector<double> EigenvaluesOf(const Eigen::MatrixXd& A) {
  return SymmetricEigenvalues(static_cast<int>(A.rows()), {A.data(), A.data() + A.size()});
}

// Tables whose scale can move to s: those with a parameter that is not 0 in a column that is not 0.
int GaugeDimensions(const FactorModel& model, const std::vector<double>& squared_lengths) {
  const ModelSpec& spec = model.spec();
  int dimensions = 0;
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const int begin = model.TableOffset(factor, t);
      bool moves = false;
      for (int k = begin; k < begin + spec.table_size(factor); ++k) {
        moves = moves || (squared_lengths[k] > 0 && model.parameters()[k] > 0);
      }
      dimensions += moves;
    }
  }
  return dimensions;
}

}  // namespace

double ScaledProjectedGradient(const QuadraticModel& at, std::span<const double> x) {
  const size_t n = x.size();
  CheckSize("the gradient", at.gradient.size(), n);
  CheckSize("squared_lengths", at.squared_lengths.size(), n);
  if (!(at.objective > 0)) return 0;
  double largest = 0;
  for (size_t k = 0; k < n; ++k) {
    const double length = std::sqrt(at.squared_lengths[k]);
    if (length == 0) continue;
    const double g = at.gradient[k] / length;
    largest = std::max(largest, g > 0 ? std::min(g, x[k] * length) : -g);
  }
  return largest / std::sqrt(at.objective);
}

Diagnosis Diagnose(const Objective& objective, const FactorModel& model) {
  QuadraticModel at;
  NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
  Diagnosis diagnosis;
  diagnosis.gradient = at.gradient;
  diagnosis.optimality = ScaledProjectedGradient(at, model.parameters());
  diagnosis.observed_parameters =
      static_cast<int>(std::ranges::count_if(objective.coverage(), [](double w) { return w > 0; }));

  const int n = static_cast<int>(at.gradient.size());
  std::vector<int> moving;  // columns of J that are not 0
  for (int k = 0; k < n; ++k) {
    if (at.squared_lengths[k] > 0) moving.push_back(k);
  }
  const Eigen::Map<const Eigen::MatrixXd> JtJ(at.H.data(), n, n);
  const Eigen::VectorXd scale = JtJ.diagonal()(moving).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled =
      scale.asDiagonal() * JtJ(moving, moving).eval() * scale.asDiagonal();
  // Eigenvalues are squared singular values, each off by some n eps times the largest: below the
  // root of that no singular value can be told from 0.
  diagnosis.rank_tolerance =
      std::sqrt(std::numeric_limits<double>::epsilon() * static_cast<double>(moving.size() + 1));
  if (moving.empty() || !scaled.allFinite()) return diagnosis;
  const std::vector<double> values = EigenvaluesOf(scaled);
  const double largest = std::sqrt(values.back());
  for (const double value : values) {
    const double singular = std::sqrt(std::max(0.0, value));
    if (singular <= diagnosis.rank_tolerance * largest) continue;
    if (diagnosis.rank++ == 0) diagnosis.condition = largest / singular;
  }
  const int determinable =
      static_cast<int>(moving.size()) - GaugeDimensions(model, at.squared_lengths);
  diagnosis.unresolved = std::max(0, determinable - diagnosis.rank);
  return diagnosis;
}

int UndeterminedByThetaD(const Objective& objective) {
  const std::shared_ptr<const FoldedSamples> samples = objective.folded_samples();
  const ModelSpec& spec = objective.spec();
  if (samples == nullptr) return 0;  // every bin of F has its own samples
  const FoldedSamples::Lookup& F = samples->lookups[samples->order.F()];
  const int bins = spec.table_size(Factor::kF);
  const double eps = std::numeric_limits<double>::epsilon();
  int undetermined = 0;
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    // A table's lookups as rows, and their products, since only the rank counts.
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(bins, bins);
    const auto [begin, end] = spec.channels(Factor::kF, t);
    for (int j = 0; j < samples->size(); ++j) {
      double w = 0;
      for (int c = begin; c < end; ++c) w += samples->weight[c][j];
      if (!(w > 0)) continue;
      const Cell& cell = samples->cells_of(Factor::kF)[F.cell[j]];
      for (int a = 0; a < cell.size; ++a) {
        for (int b = 0; b < cell.size; ++b) {
          products(cell.entry[a], cell.entry[b]) += w * F.weight[a][j] * F.weight[b][j];
        }
      }
    }
    std::vector<int> read;
    for (int k = 0; k < bins; ++k) {
      if (products(k, k) > 0) read.push_back(k);
    }
    if (read.empty()) continue;
    const Eigen::VectorXd scale = products.diagonal()(read).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled =
        scale.asDiagonal() * products(read, read).eval() * scale.asDiagonal();
    const std::vector<double> values = EigenvaluesOf(scaled);
    const double zero = eps * static_cast<double>(read.size() + 1) * values.back();
    undetermined += static_cast<int>(std::ranges::upper_bound(values, zero) - values.begin());
  }
  return undetermined;
}

std::optional<std::string> ConditionWarning(const Objective& objective,
                                            const Diagnosis& diagnosis) {
  constexpr double kMargin = 10;
  std::ostringstream out;
  out.precision(2);
  const int of_F = diagnosis.unresolved > 0
                       ? std::min(diagnosis.unresolved, UndeterminedByThetaD(objective))
                       : 0;
  if (diagnosis.unresolved > 0) {
    out << "in " << diagnosis.unresolved
        << " of the fit's directions, those of scale between factors not counted, a step's normal"
           " equations cannot tell the data's pull from rounding errors (J's condition number is"
           " above "
        << 1 / diagnosis.rank_tolerance << ")";
  } else if (kMargin * diagnosis.condition * diagnosis.rank_tolerance > 1) {
    out << "J's condition number, " << diagnosis.condition
        << ", is within a factor of 10 of what a step's normal equations can resolve, "
        << 1 / diagnosis.rank_tolerance;
  } else {
    return std::nullopt;
  }
  out << ": there the damping and the starting point decide, not the data; ";
  if (of_F > 0) {
    out << of_F << " of them are bins of F beyond what the data's theta_d can tell: fit fewer bins";
  }
  if (of_F > 0 && of_F < diagnosis.unresolved) out << "; ";
  if (of_F == 0 || of_F < diagnosis.unresolved) {
    out << "fit fewer lobes, or a coarser grid by solver lm_plain, which works by QR where J is"
           " small";
  }
  return out.str();
}

}  // namespace trilobe
