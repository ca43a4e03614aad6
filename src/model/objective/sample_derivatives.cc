#include "model/objective/sample_derivatives.h"

namespace trilobe {

void SampleDerivatives::Set(const FactorModel& model, const SampleStencils& at, int c) {
  for (const int k : touched_) values_[k] = is_touched_[k] = 0;
  touched_.clear();
  Visit(model, at, c, [this](int parameter, double value) { Add(parameter, value); });
}

void SampleDerivatives::Add(int parameter, double value) {
  if (!is_touched_[parameter]) touched_.push_back(parameter);
  is_touched_[parameter] = 1;
  values_[parameter] += value;
}

}  // namespace trilobe
