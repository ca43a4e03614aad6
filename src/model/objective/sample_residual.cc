#include "trilobe/model/objective/sample_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trilobe/core/base/check.h"

namespace trilobe {

SampleResidual::SampleResidual(const ParameterBlocks& layout, const WeightedSample& sample,
                               std::vector<int>* read)
    : spec_(&layout.spec()), at_(sample.stencils), rho_(sample.rho) {
  std::vector<int>& blocks = NotNull(read, "the numbers of blocks");
  for (int c = 0; c < kChannels; ++c) {
    const double w = sample.weight[c];
    CheckNumber("the weight of a sample", w, w >= 0 && w <= std::numeric_limits<double>::max(),
                "finite and 0 or more");
    sqrt_weight_[c] = std::sqrt(w);
  }
  blocks = {ParameterBlocks::kD};
  if (spec_->lobes == 0) return;
  blocks.push_back(ParameterBlocks::kS);
  // theta_i and theta_o share rows of G.
  const auto localize = [&](Factor factor, Stencil* stencil) {
    CheckIndex(stencil->size - 1, Stencil::kMaxSize, "the last entry of a stencil");
    for (int k = 0; k < stencil->size; ++k) {
      const int row = layout.row(factor, stencil->index[k]);
      const auto place = std::ranges::find(blocks, row);
      stencil->index[k] = static_cast<int>(place - blocks.begin());
      if (place == blocks.end()) blocks.push_back(row);
    }
  };
  CheckSize("stencils of D", 1 + at_.more_D.size(), spec_->stretches.distinct().size());
  localize(Factor::kD, &at_.D);
  for (Stencil& D : at_.more_D) localize(Factor::kD, &D);
  localize(Factor::kF, &at_.F);
  localize(Factor::kG, &at_.G_i);
  localize(Factor::kG, &at_.G_o);
}

}  // namespace trilobe
