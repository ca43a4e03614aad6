#include "model/objective/lobes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

void CheckLobe(const FactorModel& model, int lobe) {
  if (lobe >= 0 && lobe < model.spec().lobes) return;
  throw Error(ErrorKind::kRange, "there is no lobe " + std::to_string(lobe) + ": the model has " +
                                     std::to_string(model.spec().lobes))
      .About("lobe", lobe);
}

// Sum of s in the channels of a table.
double Size(const FactorModel& model, int lobe, ModelSpec::ChannelRange channels) {
  double sum = 0;
  for (int c = channels.begin; c < channels.end; ++c) sum += model.s(lobe)[c];
  return sum;
}

// Solid angle of an entry of D, up to a constant factor.
double SolidAngle(const Axis& axis, int entry) {
  if (axis.polar()) return axis.CellOf(entry).SolidAngle();
  const MerlGrid grid{.theta_h = axis.size};
  return std::sin(grid.ThetaH(entry + 0.5)) * (grid.ThetaH(entry + 1) - grid.ThetaH(entry));
}

// Entries from the centre of a lobe outwards: by theta_h or, if the lobe may be asymmetric, by D.
std::vector<int> Outwards(const Axis& axis, std::span<const double> D) {
  std::vector<int> order(axis.size);
  std::iota(order.begin(), order.end(), 0);
  if (axis.polar()) std::ranges::stable_sort(order, std::greater(), [&](int k) { return D[k]; });
  return order;
}

// The fraction of each entry that stays in the narrow part: a smooth step from 1 to 0 at the entry
// that halves the integral of sqrt(D). The root gives weight to the flanks of a lobe, for the
// second lobe.
std::vector<double> NarrowShare(const Axis& axis, std::span<const double> D) {
  constexpr double kSteepness = 8;
  std::vector<double> u(axis.size);
  double sum = 0;
  for (const int h : Outwards(axis, D)) {
    sum += std::sqrt(D[h]) * SolidAngle(axis, h);
    u[h] = sum;
  }
  for (double& x : u) {
    const double fraction = sum > 0 ? x / sum : 0.5;
    x = 1 / (1 + std::exp(kSteepness * (fraction - 0.5)));
  }
  return u;
}

}  // namespace

FactorModel WithLobes(const FactorModel& model, std::span<const int> lobes) {
  for (const int lobe : lobes) CheckLobe(model, lobe);
  ModelSpec spec = model.spec();
  spec.lobes = static_cast<int>(lobes.size());
  spec.stretches = spec.stretches.Select({lobes.begin(), lobes.end()});
  FactorModel result(spec);
  std::ranges::copy(model.d(), result.d().begin());
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::copy(model.s(lobes[m]), result.s(m).begin());
    for (const Factor factor : kFactors) {
      for (int c = 0; c < kChannels; ++c) {
        std::ranges::copy(model.table(factor, model.spec().table(factor, lobes[m], c)),
                          result.table(factor, spec.table(factor, m, c)).begin());
      }
    }
  }
  return result;
}

FactorModel WithStretches(const FactorModel& model, const Stretches& stretches) {
  ModelSpec spec = model.spec();
  spec.stretches = stretches;
  FactorModel result(spec);
  std::ranges::copy(model.parameters(), result.parameters().begin());
  return result;
}

FactorModel WithoutLobe(const FactorModel& model, int lobe) {
  CheckLobe(model, lobe);
  std::vector<int> others(model.spec().lobes);
  std::iota(others.begin(), others.end(), 0);
  others.erase(others.begin() + lobe);
  return WithLobes(model, others);
}

FactorModel WithLobesMerged(const FactorModel& model, int lobe, int other) {
  CheckLobe(model, lobe);
  CheckLobe(model, other);
  if (lobe == other) {
    throw Error(ErrorKind::kConflict, "a lobe cannot be merged with itself").About("lobe", lobe);
  }
  const ModelSpec& spec = model.spec();
  FactorModel merged = model;
  for (const Factor factor : kFactors) {
    if (!spec.sharing(factor).per_lobe) continue;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto channels = spec.channels(factor, t);
      if (!spec.serves(factor, t, lobe, channels.begin)) continue;
      const double mine = Size(model, lobe, channels), others = Size(model, other, channels);
      const double share = mine + others > 0 ? others / (mine + others) : 0;
      const auto with = model.table(factor, spec.table(factor, other, channels.begin));
      const auto target = merged.table(factor, t);
      for (size_t k = 0; k < target.size(); ++k) target[k] += share * (with[k] - target[k]);
    }
  }
  for (int c = 0; c < kChannels; ++c) merged.s(lobe)[c] += model.s(other)[c];
  return WithoutLobe(merged, other);
}

FactorModel SplitLobe(const FactorModel& model, int lobe) {
  if (!model.spec().D.per_lobe) {
    throw Error(ErrorKind::kUnsupported, "lobes that share D cannot be split").About("lobe", lobe);
  }
  const int added = model.spec().lobes;
  std::vector<int> lobes(added);
  std::iota(lobes.begin(), lobes.end(), 0);
  lobes.push_back(lobe);
  FactorModel result = WithLobes(model, lobes);
  const ModelSpec& spec = result.spec();
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    for (int c = 0; c < kChannels; ++c) {
      if (spec.table(Factor::kD, lobe, c) != t) continue;
      const std::vector<double> share = NarrowShare(spec.d_axis, result.table(Factor::kD, t));
      const std::span<double> narrow = result.table(Factor::kD, t);
      const std::span<double> wide = result.table(Factor::kD, spec.table(Factor::kD, added, c));
      for (size_t h = 0; h < share.size(); ++h) {
        wide[h] = (1 - share[h]) * narrow[h];
        narrow[h] -= wide[h];
      }
      break;  // one channel stands for all that share the table
    }
  }
  return result;
}

int StrongestLobe(const FactorModel& canonical) {
  int strongest = 0;
  double most = 0;
  for (int m = 0; m < canonical.spec().lobes; ++m) {
    const std::span<const double> s = canonical.s(m);
    const double sum = std::accumulate(s.begin(), s.end(), 0.0);
    if (sum > most) {
      most = sum;
      strongest = m;
    }
  }
  return strongest;
}

FactorModel WithAxes(const FactorModel& model, const ModelSpec& spec) {
  if (spec == model.spec()) return model;  // to the bit
  ModelSpec same = model.spec();
  same.d_axis = spec.d_axis;
  same.f_axis = spec.f_axis;
  same.g_axis = spec.g_axis;
  if (!(same == spec)) {
    throw Error(ErrorKind::kMismatch, "new axes are for a model with the same lobes and sharing")
        .About("spec");
  }
  FactorModel result(spec);
  std::ranges::copy(model.d(), result.d().begin());
  for (int m = 0; m < spec.lobes; ++m) std::ranges::copy(model.s(m), result.s(m).begin());
  for (const Factor factor : kFactors) {
    const Axis &from = model.spec().axis(factor), &axis = spec.axis(factor);
    for (int k = 0; k < axis.size; ++k) {
      const Stencil at = from.At(axis.Theta(k), axis.Phi(k));
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        // A spline may undershoot.
        result.table(factor, t)[k] = std::max(at(model.table(factor, t)), 0.0);
      }
    }
  }
  return result;
}

}  // namespace trilobe
