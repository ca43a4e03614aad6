#ifndef TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_
#define TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_

#include <cstdint>
#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// d rho / dx of one sample and channel: which parameters, and by how much. For few samples; sums
// over many are in sums/.
class SampleDerivatives {
 public:
  explicit SampleDerivatives(int num_parameters)
      : values_(num_parameters, 0.0), is_touched_(num_parameters, 0) {}

  void Set(const FactorModel& model, const SampleStencils& at, int channel);

  // The same in parts: calls add(parameter, value), often more than once for a parameter.
  template <typename Visitor>
  static void Visit(const FactorModel& model, const SampleStencils& at, int channel,
                    const Visitor& add);

  // Each once.
  std::span<const int> touched() const { return touched_; }
  double operator[](int parameter) const { return values_[parameter]; }

 private:
  void Add(int parameter, double value);

  std::vector<double> values_;
  std::vector<int> touched_;
  std::vector<uint8_t> is_touched_;  // of each parameter
};

template <typename Visitor>
void SampleDerivatives::Visit(const FactorModel& model, const SampleStencils& at, int c,
                              const Visitor& add) {
  add(c, 1.0);
  const ModelSpec& spec = model.spec();
  for (int m = 0; m < spec.lobes; ++m) {
    const Stencil& D_stencil = at.DOf(spec.stretches.index(m));
    const double s = model.s(m)[c], D = D_stencil(model.D(m, c)), F = at.F(model.F(m, c));
    const double G_i = at.G_i(model.G(m, c)), G_o = at.G_o(model.G(m, c));
    const double K = G_i * G_o * at.inverse_cosines;
    add(kChannels * (1 + m) + c, D * F * K);
    const auto add_table = [&](Factor factor, const Stencil& stencil, double scale) {
      const int offset = model.TableOffset(factor, spec.table(factor, m, c));
      for (int k = 0; k < stencil.size; ++k) {
        add(offset + stencil.index[k], stencil.weight[k] * scale);
      }
    };
    add_table(Factor::kD, D_stencil, s * F * K);
    add_table(Factor::kF, at.F, s * D * K);
    add_table(Factor::kG, at.G_i, s * D * F * G_o * at.inverse_cosines);
    add_table(Factor::kG, at.G_o, s * D * F * G_i * at.inverse_cosines);
  }
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_
