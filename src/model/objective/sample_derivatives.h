#ifndef TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_
#define TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_

#include <cstdint>
#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/value_of.h"

namespace trilobe {

// d rho / dx of one sample and channel: which parameters, and by how much. For few samples; sums
// over many are in sums/.
class SampleDerivatives {
 public:
  explicit SampleDerivatives(int num_parameters)
      : values_(num_parameters, 0.0), is_touched_(num_parameters, 0) {}

  void Set(const FactorModel& model, const SampleStencils& at, int channel) {
    for (const int k : touched_) values_[k] = is_touched_[k] = 0;
    touched_.clear();
    Visit(model, at, channel, [this](int parameter, double value) { Add(parameter, value); });
  }

  // The same in parts: calls add(parameter, value), often more than once for a parameter.
  template <typename Visitor>
  static void Visit(const FactorModel& model, const SampleStencils& at, int channel,
                    const Visitor& add);

  // Parameters with a derivative, each once.
  std::span<const int> touched() const { return touched_; }
  double operator[](int parameter) const { return values_[parameter]; }

 private:
  void Add(int parameter, double value) {
    if (!is_touched_[parameter]) touched_.push_back(parameter);
    is_touched_[parameter] = 1;
    values_[parameter] += value;
  }

  std::vector<double> values_;
  std::vector<int> touched_;
  std::vector<uint8_t> is_touched_;  // of each parameter
};

template <typename Visitor>
void SampleDerivatives::Visit(const FactorModel& model, const SampleStencils& at, int c,
                              const Visitor& add) {
  add(c, 1.0);
  const ModelSpec& spec = model.spec();
  const ModelReads reads{model, at};
  for (int m = 0; m < spec.lobes; ++m) {
    const double s = reads.s(m, c), D = reads.D(m, c), F = reads.F(m, c);
    const Shadowing G = reads.G(m, c);
    const double K = 1.0 * G;
    add(kChannels * (1 + m) + c, LobeValue(1.0, D, F, K));
    const auto add_table = [&](Factor factor, const Stencil& stencil, double scale) {
      const int offset = model.TableOffset(factor, spec.table(factor, m, c));
      for (int k = 0; k < stencil.size; ++k) {
        add(offset + stencil.index[k], stencil.weight[k] * scale);
      }
    };
    add_table(Factor::kD, at.DOf(spec.stretches.index(m)), LobeValue(s, 1.0, F, K));
    add_table(Factor::kF, at.F, LobeValue(s, D, 1.0, K));
    add_table(Factor::kG, at.G_i, LobeValue(s, D, F, Shadowing{1, G.o, G.inverse_cosines}));
    add_table(Factor::kG, at.G_o, LobeValue(s, D, F, Shadowing{G.i, 1, G.inverse_cosines}));
  }
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SAMPLE_DERIVATIVES_H_
