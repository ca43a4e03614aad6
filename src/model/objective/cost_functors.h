#ifndef TRILOBE_MODEL_OBJECTIVE_COST_FUNCTORS_H_
#define TRILOBE_MODEL_OBJECTIVE_COST_FUNCTORS_H_

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/objective/parameter_blocks.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The model and its error at one sample as a functor for automatic differentiation, such as
// ceres::DynamicAutoDiffCostFunction:
//   residual_C = sqrt(w_C) (rho_C - rho*_C),  C = R, G, B                    (paper eq. 2)
//   rho_C = d_C + sum_m s_C^m D^m(theta_h) F_C(theta_d) G^m(theta_i) G^m(theta_o)
//                 / (cos theta_i cos theta_o)                                (paper eq. 3)
// for any sharing of the tables and any stencils.
class SampleResidual {
 public:
  static constexpr int kNumResiduals = kChannels;

  // `layout`, of which only the spec and the numbering are used, must outlive this. *blocks
  // receives the numbers of its blocks that the sample reads: each once, in the order in which
  // operator() expects them.
  SampleResidual(const ParameterBlocks& layout, const WeightedSample& sample,
                 std::vector<int>* blocks)
      : spec_(&layout.spec()), at_(sample.stencils), rho_(sample.rho) {
    for (int C = 0; C < kChannels; ++C) sqrt_weight_[C] = std::sqrt(sample.weight[C]);
    *blocks = {ParameterBlocks::kD};
    if (spec_->lobes == 0) return;
    blocks->push_back(ParameterBlocks::kS);
    // From here on a stencil's index is a place in *blocks. theta_i and theta_o share rows of G.
    const auto localize = [&](Factor factor, Stencil* stencil) {
      for (int k = 0; k < stencil->size; ++k) {
        const int row = layout.row(factor, stencil->index[k]);
        const auto place = std::ranges::find(*blocks, row);
        stencil->index[k] = static_cast<int>(place - blocks->begin());
        if (place == blocks->end()) blocks->push_back(row);
      }
    };
    localize(Factor::kD, &at_.D);
    for (Stencil& D : at_.more_D) localize(Factor::kD, &D);
    localize(Factor::kF, &at_.F);
    localize(Factor::kG, &at_.G_i);
    localize(Factor::kG, &at_.G_o);
  }

  // blocks[0] is d, blocks[1] is s, the others are rows of tables. Always true.
  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    const T* const d = blocks[0];
    for (int C = 0; C < kChannels; ++C) residuals[C] = d[C] - rho_[C];
    for (int m = 0; m < spec_->lobes; ++m) {
      const T* const s = blocks[1] + kChannels * m;
      T D{}, F{}, G{};  // G of both directions, over their cosines
      for (int C = 0; C < kChannels; ++C) {
        // A table that the channels share is read for the first of them.
        if (C == 0 || spec_->D.per_channel) {
          D = Read(at_.DOf(spec_->stretches.index(m)), Factor::kD, m, C, blocks);
        }
        if (C == 0 || spec_->F.per_channel) F = Read(at_.F, Factor::kF, m, C, blocks);
        if (C == 0 || spec_->G.per_channel) {
          G = Read(at_.G_i, Factor::kG, m, C, blocks) * Read(at_.G_o, Factor::kG, m, C, blocks) *
              at_.inverse_cosines;
        }
        residuals[C] += s[C] * D * F * G;
      }
    }
    for (int C = 0; C < kChannels; ++C) residuals[C] *= sqrt_weight_[C];
    return true;
  }

 private:
  template <typename T>
  T Read(const Stencil& stencil, Factor factor, int lobe, int channel,
         T const* const* blocks) const {
    const int table = spec_->table(factor, lobe, channel);
    T sum = stencil.weight[0] * blocks[stencil.index[0]][table];
    for (int k = 1; k < stencil.size; ++k) {
      sum += stencil.weight[k] * blocks[stencil.index[k]][table];
    }
    return sum;
  }

  const ModelSpec* spec_;
  SampleStencils at_;
  Rgb rho_, sqrt_weight_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_COST_FUNCTORS_H_
