#include "objective/sample_derivatives.h"

namespace trilobe {

void SampleDerivatives::Set(const FactorModel& model, const SampleStencils& at, int c) {
  for (const int k : touched_) values_[k] = is_touched_[k] = 0;
  touched_.clear();
  Add(c, 1);
  const ModelSpec& spec = model.spec();
  for (int m = 0; m < spec.lobes; ++m) {
    const Stencil& D_stencil = at.DOf(spec.stretches.index(m));
    const double s = model.s(m)[c], D = D_stencil(model.D(m, c)), F = at.F(model.F(m, c));
    const double G_i = at.G_i(model.G(m, c)), G_o = at.G_o(model.G(m, c));
    const double K = G_i * G_o * at.inverse_cosines;
    Add(kChannels * (1 + m) + c, D * F * K);
    const auto add_table = [&](Factor factor, const Stencil& stencil, double scale) {
      const int offset = model.TableOffset(factor, spec.table(factor, m, c));
      for (int k = 0; k < stencil.size; ++k) {
        Add(offset + stencil.index[k], stencil.weight[k] * scale);
      }
    };
    add_table(Factor::kD, D_stencil, s * F * K);
    add_table(Factor::kF, at.F, s * D * K);
    add_table(Factor::kG, at.G_i, s * D * F * G_o * at.inverse_cosines);
    add_table(Factor::kG, at.G_o, s * D * F * G_i * at.inverse_cosines);
  }
}

void SampleDerivatives::Add(int parameter, double value) {
  if (!is_touched_[parameter]) touched_.push_back(parameter);
  is_touched_[parameter] = 1;
  values_[parameter] += value;
}

}  // namespace trilobe
