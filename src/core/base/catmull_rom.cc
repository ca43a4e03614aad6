#include "trilobe/core/base/catmull_rom.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

CatmullRom::CatmullRom(int nodes) : nodes_(nodes) {
  if (nodes < 4) {
    throw Error(ErrorKind::kRange, "a spline needs at least 4 nodes, not " + std::to_string(nodes))
        .About("nodes", nodes);
  }
}

double CatmullRom::NodeAngle(int k) const { return (k + 0.5) / nodes_ * (kPi / 2); }

CatmullRom::Location CatmullRom::Locate(double theta) const {
  if (std::isnan(theta)) {
    throw Error(ErrorKind::kRange, "a direction or an angle is not a number").About("theta", theta);
  }
  const double x = std::clamp(theta / (kPi / 2) * nodes_ - 0.5, 0.0, nodes_ - 1.0);
  const int interval = std::min(static_cast<int>(x), nodes_ - 2);
  return {interval, x - interval};
}

std::array<double, 4> CatmullRom::Weights(const Location& at) const {
  const double t = at.t, t2 = t * t, t3 = t2 * t;
  // Hermite basis: values f0, f1 at the interval's ends, slopes m0, m1 there.
  const double f0 = 2 * t3 - 3 * t2 + 1, f1 = 3 * t2 - 2 * t3;
  const double m0 = t3 - 2 * t2 + t, m1 = t3 - t2;
  std::array<double, 4> w = {0, f0, f1, 0};
  if (at.interval > 0) {  // m0 = (f1 - f_-1) / 2
    w[0] -= m0 / 2;
    w[2] += m0 / 2;
  } else {  // one-sided: m0 = f1 - f0
    w[1] -= m0;
    w[2] += m0;
  }
  if (at.interval < nodes_ - 2) {  // m1 = (f2 - f0) / 2
    w[1] -= m1 / 2;
    w[3] += m1 / 2;
  } else {  // one-sided: m1 = f1 - f0
    w[1] -= m1;
    w[2] += m1;
  }
  return w;
}

Stencil CatmullRom::StencilAt(const Location& at) const {
  const std::array<double, 4> weights = Weights(at);
  Stencil stencil;
  for (int a = 0; a < 4; ++a) {
    const int node = at.interval - 1 + a;
    if (node < 0 || node >= nodes_) continue;
    stencil.index[stencil.size] = node;
    stencil.weight[stencil.size] = weights[a];
    ++stencil.size;
  }
  return stencil;
}

std::array<CatmullRom::Cubic, 4> CatmullRom::WeightPolynomials(int interval) const {
  // Hermite basis in t^k (1 - t)^(3 - k).
  constexpr Cubic f0 = {1, 3, 0, 0}, f1 = {0, 0, 3, 1};
  constexpr Cubic m0 = {0, 1, 0, 0}, m1 = {0, 0, -1, 0};
  std::array<Cubic, 4> w{};
  const auto add = [&w](int a, double factor, const Cubic& basis) {
    for (int k = 0; k < 4; ++k) w[a][k] += factor * basis[k];
  };
  add(1, 1, f0);
  add(2, 1, f1);
  const bool first = interval == 0, last = interval == nodes_ - 2;
  add(first ? 1 : 0, first ? -1 : -0.5, m0);
  add(2, first ? 1 : 0.5, m0);
  add(1, last ? -1 : -0.5, m1);
  add(last ? 2 : 3, last ? 1 : 0.5, m1);
  return w;
}

std::vector<CatmullRom::Piece> CatmullRom::Pieces(std::span<const double> values) const {
  if (static_cast<int>(values.size()) != nodes_) {
    throw Error(ErrorKind::kMismatch, "a spline of " + std::to_string(nodes_) +
                                          " nodes needs as many values, not " +
                                          std::to_string(values.size()))
        .About("values", values.size());
  }
  // The Hermite form less its chord: a0 = m0 - (f1 - f0), a1 = (f1 - f0) - m1.
  const auto bend = [&](int k) {
    const bool end = k == 0 || k == nodes_ - 1;
    return end ? 0.0 : values[k] - (values[k - 1] + values[k + 1]) / 2;
  };
  std::vector<Piece> pieces(nodes_ - 1);
  for (int k = 0; k < nodes_ - 1; ++k) {
    pieces[k] = {values[k], values[k + 1], bend(k), bend(k + 1)};
  }
  return pieces;
}

}  // namespace trilobe
