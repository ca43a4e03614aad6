#include "trilobe/solvers/texel_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/algebra/nonnegative_least_squares.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

static_assert(kChannels + kMaxTexelMaterials <= kMaxNonnegativeUnknowns);

constexpr double kMaxBrdf = 1e50;  // beyond which squares might overflow

bool IsValid(const Rgb& rho) {
  return std::ranges::all_of(rho, [](double x) { return x >= 0 && x <= kMaxBrdf; });
}

void CheckSize(size_t size, size_t wanted, const std::string& what) {
  if (size == wanted) return;
  throw Error(ErrorKind::kMismatch, what + " has " + std::to_string(size) +
                                        " entries, and must have " + std::to_string(wanted))
      .About(what, size);
}

}  // namespace

// Sums of the normal equations, by channel; the first unknown is d.
struct TexelSolver::Sums {
  std::array<std::array<std::array<double, kColumns>, kColumns>, kChannels> H{};
  std::array<std::array<double, kColumns>, kChannels> g{};
  Rgb energy{};
};

TexelSolver::TexelSolver(std::vector<Cosines> cosines, std::span<const std::vector<Rgb>> lobes,
                         const Weighting& weighting, bool coloured)
    : num_materials_(static_cast<int>(lobes.size())),
      coloured_(coloured),
      weighting_(weighting),
      cosines_(std::move(cosines)) {
  if (lobes.size() > kMaxTexelMaterials) {
    throw Error(ErrorKind::kRange, "there are " + std::to_string(lobes.size()) +
                                       " materials; give at most " +
                                       std::to_string(kMaxTexelMaterials))
        .About("materials", lobes.size());
  }
  if (!weighting.formula) {
    throw Error(ErrorKind::kMissing, "weighting '" + weighting.name + "' has no formula")
        .About("weighting", weighting.name);
  }
  for (const Cosines& cosine : cosines_) {
    const auto above = [](double x) { return x > 0 && x <= 1; };
    if (!above(cosine.i) || !above(cosine.o)) {
      throw Error(ErrorKind::kRange, "a direction is below the surface").About("direction");
    }
  }
  const size_t width = 1 + lobes.size();
  columns_.assign(cosines_.size() * kChannels * width, 1);
  for (size_t b = 1; b < width; ++b) {
    CheckSize(lobes[b - 1].size(), cosines_.size(), "a material");
    for (size_t j = 0; j < cosines_.size(); ++j) {
      for (size_t c = 0; c < kChannels; ++c) {
        const double f = lobes[b - 1][j][c];
        if (!(std::abs(f) <= kMaxBrdf)) {
          throw Error(ErrorKind::kData, "a material's value overflows").About("material", f);
        }
        columns_[(j * kChannels + c) * width + b] = f;
      }
    }
  }
}

void TexelSolver::Weigh(std::span<const Rgb> rho, std::span<Rgb> weights) const {
  CheckSize(rho.size(), cosines_.size(), "a texel");
  CheckSize(weights.size(), cosines_.size(), "an array of weights");
  double light = 0, reflected = 0;
  for (size_t j = 0; j < rho.size(); ++j) {
    if (!IsValid(rho[j])) continue;
    const double through = cosines_[j].i * cosines_[j].o;
    light += through;
    reflected += through * Mean(rho[j]);
  }
  const double level = light > 0 ? reflected / light : 0;
  for (size_t j = 0; j < rho.size(); ++j) {
    weights[j] = IsValid(rho[j])
                     ? weighting_.formula({.rho = rho[j], .cosines = cosines_[j]}, level)
                     : Rgb{};
  }
}

TexelSolver::Fit TexelSolver::Solve(std::span<const Rgb> rho, std::span<Rgb> d_and_s) const {
  CheckSize(d_and_s.size(), 1 + num_materials_, "d and s");
  std::vector<Rgb> weights(rho.size());
  Weigh(rho, weights);
  const Sums sums = SumsOf(rho, weights);
  std::ranges::fill(d_and_s, Rgb{});
  coloured_ ? SolveByChannel(sums, d_and_s) : SolveTogether(sums, d_and_s);
  return {.objective = Objective(rho, weights, d_and_s),
          .measured_energy = sums.energy[0] + sums.energy[1] + sums.energy[2]};
}

TexelSolver::Sums TexelSolver::SumsOf(std::span<const Rgb> rho,
                                      std::span<const Rgb> weights) const {
  const int width = 1 + num_materials_;
  Sums sums;
  const double* column = columns_.data();
  for (size_t j = 0; j < rho.size(); ++j) {
    for (int c = 0; c < kChannels; ++c, column += width) {
      const double w = weights[j][c];
      if (w == 0) continue;
      for (int a = 0; a < width; ++a) {
        const double w_f = w * column[a];
        sums.g[c][a] += w_f * rho[j][c];
        for (int b = 0; b <= a; ++b) sums.H[c][a][b] += w_f * column[b];
      }
      sums.energy[c] += w * rho[j][c] * rho[j][c];
    }
  }
  for (auto& H : sums.H) {
    for (int a = 0; a < width; ++a) {
      for (int b = 0; b < a; ++b) H[b][a] = H[a][b];
    }
  }
  return sums;
}

void TexelSolver::SolveByChannel(const Sums& sums, std::span<Rgb> d_and_s) const {
  const size_t size = d_and_s.size();
  for (int c = 0; c < kChannels; ++c) {
    std::array<double, kColumns * kColumns> H{};
    std::array<double, kColumns> x{};
    for (size_t a = 0; a < size; ++a) std::copy_n(sums.H[c][a].begin(), size, &H[a * size]);
    SolveNonnegativeLeastSquares({H.data(), size * size}, {sums.g[c].data(), size}, sums.energy[c],
                                 {x.data(), size});
    for (size_t a = 0; a < size; ++a) d_and_s[a][c] = x[a];
  }
}

// Unknowns are d of each channel, then a strength a material.
void TexelSolver::SolveTogether(const Sums& sums, std::span<Rgb> d_and_s) const {
  const size_t size = kChannels + num_materials_;
  std::array<double, kMaxNonnegativeUnknowns * kMaxNonnegativeUnknowns> H{};
  std::array<double, kMaxNonnegativeUnknowns> g{}, x{};
  double energy = 0;
  const auto place = [](int channel, int a) { return a == 0 ? channel : kChannels + a - 1; };
  for (int c = 0; c < kChannels; ++c) {
    for (int a = 0; a <= num_materials_; ++a) {
      g[place(c, a)] += sums.g[c][a];
      for (int b = 0; b <= num_materials_; ++b) {
        H[place(c, a) * size + place(c, b)] += sums.H[c][a][b];
      }
    }
    energy += sums.energy[c];
  }
  SolveNonnegativeLeastSquares({H.data(), size * size}, {g.data(), size}, energy, {x.data(), size});
  for (int c = 0; c < kChannels; ++c) {
    for (int a = 0; a <= num_materials_; ++a) d_and_s[a][c] = x[place(c, a)];
  }
}

double TexelSolver::Objective(std::span<const Rgb> rho, std::span<const Rgb> weights,
                              std::span<const Rgb> d_and_s) const {
  double objective = 0;
  const double* column = columns_.data();
  for (size_t j = 0; j < rho.size(); ++j) {
    for (int c = 0; c < kChannels; ++c, column += d_and_s.size()) {
      if (weights[j][c] == 0) continue;
      double residual = -rho[j][c];
      for (size_t a = 0; a < d_and_s.size(); ++a) residual += d_and_s[a][c] * column[a];
      objective += weights[j][c] * residual * residual;
    }
  }
  return objective;
}

}  // namespace trilobe
