#include "fit/band_sums.h"

#include <algorithm>
#include <array>

#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/value_of.h"

namespace trilobe {

BandSums::BandSums(const Objective& objective, const FactorModel& rgb)
    : lobes_(rgb.spec().lobes),
      tables_(rgb.spec().F.per_lobe ? lobes_ : std::min(lobes_, 1)),
      entries_(rgb.spec().table_size(Factor::kF)),
      n_(1 + 2 * static_cast<size_t>(lobes_)),
      cells_(entries_ - 1),
      energy_(objective.samples().spectra->bands(), 0.0) {
  const BrdfSamples& samples = objective.samples();
  for (Cell& cell : cells_) {
    cell.W.assign(n_ * n_, 0.0);
    cell.u.assign(energy_.size() * n_, 0.0);
  }
  std::vector<double> z(n_);
  for (int j = 0; j < samples.size(); ++j) {
    const WeightedSample sample = objective.Sample(j);
    const double w = Mean(sample.weight);
    const SampleStencils& at = sample.stencils;
    const int k = std::min(at.F.index[0], entries_ - 2);
    const ModelReads reads{rgb, at};
    z[0] = 1;
    for (int m = 0; m < lobes_; ++m) {
      const double b = LobeValue(1.0, reads.D(m, 0), 1.0, reads.G(m, 0));
      z[1 + m] = at.F.WeightOf(k) * b;
      z[1 + lobes_ + m] = at.F.WeightOf(k + 1) * b;
    }
    Cell& cell = cells_[k];
    for (size_t a = 0; a < n_; ++a) {
      for (size_t b = 0; b < n_; ++b) cell.W[a * n_ + b] += w * z[a] * z[b];
    }
    const std::span<const double> rho = samples.SpectrumOf(j);
    for (size_t l = 0; l < energy_.size(); ++l) {
      for (size_t a = 0; a < n_; ++a) cell.u[l * n_ + a] += w * rho[l] * z[a];
      energy_[l] += w * rho[l] * rho[l];
    }
  }
}

std::vector<FactorModel::Part> BandSums::Parts() const {
  std::vector<FactorModel::Part> parts;
  for (int p = 0; p <= lobes_; ++p) parts.push_back({p, 1});
  for (int t = 0; t < tables_; ++t) parts.push_back({1 + lobes_ + t * entries_, entries_});
  return parts;
}

void BandSums::SetV(size_t k, std::span<const double> y, std::span<double> v) const {
  v[0] = y[0];
  for (int m = 0; m < lobes_; ++m) {
    const double* const F = &y[1 + lobes_ + static_cast<size_t>(TableOf(m)) * entries_ + k];
    v[1 + m] = y[1 + m] * F[0];
    v[1 + lobes_ + m] = y[1 + m] * F[1];
  }
}

double BandSums::Value(int band, std::span<const double> y) const {
  std::vector<double> v(n_);
  double E = energy_[band];
  for (size_t k = 0; k < cells_.size(); ++k) {
    const Cell& cell = cells_[k];
    SetV(k, y, v);
    for (size_t a = 0; a < n_; ++a) {
      double W_v = 0;
      for (size_t b = 0; b < n_; ++b) W_v += cell.W[a * n_ + b] * v[b];
      E += v[a] * (W_v - 2 * cell.u[band * n_ + a]);
    }
  }
  return E;
}

QuadraticModel BandSums::Linearized(int band, std::span<const double> y) const {
  const auto size = static_cast<size_t>(num_parameters());
  QuadraticModel at{.objective = Value(band, y),
                    .gradient = std::vector<double>(size, 0.0),
                    .H = std::vector<double>(size * size, 0.0),
                    .squared_lengths = std::vector<double>(size)};
  // For each entry of v: the parameters that it is a product of, and its derivatives by these.
  struct Derivative {
    size_t by;
    double value;
  };
  std::vector<std::array<Derivative, 2>> dv(n_);
  std::vector<double> v(n_);
  for (size_t k = 0; k < cells_.size(); ++k) {
    const Cell& cell = cells_[k];
    SetV(k, y, v);
    dv[0] = {{{0, 1}, {0, 0}}};
    for (int m = 0; m < lobes_; ++m) {
      for (const size_t upper : {0, 1}) {
        const size_t F = 1 + lobes_ + static_cast<size_t>(TableOf(m)) * entries_ + k + upper;
        dv[1 + m + upper * lobes_] = {{{static_cast<size_t>(1 + m), y[F]}, {F, y[1 + m]}}};
      }
    }
    for (size_t a = 0; a < n_; ++a) {
      double residual = -cell.u[band * n_ + a];
      for (size_t b = 0; b < n_; ++b) {
        const double W = cell.W[a * n_ + b];
        residual += W * v[b];
        for (const Derivative& p : dv[a]) {
          for (const Derivative& q : dv[b]) at.H[p.by * size + q.by] += p.value * W * q.value;
        }
      }
      for (const Derivative& p : dv[a]) at.gradient[p.by] += p.value * residual;
    }
  }
  for (size_t p = 0; p < size; ++p) at.squared_lengths[p] = at.H[p * size + p];
  return at;
}

}  // namespace trilobe
