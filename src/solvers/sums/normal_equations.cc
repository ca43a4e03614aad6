#include "trilobe/solvers/sums/normal_equations.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "core/system/evaluation_count.h"
#include "model/objective/sample_derivatives.h"
#include "solvers/sums/joint_rows.h"
#include "solvers/sums/joint_shadowing.h"
#include "solvers/sums/scattered_equations.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/value_of.h"

namespace trilobe {
namespace {

// H += scale d2 rho / dx2 for one sample and channel: rho is linear in each of s, D, F and in the
// two lookups of G, so only products of two different ones have any.
void AddSecondDerivatives(const FactorModel& model, const SampleStencils& at, int c, double scale,
                          std::vector<double>* H) {
  const ModelSpec& spec = model.spec();
  const size_t n = spec.num_parameters();
  struct Lookup {
    int offset;
    Stencil stencil;
    double value;
  };
  for (int m = 0; m < spec.lobes; ++m) {
    const auto lookup = [&](Factor factor, const Stencil& stencil) {
      const int t = spec.table(factor, m, c);
      return Lookup{model.TableOffset(factor, t), stencil, stencil(model.table(factor, t))};
    };
    Stencil one;
    one.size = 1;
    one.index[0] = 0;
    one.weight[0] = 1;
    const Lookup lookups[] = {{kChannels * (1 + m) + c, one, model.s(m)[c]},
                              lookup(Factor::kD, at.DOf(spec.stretches.index(m))),
                              lookup(Factor::kF, at.F),
                              lookup(Factor::kG, at.G_i),
                              lookup(Factor::kG, at.G_o)};
    for (int a = 0; a < 5; ++a) {
      for (int b = 0; b < 5; ++b) {
        if (a == b) continue;
        const auto other = [&](int e) { return e == a || e == b ? 1 : lookups[e].value; };
        const double others = scale * LobeValue(other(0), other(1), other(2),
                                                Shadowing{other(3), other(4), at.inverse_cosines});
        const Lookup &of_a = lookups[a], &of_b = lookups[b];
        for (int k = 0; k < of_a.stencil.size; ++k) {
          for (int l = 0; l < of_b.stencil.size; ++l) {
            (*H)[(of_a.offset + of_a.stencil.index[k]) * n + of_b.offset + of_b.stencil.index[l]] +=
                others * of_a.stencil.weight[k] * of_b.stencil.weight[l];
          }
        }
      }
    }
  }
}

void Clear(int num_parameters, QuadraticModel* result) {
  result->objective = 0;
  result->gradient.assign(num_parameters, 0.0);
  result->squared_lengths.assign(num_parameters, 0.0);
  result->H.assign(static_cast<size_t>(num_parameters) * num_parameters, 0.0);
}

// An unobserved bin may have collected rounding errors.
void ClearUnobservedParameters(std::span<const double> coverage, QuadraticModel* result) {
  const size_t n = coverage.size();
  for (size_t k = 0; k < n; ++k) {
    if (coverage[k] > 0) continue;
    result->gradient[k] = result->squared_lengths[k] = 0;
    for (size_t l = 0; l < n; ++l) result->H[k * n + l] = result->H[l * n + k] = 0;
  }
}

}  // namespace

void EvaluateReference(const Objective& objective, const FactorModel& model, Hessian hessian,
                       QuadraticModel* result) {
  const int n = model.spec().num_parameters();
  Clear(n, result);
  result->objective = objective.Value(model);
  SampleDerivatives derivatives(n);
  for (const WeightedSample& sample : objective.weighted_samples()) {
    for (int c = 0; c < kChannels; ++c) {
      const double w = sample.weight[c];
      const double residual = UnclampedValue(model, sample.stencils, c) - sample.rho[c];
      derivatives.Set(model, sample.stencils, c);
      for (const int k : derivatives.touched()) {
        const double w_k = w * derivatives[k];
        result->gradient[k] += w_k * residual;
        double* const row = &result->H[static_cast<size_t>(k) * n];
        for (const int l : derivatives.touched()) row[l] += w_k * derivatives[l];
        result->squared_lengths[k] += w_k * derivatives[k];
      }
      if (hessian == Hessian::kNewton) {
        AddSecondDerivatives(model, sample.stencils, c, w * residual, &result->H);
      }
    }
  }
  ClearUnobservedParameters(objective.coverage(), result);
}

// In a row (theta_h, theta_d) and channel rho = sum_a x_a phi_a as in CellSums, with x_m = s D F.
// JointRows has all products with d, s, D and F, JointShadowing those of G with itself.
class NormalEquations::Condensed {
 public:
  Condensed(const FoldedGrid& folded, const SplineCells& cells, const ModelSpec& spec)
      : rows_(folded, spec), shadowing_(cells, spec) {}

  void Evaluate(const FactorModel& model, Hessian hessian, int num_threads,
                QuadraticModel* result) {
    rows_.Evaluate(model, hessian, num_threads, result);
    shadowing_.Evaluate(model, hessian, num_threads, result);
    MirrorTriangle(Triangle::kUpper, model.spec().num_parameters(), result->H.data());
  }

 private:
  JointRows rows_;
  JointShadowing shadowing_;
};

NormalEquations::NormalEquations(const Objective& objective) : objective_(objective) {
  if (objective.folded() == nullptr) {
    fold_ = objective.folded_samples();
    of_samples_ =
        std::make_unique<ScatteredEquations>(*fold_, objective.spec(), objective.num_threads());
  } else {
    condensed_ = std::make_unique<Condensed>(*objective.folded(), objective.spline_cells(),
                                             objective.spec());
  }
}

NormalEquations::~NormalEquations() = default;

void NormalEquations::Evaluate(const FactorModel& model, Hessian hessian, QuadraticModel* result) {
  CheckSameSpec(model.spec(), objective_.spec());
  NotNull(result, "the result");
  CountDerivatives(1);
  if (condensed_ != nullptr) {
    Clear(model.spec().num_parameters(), result);
    condensed_->Evaluate(model, hessian, objective_.num_threads(), result);
  } else {
    of_samples_->Evaluate(model, hessian, result);
  }
  ClearUnobservedParameters(objective_.coverage(), result);
}

}  // namespace trilobe
