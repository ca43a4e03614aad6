#include "fit/finish/lower_g.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "trilobe/core/base/angles.h"
#include "trilobe/model/axis.h"

namespace trilobe {
namespace {

constexpr double kDiffuseShare = 0.9;  // of a limit, where the diffuse term alone exceeds it

// The least factor of those around a stored node: between the nodes beside it, whose G reaches
// there.
double LeastAround(const Axis& axis, std::span<const int> nodes, size_t i,
                   const std::vector<LightBound>& bounds, std::span<const double> factors) {
  const size_t ring = axis.phi_nodes;
  const double from = i >= ring ? axis.Theta(nodes[i - ring]) : -1;
  const double to = i + ring < nodes.size() ? axis.Theta(nodes[i + ring]) : kPi;
  const double wide = 2 * kPi / axis.phi_nodes;
  double least = 1;
  for (size_t k = 0; k < bounds.size(); ++k) {
    const auto [theta, phi] = bounds[k].at;
    if (!(theta > from && theta < to)) continue;
    if (axis.polar()) {
      const double turn = std::abs(std::remainder(phi - axis.Phi(nodes[i]), 2 * kPi));
      if (!(turn < wide)) continue;
    }
    least = std::min(least, factors[k]);
  }
  return least;
}

}  // namespace

double FactorOfG(const Rgb& albedo, const Rgb& limit, std::span<const double> d) {
  double factor = 1;
  for (int c = 0; c < kChannels; ++c) {
    const double diffuse = kPi * d[c];
    if (!(albedo[c] > (1 + kLightTolerance) * limit[c]) || !(limit[c] > diffuse)) continue;
    factor = std::min(factor, std::sqrt((limit[c] - diffuse) / (albedo[c] - diffuse)));
  }
  return factor;
}

bool LowerWhileExceeding(size_t begin, size_t end, int passes, const StopCheck& stop,
                         const FactorsAt& factors_at, const LowerBy& lower_by) {
  std::vector<size_t> exceeding(end - begin);
  std::iota(exceeding.begin(), exceeding.end(), begin);
  bool changed = false;
  for (int pass = 0; pass < passes && !stop(); ++pass) {
    const std::vector<double> asked = factors_at(exceeding);
    std::vector<double> factors(end, 1.0);
    std::vector<size_t> left;
    for (size_t j = 0; j < exceeding.size(); ++j) {
      if (!(asked[j] < 1)) continue;
      factors[exceeding[j]] = asked[j];
      left.push_back(exceeding[j]);
    }
    if (left.empty()) break;
    lower_by(factors);
    exceeding = std::move(left);
    changed = true;
  }
  return changed;
}

void LowerToBounds(const std::vector<LightBound>& bounds, const TableLayout& layout,
                   int num_threads, const StopCheck& stop, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  for (const LightBound& bound : bounds) {
    for (int c = 0; c < kChannels; ++c) {
      if (kPi * model->d()[c] < bound.limit[c]) continue;
      model->d()[c] = kDiffuseShare * bound.limit[c] / kPi;
    }
  }
  const auto factors_at = [&](std::span<const size_t> numbers) {
    std::vector<LightBound> some;
    for (const size_t k : numbers) some.push_back(bounds[k]);
    const std::vector<Rgb> albedos = AlbedosFrom(some, *model, num_threads);
    std::vector<double> factors;
    for (size_t j = 0; j < some.size(); ++j) {
      factors.push_back(FactorOfG(albedos[j], some[j].limit, model->d()));
    }
    return factors;
  };
  const auto lower_by = [&](const std::vector<double>& factors) {
    for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
      const std::span<const int> nodes = layout.of(Factor::kG, t);
      for (size_t i = 0; i < nodes.size(); ++i) {
        model->table(Factor::kG, t)[nodes[i]] *=
            LeastAround(spec.g_axis, nodes, i, bounds, factors);
      }
    }
    ExpandStored(layout, model);
  };
  LowerWhileExceeding(0, bounds.size(), kPassesOfG, stop, factors_at, lower_by);
}

}  // namespace trilobe
