#include "model/lobes/with_axes.h"

#include <algorithm>

#include "trilobe/core/base/error.h"

namespace trilobe {

FactorModel WithAxes(const FactorModel& model, const ModelSpec& spec) {
  if (spec == model.spec()) return model;  // to the bit
  ModelSpec same = model.spec();
  same.d_axis = spec.d_axis;
  same.f_axis = spec.f_axis;
  same.g_axis = spec.g_axis;
  if (!(same == spec)) throw Error("new axes are for a model with the same lobes and sharing");
  FactorModel result(spec);
  std::ranges::copy(model.d(), result.d().begin());
  for (int m = 0; m < spec.lobes; ++m) std::ranges::copy(model.s(m), result.s(m).begin());
  for (const Factor factor : kFactors) {
    const Axis &from = model.spec().axis(factor), &axis = spec.axis(factor);
    for (int k = 0; k < axis.size; ++k) {
      const Stencil at = from.At(axis.Theta(k), axis.Phi(k));
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        // A spline may undershoot.
        result.table(factor, t)[k] = std::max(at(model.table(factor, t)), 0.0);
      }
    }
  }
  return result;
}

}  // namespace trilobe
