#include "trilobe/model/reconstruct.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/error.h"
#include "trilobe/base/parallel.h"
#include "trilobe/model/catmull_rom.h"
#include "trilobe/model/folded_grid.h"

namespace trilobe {
namespace {

// Samples that one item of work evaluates.
constexpr int kChunk = 1 << 14;

// Evaluate(model, GridStencils(...)) with what does not depend on the bin done once: every spline
// is turned into cubics, so that a bin costs two arc cosines and two cubics a G table.
class GridEvaluator {
 public:
  GridEvaluator(const FactorModel& model, const MerlGrid& grid)
      : model_(model),
        grid_(grid),
        spline_(model.spec().g_nodes),
        cosine_(CosinePieces(spline_)),
        g_(ShadowingPieces(model)) {}

  Rgb operator()(int bin) const {
    const int h = bin / (grid_.theta_d * grid_.phi_d), d = bin / grid_.phi_d % grid_.theta_d;
    const Cosines cosines = ToCosines(grid_.Center(bin));
    const CatmullRom::Location i = spline_.Locate(std::acos(cosines.i));
    const CatmullRom::Location o = spline_.Locate(std::acos(cosines.o));
    const auto product = [&](const std::vector<CatmullRom::Piece>& spline) {
      return spline[i.interval](i.t - 0.5) * spline[o.interval](o.t - 0.5);
    };
    const double inverse_cosines = 1 / product(cosine_);
    const ModelSpec& spec = model_.spec();
    double g_products[kMaxLobes * kChannels];  // [G table]
    for (size_t t = 0; t < g_.size(); ++t) g_products[t] = product(g_[t]) * inverse_cosines;
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = model_.d()[c];
      for (int m = 0; m < spec.lobes; ++m) {
        rho[c] += model_.s(m)[c] * model_.D(m, c)[h] * model_.F(m, c)[d] *
                  g_products[spec.table(Factor::kG, m, c)];
      }
    }
    return rho;
  }

 private:
  const FactorModel& model_;
  MerlGrid grid_;
  CatmullRom spline_;
  std::vector<CatmullRom::Piece> cosine_;          // [interval]
  std::vector<std::vector<CatmullRom::Piece>> g_;  // [G table][interval]
};

}  // namespace

std::vector<Rgb> EvaluateSamples(const FactorModel& model, const BrdfSamples& samples,
                                 int num_threads) {
  const ModelSpec& spec = model.spec();
  const bool own_bins = samples.on_grid() && samples.grid.theta_h == spec.d_bins &&
                        samples.grid.theta_d == spec.f_bins;
  const GridEvaluator at_bin(model, samples.grid);
  std::vector<Rgb> rho(samples.rho.size());
  ParallelFor((samples.size() + kChunk - 1) / kChunk, num_threads, [&](int chunk) {
    const int end = std::min(samples.size(), (chunk + 1) * kChunk);
    for (int j = chunk * kChunk; j < end; ++j) {
      if (own_bins) {
        rho[j] = at_bin(samples.bins[j]);
      } else {
        const SampleStencils stencils = ScatteredStencils(spec, samples.Angles(j));
        for (int c = 0; c < kChannels; ++c) rho[j][c] = Evaluate(model, stencils, c);
      }
    }
  });
  return rho;
}

BrdfTable Reconstruct(const FactorModel& model, const std::string& source, const MerlGrid& grid,
                      int num_threads) {
  BrdfSamples samples{source, grid, {}, {}, {}};
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (above[bin]) samples.bins.push_back(bin);
  }
  samples.rho.resize(samples.bins.size());
  const std::vector<Rgb> rho = EvaluateSamples(model, samples, num_threads);
  BrdfTable table = MakeInvalidTable(source, grid);
  for (int j = 0; j < samples.size(); ++j) {
    for (int c = 0; c < kChannels; ++c) {
      table.SetValue(c, samples.bins[j], std::max(rho[j][c], 0.0));
      if (!std::isfinite(table.stored[c][samples.bins[j]])) {
        throw Error(source + ": the model's value overflows at bin " +
                    std::to_string(samples.bins[j]) + "; its factors are too large");
      }
    }
  }
  return table;
}

}  // namespace trilobe
