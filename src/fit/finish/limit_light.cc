#include "fit/finish/limit_light.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "fit/finish/light_refit.h"
#include "fit/finish/lower_g.h"
#include "fit/finish/shown_light.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/axis.h"

namespace trilobe {
namespace {

// Bounds that stand for all of a refit, each of which is costly.
std::vector<LightBound> Thinned(std::vector<LightBound> bounds, size_t most) {
  if (bounds.size() <= most) return bounds;
  std::vector<LightBound> some;
  for (size_t k = 0; k < most; ++k) some.push_back(bounds[k * bounds.size() / most]);
  return some;
}

}  // namespace

LightLimit::LightLimit(const Objective& data, const FactorModel& fit)
    : num_threads_(data.num_threads()) {
  if (fit.spec().anisotropic()) {
    everywhere_.fill(LimitByShown(data.samples(), fit, data.num_threads()));
  } else {
    isotropic_ = AlbedoLimitsOf(data, fit);
    everywhere_ = isotropic_->everywhere;
  }
}

std::vector<LightBound> LightLimit::Exceeded(const FactorModel& model) const {
  return ExceededBounds(everywhere_, model, num_threads_);
}

bool LightLimit::LowerCoarsely(const TableLayout& layout, const StopCheck& stop,
                               FactorModel* model) const {
  return isotropic_ ? LimitAlbedo(*isotropic_, kAllAngles, layout, num_threads_, stop, model)
                    : LowerWhereExceeded(layout, stop, model);
}

bool LightLimit::LowerAtEnd(double within, const TableLayout& layout, const StopCheck& stop,
                            FactorModel* model) const {
  const Axis& g_axis = model->spec().g_axis;
  if (!isotropic_ || !(isotropic_->beyond_theta < g_axis.Theta(g_axis.size - 1))) return false;
  return LimitAlbedo(*isotropic_, isotropic_->beyond_theta - within, layout, num_threads_, stop,
                     model);
}

bool LightLimit::Lower(const TableLayout& layout, const StopCheck& stop, FactorModel* model) const {
  const bool changed = isotropic_ && LowerCoarsely(layout, stop, model);
  return LowerWhereExceeded(layout, stop, model) || changed;
}

bool LightLimit::LowerWhereExceeded(const TableLayout& layout, const StopCheck& stop,
                                    FactorModel* model) const {
  constexpr int kRounds = 8;  // as what is lowered in one place is looked at anew in all
  bool changed = false;
  for (int round = 0; round < kRounds && !stop(); ++round) {
    const std::vector<LightBound> exceeded = Exceeded(*model);
    if (exceeded.empty()) break;
    LowerToBounds(exceeded, layout, num_threads_, stop, model);
    changed = true;
  }
  return changed;
}

FactorModel LightLimit::LoweredWhereCheap(const Objective& data, const TableLayout& layout,
                                          const StopCheck& stop, const FactorModel& before) const {
  constexpr double kMaxRise = 0.05, kMaxRiseOfEnergy = 1e-3;
  FactorModel limited = before;
  if (!LowerCoarsely(layout, stop, &limited)) return before;
  const double E = data.Value(before);
  const double acceptable = E + std::max(kMaxRise * E, kMaxRiseOfEnergy * data.MeasuredEnergy());
  if (data.Value(limited) <= acceptable) return limited;
  FactorModel taken = before;
  for (const double degrees : {0, 1, 3, 6}) {
    limited = before;
    if (!LowerAtEnd(DegreesToRadians(degrees), layout, stop, &limited)) continue;
    if (data.Value(limited) > acceptable) break;
    taken = std::move(limited);
    if (Exceeded(taken).empty()) break;
  }
  return taken;
}

FactorModel LightLimit::Refitted(const Objective& data, const TableLayout& layout,
                                 const StopCheck& stop, const FactorModel& before) const {
  constexpr int kRounds = 2;
  constexpr size_t kMostBounds = 100;  // more each round
  FactorModel model = before;
  std::vector<LightBound> bounds;
  if (isotropic_) {
    for (int degree = 0; degree < 90; ++degree) {  // where a table of 90 has its nodes of G
      const double theta = DegreesToRadians(degree + 0.5);
      bounds.push_back({{theta, 0}, LimitAt(*isotropic_, theta)});
    }
    model = RefitWithinBounds(bounds, data, layout, model, stop);
  }
  for (int round = 0; round < kRounds && !isotropic_ && !stop(); ++round) {
    const std::vector<LightBound> exceeded = Exceeded(model);
    if (exceeded.empty()) break;
    std::ranges::copy(Thinned(exceeded, kMostBounds), std::back_inserter(bounds));
    model = RefitWithinBounds(bounds, data, layout, model, stop);
  }
  LowerWhereExceeded(layout, stop, &model);
  return model;
}

bool LightLimit::GlowsBeyond(const FactorModel& model) const {
  constexpr double kSeen = 1.1;  // by more than a refit misses its bounds by
  if (!isotropic_) return false;
  std::vector<LightBound> beyond;
  for (size_t k = 0; k < isotropic_->theta_i.size(); ++k) {
    const double theta = isotropic_->theta_i[k];
    if (theta > isotropic_->beyond_theta) beyond.push_back({{theta, 0}, isotropic_->beyond[k]});
  }
  std::vector<LightBound> near;
  for (const size_t k : MayExceed(beyond, kSeen, model, num_threads_)) near.push_back(beyond[k]);
  const std::vector<Rgb> albedos = AlbedosFrom(near, model, num_threads_);
  for (size_t k = 0; k < near.size(); ++k) {
    if (ExcessOf(albedos[k], near[k].limit) > kSeen) return true;
  }
  return false;
}

bool LightLimit::Keep(const Objective& data, const TableLayout& layout, const StopCheck& stop,
                      FactorModel* model) const {
  constexpr double kDear = 0.05;  // a rise of E
  // The same as a share of a black model's E: refits of two thousand parameters take minutes.
  const double dear_of_energy = isotropic_ ? 1e-5 : 1e-4;
  // Most anisotropic models keep to it, which is all that is asked of them.
  if (!isotropic_ && Exceeded(*model).empty()) return false;
  const double E = data.Value(*model);
  FactorModel kept = LoweredWhereCheap(data, layout, stop, *model);
  LowerWhereExceeded(layout, stop, &kept);
  const bool changed = !std::ranges::equal(kept.parameters(), model->parameters());
  const bool glows = GlowsBeyond(kept);
  if (!changed && !glows) return false;
  const double E_kept = data.Value(kept);
  const double cheap = E + std::max(kDear * E, dear_of_energy * data.MeasuredEnergy());
  bool is_refitted = false;
  if ((E_kept > cheap || glows) && !stop()) {
    FactorModel refitted = Refitted(data, layout, stop, *model);
    const double E_refitted = data.Value(refitted);
    is_refitted = Exceeded(refitted).empty() &&
                  (E_refitted < E_kept || (E_refitted <= cheap && !GlowsBeyond(refitted)));
    if (is_refitted) kept = std::move(refitted);
  }
  if (!changed && !is_refitted) return false;
  *model = std::move(kept);
  return true;
}

bool ReachHorizonToLimit(const LightLimit& limit, Objective* objective, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  if (!spec.g_axis.polar() || spec.g_axis.reaches_horizon()) return false;
  ModelSpec longer = spec;
  longer.g_axis = spec.g_axis.ToHorizon();
  if (longer == spec) return false;
  const double end = spec.g_axis.Theta(spec.g_axis.size - 1);
  const std::vector<LightBound> exceeded = limit.Exceeded(*model);
  if (std::ranges::none_of(exceeded, [&](const LightBound& b) { return b.at.theta > end; })) {
    return false;
  }
  FactorModel reaching(longer);
  std::ranges::copy(model->d(), reaching.d().begin());
  for (int m = 0; m < spec.lobes; ++m) std::ranges::copy(model->s(m), reaching.s(m).begin());
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto from = std::as_const(*model).table(factor, t);
      const auto to = reaching.table(factor, t);
      std::ranges::copy(from, to.begin());
      const size_t ring = spec.axis(factor).phi_nodes;
      for (size_t k = from.size(); k < to.size(); ++k) to[k] = to[k - ring];
    }
  }
  *model = std::move(reaching);
  *objective = Objective(*objective, longer);
  return true;
}

PeakAlbedo PeakLight(const FactorModel& model, int num_threads) {
  return model.spec().anisotropic() ? PeakOfLookedAt(model, num_threads)
                                    : PeakAlbedoOf(model, num_threads);
}

}  // namespace trilobe
