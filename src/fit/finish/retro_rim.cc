#include "fit/finish/retro_rim.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

constexpr double kFirst = DegreesToRadians(50), kLast = DegreesToRadians(89.5);
constexpr double kHorizon = DegreesToRadians(88);  // of data that end there

// r of a model at half degrees, and its limit.
class RetroLight {
 public:
  RetroLight(const Objective& data, const FactorModel& model) {
    constexpr double kSlack = 1.5;
    for (int k = 0;; ++k) {
      theta_.push_back(kFirst + k * DegreesToRadians(0.5));
      if (theta_.back() > kLast) break;
    }
    limit_ = OfSamples(data.samples());
    if (std::ranges::max(limit_) == 0) {
      const double end = EndOf(data.samples());
      const std::vector<Rgb> r = Of(model);
      for (size_t k = 0; k < r.size() && theta_[k] <= end; ++k) {
        for (int c = 0; c < kChannels; ++c) limit_[c] = std::max(limit_[c], r[k][c]);
      }
    }
    for (double& x : limit_) x *= kSlack;
  }

  const std::vector<double>& theta() const { return theta_; }

  std::vector<Rgb> Of(const FactorModel& model) const {
    const PreparedModel<double> prepared(model);
    std::vector<Rgb> r;
    for (const double theta : theta_) {
      const Direction w = {std::sin(theta), 0, std::cos(theta)};
      r.push_back(prepared.Value(w, w));
      for (double& x : r.back()) x *= w[2];
    }
    return r;
  }

  // r over the limit where the eye would see it: of the brightest channel, as what is left of the
  // others is a tint.
  double Over(const Rgb& r) const {
    constexpr double kSeen = 0.01 / kPi;
    const double brightest = std::ranges::max(r), most = std::ranges::max(limit_);
    return brightest > kSeen && most > 0 ? brightest / most : 0;
  }

  // The factor of D that brings r to its limit, of which the diffuse term is a part.
  double FactorOfD(const Rgb& r, double theta, const FactorModel& model) const {
    const double most = std::ranges::max(limit_), diffuse = DiffuseAt(theta, model),
                 brightest = std::ranges::max(r);
    if (!(brightest > most) || !(most > diffuse)) return 1;
    return (most - diffuse) / (brightest - diffuse);
  }

 private:
  static double DiffuseAt(double theta, const FactorModel& model) {
    return std::ranges::max(model.d()) * std::cos(theta);
  }

  static double EndOf(const BrdfSamples& samples) {
    double end = 0;
    for (int j = 0; j < samples.size(); ++j) {
      const Cosines cosines = samples.CosinesOf(j);
      end = std::max(end, std::acos(std::min(cosines.i, cosines.o)));
    }
    return end;
  }

  // The largest mean over a degree of theta_h.
  static Rgb OfSamples(const BrdfSamples& samples) {
    constexpr double kNear = DegreesToRadians(12);
    std::vector<Rgb> sum(91);
    std::vector<int> count(91);
    for (int j = 0; j < samples.size(); ++j) {
      const HalfDiffAngles at = samples.Angles(j);
      if (at.theta_d > kNear || at.theta_h < kFirst) continue;
      const int degree = std::clamp(static_cast<int>(RadiansToDegrees(at.theta_h)), 0, 90);
      ++count[degree];
      for (int c = 0; c < kChannels; ++c) {
        sum[degree][c] += samples.rho[j][c] * std::cos(at.theta_h);
      }
    }
    Rgb largest{};
    for (size_t k = 0; k < sum.size(); ++k) {
      for (int c = 0; c < kChannels && count[k] > 0; ++c) {
        largest[c] = std::max(largest[c], sum[k][c] / count[k]);
      }
    }
    return largest;
  }

  std::vector<double> theta_;  // [rad]
  Rgb limit_{};
};

// Whether the data go on to the horizon. A whole table tells so by its first samples.
bool ReachHorizon(const BrdfSamples& samples) {
  const double least = std::cos(kHorizon);
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    if (std::min(cosines.i, cosines.o) < least) return true;
  }
  return false;
}

RetroRim RimOf(const RetroLight& light, const std::vector<Rgb>& r) {
  RetroRim rim;
  for (size_t k = 0; k < r.size(); ++k) {
    const double over = light.Over(r[k]);
    if (over > rim.over_limit) rim = {.over_limit = over, .theta = light.theta()[k]};
  }
  return rim;
}

// The least factor of angles next to a stored node of D: as near as its own bin or, where
// `between`, as the stored nodes beside it.
double LeastAround(const Axis& axis, std::span<const int> nodes, size_t i, bool between,
                   const std::vector<double>& theta, const std::vector<double>& factors) {
  const bool is_last = i + 1 == nodes.size();
  const int before = between && i > 0 ? nodes[i - 1] : std::max(nodes[i] - 1, 0);
  const int after = between && !is_last ? nodes[i + 1] : std::min(nodes[i] + 1, axis.size - 1);
  double least = 1;
  for (size_t k = 0; k < theta.size(); ++k) {
    const bool is_after = theta[k] < axis.Theta(after) || (is_last && between);
    if (theta[k] > axis.Theta(before) && is_after) least = std::min(least, factors[k]);
  }
  return least;
}

}  // namespace

RetroRim RetroRimOf(const Objective& data, const FactorModel& model) {
  if (model.spec().anisotropic()) return {};
  const RetroLight light(data, model);
  return RimOf(light, light.Of(model));
}

std::optional<FactorModel> WithoutRetroRim(
    const Objective& data, const FactorModel& model, const TableLayout& layout,
    const std::function<bool(const FactorModel&)>& acceptable, const StopCheck& stop) {
  constexpr int kPasses = 12, kByOwnBin = 6;
  const ModelSpec& spec = model.spec();
  if (spec.anisotropic()) return std::nullopt;
  if (ReachHorizon(data.samples())) return std::nullopt;
  const RetroLight light(data, model);
  std::vector<Rgb> r = light.Of(model);
  if (!RimOf(light, r).is_seen()) return std::nullopt;
  FactorModel dimmed = model;
  for (int pass = 0; pass < kPasses && !stop(); ++pass) {
    std::vector<double> factors;
    for (size_t k = 0; k < r.size(); ++k) {
      factors.push_back(light.FactorOfD(r[k], light.theta()[k], dimmed));
    }
    if (std::ranges::min(factors) > 0.99) break;
    for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
      const std::span<const int> nodes = layout.of(Factor::kD, t);
      for (size_t i = 0; i < nodes.size(); ++i) {
        dimmed.table(Factor::kD, t)[nodes[i]] *=
            LeastAround(spec.d_axis, nodes, i, pass >= kByOwnBin, light.theta(), factors);
      }
    }
    ExpandStored(layout, &dimmed);
    r = light.Of(dimmed);
  }
  if (RimOf(light, r).is_seen() || stop() || !acceptable(dimmed)) return std::nullopt;
  return dimmed;
}

}  // namespace trilobe
