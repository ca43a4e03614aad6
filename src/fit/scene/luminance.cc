#include "fit/scene/luminance.h"

#include <algorithm>

#include "model/appearance/color.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
BrdfSamples LuminanceOf(BrdfSamples samples) {
  for (Rgb& rho : samples.rho) rho.fill(Luminance(rho));
  return samples;
}

FactorModel LuminanceOf(const FactorModel& model) {
  ModelSpec spec = model.spec();
  if (spec.D.per_channel || spec.G.per_channel) {
    throw Error("a model whose D or G differ between the channels has no luminance of its form");
  }
  spec.F = {.per_lobe = true, .per_channel = false};
  FactorModel grey(spec);
  std::ranges::fill(grey.d(), Luminance({model.d()[0], model.d()[1], model.d()[2]}));
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::fill(grey.s(m), 1.0);
    const std::span<double> F = grey.table(Factor::kF, m);
    for (size_t k = 0; k < F.size(); ++k) {
      const Rgb reflected = {model.s(m)[0] * model.F(m, 0)[k], model.s(m)[1] * model.F(m, 1)[k],
                             model.s(m)[2] * model.F(m, 2)[k]};
      F[k] = Luminance(reflected);
    }
  }
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      std::ranges::copy(model.table(factor, t), grey.table(factor, t).begin());
    }
  }
  return grey;
}

}  // namespace trilobe
