#ifndef TRILOBE_MODEL_OBJECTIVE_FOLDED_GRID_H_
#define TRILOBE_MODEL_OBJECTIVE_FOLDED_GRID_H_

#include <array>
#include <cstdint>
#include <vector>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe {

// Samples on a MERL grid, folded by symmetry (docs/sums.md). Exchanging theta_i and theta_o maps
// phi_d to 180 degrees - phi_d and leaves the model's value unchanged, so the two bins merge into
// one with
//   w = w1 + w2,  rho* = (w1 rho1 + w2 rho2) / w,
// and E = sum w (rho - rho*)^2 + constant, constant = sum w1 w2 / w (rho1 - rho2)^2.
// This halves the samples; theta_i >= theta_o in all of them.
//
// Samples form rows of equal (theta_h, theta_d), phi_d ascending, as a struct of arrays: D, F and s
// are constant in a row, and all else is read sequentially.
struct FoldedGrid {
  MerlGrid grid;
  int g_nodes = 0;

  std::vector<int> row_begin;  // [theta_h * theta_d + 1]: row (h, d) is h * theta_d + d

  // Position of theta_i and theta_o on the spline of G: interval, and t - 1/2 within it. [size]
  std::vector<int16_t> interval_i, interval_o;
  std::vector<double> t_i, t_o;
  std::vector<double> inverse_cosines;                // [size]
  std::array<std::vector<double>, kChannels> weight;  // [kChannels][size]
  std::array<std::vector<double>, kChannels> rho;     // [kChannels][size], [1/sr]
  double constant = 0;                                // the irreducible part of E
  double measured_energy = 0;                         // sum w rho*^2 of the unfolded samples

  int size() const { return row_begin.back(); }
  int num_rows() const { return grid.theta_h * grid.theta_d; }
  int max_row_size() const { return (grid.phi_d + 1) / 2; }
};

FoldedGrid Fold(const BrdfSamples& samples, int g_nodes, const Weighting& weighting,
                int num_threads);

// K = G(theta_i) G(theta_o) / (cos theta_i cos theta_o) for the samples [begin, end).
void EvaluateShadowing(const FoldedGrid& folded, const std::vector<CatmullRom::Piece>& G, int begin,
                       int end, double* K);

// E of a model. The same bits for any number of threads.
double FoldedValue(const FoldedGrid& folded, const FactorModel& model, int num_threads);

// Total weight sum w |stencil weight| of the samples that read each table entry, by channel.
struct FactorCoverage {
  std::vector<std::vector<double>> D;  // by index of the distinct stretch. [d_bins]
  std::vector<double> F, G;            // [f_bins], [g_nodes]
};
using CoverageByChannel = std::array<FactorCoverage, kChannels>;
CoverageByChannel FoldedCoverage(const FoldedGrid& folded);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_FOLDED_GRID_H_
