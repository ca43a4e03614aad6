#ifndef TRILOBE_OBJECTIVE_SAMPLE_DERIVATIVES_H_
#define TRILOBE_OBJECTIVE_SAMPLE_DERIVATIVES_H_

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

  // Each once.
  std::span<const int> touched() const { return touched_; }
  double operator[](int parameter) const { return values_[parameter]; }

 private:
  void Add(int parameter, double value);

  std::vector<double> values_;
  std::vector<int> touched_;
  std::vector<uint8_t> is_touched_;  // of each parameter
};

}  // namespace trilobe

#endif  // TRILOBE_OBJECTIVE_SAMPLE_DERIVATIVES_H_
