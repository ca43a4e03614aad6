#ifndef TRILOBE_SOLVERS_TEXEL_SOLVER_H_
#define TRILOBE_SOLVERS_TEXEL_SOLVER_H_

#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe {

// Most materials of a TexelSolver.
inline constexpr int kMaxTexelMaterials = 6;

// Texels of a surface that consists of a few known materials, all measured in the same directions:
//   rho_C(j) = d_C + sum_b s_bC f_bC(j),   C = R, G, B,
// where f_b [1/sr] are the lobes of material b. Each texel has a diffuse term d >= 0 [1/sr] and
// strengths s >= 0 of its own: those that minimise
//   E = sum_jC w_jC (rho_C(j) - rho*_jC)^2,
// by non-negative least squares. Weights, and the level that they are relative to, are those of a
// texel alone, so that no result depends on its neighbours. Immutable and thread-safe.
class TexelSolver {
 public:
  // `lobes` are the values of f_b, of each material [samples]. Each material has one strength for
  // all channels, or with `coloured` one a channel. Throws Error unless there are at most
  // kMaxTexelMaterials, cosines are in (0, 1], and values are at most 10^50/sr.
  TexelSolver(std::vector<Cosines> cosines, std::span<const std::vector<Rgb>> lobes,
              const Weighting& weighting, bool coloured);

  int num_materials() const { return num_materials_; }
  int num_samples() const { return static_cast<int>(cosines_.size()); }

  struct Fit {
    double objective = 0;        // E
    double measured_energy = 0;  // E of the black texel
  };

  // The best d and s of a texel, [1 + num_materials()], d first. `rho` are its values in the order
  // of the cosines; samples that are negative, not finite or above 10^50/sr in any channel are left
  // out. What no sample can tell is 0. Throws Error if a size is wrong.
  Fit Solve(std::span<const Rgb> rho, std::span<Rgb> d_and_s) const;

  // w of its samples, [num_samples()], 0 of those that are left out.
  void Weigh(std::span<const Rgb> rho, std::span<Rgb> weights) const;

 private:
  static constexpr int kColumns = 1 + kMaxTexelMaterials;
  struct Sums;

  Sums SumsOf(std::span<const Rgb> rho, std::span<const Rgb> weights) const;
  void SolveByChannel(const Sums& sums, std::span<Rgb> d_and_s) const;
  void SolveTogether(const Sums& sums, std::span<Rgb> d_and_s) const;
  double Objective(std::span<const Rgb> rho, std::span<const Rgb> weights,
                   std::span<const Rgb> d_and_s) const;

  int num_materials_;
  bool coloured_;
  Weighting weighting_;
  std::vector<Cosines> cosines_;  // [samples]
  std::vector<double> columns_;   // 1 and f_b. [samples][channels][1 + materials]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_TEXEL_SOLVER_H_
