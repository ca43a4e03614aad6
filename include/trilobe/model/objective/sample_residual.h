#ifndef TRILOBE_MODEL_OBJECTIVE_SAMPLE_RESIDUAL_H_
#define TRILOBE_MODEL_OBJECTIVE_SAMPLE_RESIDUAL_H_

#include <array>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/parameter_blocks.h"
#include "trilobe/model/value_of.h"

namespace trilobe {

// The error of the model at one sample, a cost functor for automatic differentiation by Ceres:
//   residual_C = sqrt(w_C) (rho_C - rho*_C),  C = R, G, B                    (paper eq. 2)
//   rho_C = d_C + sum_m s_C^m D^m(theta_h) F_C(theta_d) G^m(theta_i) G^m(theta_o)
//                 / (cos theta_i cos theta_o)                                (paper eq. 3)
// for any sharing of the tables and any stencils. rho is in 1/sr, and the squares of the residuals
// of all samples add up to E (Objective::Value). How many blocks a sample reads differs from one to
// the next, so the cost function is a dynamic one:
//
//   ParameterBlocks blocks(objective.spec());
//   blocks.Read(start);
//   for (const WeightedSample& sample : objective.weighted_samples()) {
//     std::vector<int> read;
//     auto* cost = new ceres::DynamicAutoDiffCostFunction<SampleResidual>(
//         new SampleResidual(blocks, sample, &read));
//     cost->SetNumResiduals(SampleResidual::kNumResiduals);
//     std::vector<double*> parameters;
//     for (const int b : read) {
//       cost->AddParameterBlock(static_cast<int>(blocks.block(b).size()));
//       parameters.push_back(blocks.block(b).data());
//     }
//     problem.AddResidualBlock(cost, nullptr, parameters);
//   }
//
// docs/ceres.md has a whole program.
class SampleResidual {
 public:
  static constexpr int kNumResiduals = kChannels;

  // *read receives the numbers of the blocks that the sample reads, each once, in the order in
  // which operator() expects them: d, s and rows of tables; d alone where the spec has no lobes. Of
  // `layout`, which must outlive this at its place, only spec and numbering are used. Throws Error
  // where the sample reads entries that the spec does not have, or has a weight that is no number
  // >= 0.
  SampleResidual(const ParameterBlocks& layout, const WeightedSample& sample,
                 std::vector<int>* read);

  // blocks[k] are the parameters of block (*read)[k]; there are three residuals. Always true.
  // Allocates nothing.
  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    const T* const d = blocks[0];
    const std::array<T, kChannels> difference = ValueOf<T>(
        *spec_, {d[0] - rho_[0], d[1] - rho_[1], d[2] - rho_[2]}, Reads<T>{*this, blocks});
    for (int c = 0; c < kChannels; ++c) residuals[c] = difference[c] * sqrt_weight_[c];
    return true;
  }

 private:
  template <typename T>
  struct Reads {
    const SampleResidual& of;
    T const* const* blocks;

    const T& s(int m, int c) const { return blocks[1][kChannels * m + c]; }
    T D(int m, int c) const {
      return Sum(of.at_.DOf(of.spec_->stretches.index(m)), of.spec_->table(Factor::kD, m, c));
    }
    T F(int m, int c) const { return Sum(of.at_.F, of.spec_->table(Factor::kF, m, c)); }
    T G(int m, int c) const {
      const int table = of.spec_->table(Factor::kG, m, c);
      return Sum(of.at_.G_i, table) * Sum(of.at_.G_o, table) * of.at_.inverse_cosines;
    }
    T Sum(const Stencil& stencil, int table) const {
      T sum = stencil.weight[0] * blocks[stencil.index[0]][table];
      for (int k = 1; k < stencil.size; ++k) {
        sum += stencil.weight[k] * blocks[stencil.index[k]][table];
      }
      return sum;
    }
  };

  const ModelSpec* spec_;
  SampleStencils at_;  // where an index is a place in *read
  Rgb rho_, sqrt_weight_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SAMPLE_RESIDUAL_H_
