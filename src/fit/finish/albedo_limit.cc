#include "fit/finish/albedo_limit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/robust_line.h"
#include "fit/finish/albedos_of.h"
#include "fit/finish/lower_g.h"
#include "fit/finish/shown_light.h"
#include "model/objective/beyond_data.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

constexpr int kPassesBeyond = 10;

// Angles at which albedos are computed [rad]: denser where they rise steeply.
std::vector<double> Angles() {
  std::vector<double> angles;
  for (int degrees = 0; degrees < 60; degrees += 6) angles.push_back(DegreesToRadians(degrees));
  for (int degrees = 60; degrees < 90; degrees += 2) angles.push_back(DegreesToRadians(degrees));
  angles.push_back(DegreesToRadians(89.5));
  return angles;
}

// All nodes of G, since a single one may glow, and the middles between those beyond 60 degrees.
std::vector<double> NodesOf(const Axis& g_axis) {
  constexpr double kSteep = DegreesToRadians(60), kLast = DegreesToRadians(89.5);
  std::vector<double> angles;
  for (int k = 0; k < g_axis.size; ++k) {
    const double theta = g_axis.Theta(k);
    if (k > 0 && theta > kSteep) angles.push_back((g_axis.Theta(k - 1) + theta) / 2);
    angles.push_back(std::min(theta, kLast));
  }
  return angles;
}

// Linear interpolation between the angles.
double At(double theta, const std::vector<double>& angles, const std::vector<double>& values) {
  const auto after = std::ranges::upper_bound(angles, theta);
  if (after == angles.begin()) return values.front();
  if (after == angles.end()) return values.back();
  const size_t k = after - angles.begin();
  const double t = (theta - angles[k - 1]) / (angles[k] - angles[k - 1]);
  return (1 - t) * values[k - 1] + t * values[k];
}

// The least of those between the nodes beside `nodes[i]`, all of which its G reaches.
double LeastAround(const Axis& g_axis, std::span<const int> nodes, size_t i,
                   const std::vector<double>& angles, const std::vector<double>& values) {
  const double from = i > 0 ? g_axis.Theta(nodes[i - 1]) : -1;
  const double to = i + 1 < nodes.size() ? g_axis.Theta(nodes[i + 1]) : kPi;
  double least = 1;
  for (size_t k = 0; k < angles.size(); ++k) {
    if (angles[k] > from && angles[k] < to) least = std::min(least, values[k]);
  }
  return least;
}

// The directional albedo within the data, by cells of theta_i.
struct MeasuredAlbedo {
  static constexpr int kCells = 30;     // wide enough to have bins all around
  std::array<Rgb, kCells> reflected{};  // of the light from theta_i, into measured directions
  std::array<double, kCells> share{};   // of those directions, weighted by cos theta_o

  static double Theta(int cell) { return (cell + 0.5) / kCells * (kPi / 2); }
};

MeasuredAlbedo MeasuredAlbedoOf(const BrdfSamples& samples) {
  const auto cell = [](double cosine) {
    const double theta = std::acos(std::clamp(cosine, 0.0, 1.0));
    return std::min(static_cast<int>(theta / (kPi / 2) * MeasuredAlbedo::kCells),
                    MeasuredAlbedo::kCells - 1);
  };
  MeasuredAlbedo albedo;
  std::array<double, MeasuredAlbedo::kCells> all{};
  const MerlGrid& grid = samples.grid;
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin]) continue;
    const int row = bin / grid.phi_d;
    const Cosines cosines = ToCosines(grid.Center(bin));
    if (!(cosines.i > 0 && cosines.o > 0)) continue;
    all[cell(cosines.i)] +=
        grid.SolidAngle(row / grid.theta_d, row % grid.theta_d) * cosines.i * cosines.o;
  }
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    const double through = samples.SolidAngle(j) * cosines.i * cosines.o;
    const int k = cell(cosines.i);
    albedo.share[k] += through;
    for (int c = 0; c < kChannels; ++c) albedo.reflected[k][c] += through * samples.rho[j][c];
  }
  for (int k = 0; k < MeasuredAlbedo::kCells; ++k) {
    if (!(all[k] > 0)) continue;
    albedo.share[k] /= all[k];
    for (double& x : albedo.reflected[k]) x *= kPi / all[k];
  }
  return albedo;
}

// Albedo of a model fitted to scattered samples, over wo up to the largest angle of these.
MeasuredAlbedo ModelledAlbedo(const FactorModel& model, double max_theta, int num_threads) {
  constexpr int kLookedAt = 8;
  const PreparedModel<double> prepared(model);
  const double least_cosine = std::cos(max_theta);
  MeasuredAlbedo albedo;
  std::vector<double> angles;
  int end = 0;
  while (end < MeasuredAlbedo::kCells && MeasuredAlbedo::Theta(end) <= max_theta) ++end;
  const int begin = std::max(end - kLookedAt, 0);
  for (int k = begin; k < end; ++k) angles.push_back(MeasuredAlbedo::Theta(k));
  const std::vector<Rgb> reflected = DirectionalAlbedos(
      [&](const DirectionPair& pair) {
        return pair.wo[2] >= least_cosine ? prepared.Value(pair.wi, pair.wo) : Rgb{};
      },
      angles, num_threads);
  for (int k = 0; k < end; ++k) albedo.share[k] = std::pow(std::sin(max_theta), 2);
  std::ranges::copy(reflected, albedo.reflected.begin() + begin);
  return albedo;
}

// Continuation of the directional albedo beyond the data: its logarithm goes on as over the last
// cells that are measured nearly as well as any, and levels off as tables do (beyond_data.h). A
// highlight is cut in the last of them.
class ContinuedAlbedo {
 public:
  // `beyond`: the angle from which on it is asked for [rad].
  ContinuedAlbedo(const MeasuredAlbedo& measured, double beyond) {
    constexpr double kWellMeasured = 0.8, kFarthest = DegreesToRadians(12);
    constexpr int kCut = 2, kLine = 4;
    const double enough = kWellMeasured * std::ranges::max(measured.share);
    int end = 0;
    while (end < MeasuredAlbedo::kCells && measured.share[end] >= enough) ++end;
    end -= kCut;
    if (end < kLine || end + kCut >= MeasuredAlbedo::kCells - 1) return;
    from_ = MeasuredAlbedo::Theta(end - 1);
    if (beyond - from_ > kFarthest) return;  // too far to tell
    for (int c = 0; c < kChannels; ++c) {
      std::vector<double> x, y;
      for (int k = end - kLine; k < end; ++k) {
        if (!(measured.reflected[k][c] > 0)) continue;
        x.push_back(MeasuredAlbedo::Theta(k));
        y.push_back(std::log(measured.reflected[k][c] / measured.share[k]));
      }
      if (x.size() == kLine) line_[c] = FitRobustLine(x, y);
    }
  }

  // Infinite where the data go on, and for a channel that reflects nothing.
  double operator()(double theta, int c) const {
    if (!line_[c] || !(theta > from_)) return std::numeric_limits<double>::infinity();
    return std::exp(LevelledOff(*line_[c], from_, theta));
  }

 private:
  double from_ = 0;
  std::array<std::optional<RobustLine>, kChannels> line_;
};

// The last theta [rad] at which a table of G is well covered.
double LastWellCovered(std::span<const double> coverage, const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  double last = 0;
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    const auto of_table = coverage.subspan(model.TableOffset(Factor::kG, t), spec.g_axis.size);
    for (int k = 0; k < spec.g_axis.size; ++k) {
      if (of_table[k] > 0 && IsWellCovered(of_table, k)) {
        last = std::max(last, spec.g_axis.Theta(k));
      }
    }
  }
  return last;
}

// Factor of G at a stored node, from the factors that the albedo at each angle asks for.
using FactorAtNode =
    std::function<double(std::span<const int> nodes, size_t i, const std::vector<double>& factors)>;

// Lowers G above `from` until the albedo exceeds no limit there; whether anything changed.
bool LowerG(const AlbedoLimits& limits, double from, const FactorAtNode& at_node,
            const TableLayout& layout, int num_threads, const StopCheck& stop, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  const std::vector<double>& angles = limits.theta_i;
  const size_t first_beyond =
      std::ranges::upper_bound(angles, limits.beyond_theta) - angles.begin();
  const auto limit_of = [&](size_t k) -> const Rgb& {
    return k >= first_beyond ? limits.beyond[k] : limits.everywhere;
  };
  // Most angles are far within their limits, as a quick look tells.
  const auto factors_at = [&](std::span<const size_t> numbers) {
    std::vector<LightBound> bounds;
    for (const size_t k : numbers) bounds.push_back({{angles[k], 0}, limit_of(k)});
    const std::vector<size_t> near = MayExceed(bounds, 1, *model, num_threads);
    std::vector<double> theta_i;
    for (const size_t j : near) theta_i.push_back(angles[numbers[j]]);
    const std::vector<Rgb> albedos = AlbedosOf(*model, theta_i, num_threads);
    std::vector<double> factors(numbers.size(), 1.0);
    for (size_t k = 0; k < near.size(); ++k) {
      factors[near[k]] = FactorOfG(albedos[k], bounds[near[k]].limit, model->d());
    }
    return factors;
  };
  const auto lower_from = [&](double theta, const std::vector<double>& factors) {
    for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
      const std::span<double> G = model->table(Factor::kG, t);
      const std::span<const int> nodes = layout.of(Factor::kG, t);
      for (size_t i = 0; i < nodes.size(); ++i) {
        if (spec.g_axis.Theta(nodes[i]) > theta) G[nodes[i]] *= at_node(nodes, i, factors);
      }
    }
    ExpandStored(layout, model);
  };
  // First what lies beyond the data: its light may come from angles that are within, too, and then
  // it does not help.
  const bool beyond = LowerWhileExceeding(
      first_beyond, angles.size(), kPassesBeyond, stop, factors_at,
      [&](const std::vector<double>& factors) { lower_from(limits.beyond_theta, factors); });
  const size_t first = std::ranges::upper_bound(angles, from) - angles.begin();
  const bool all =
      LowerWhileExceeding(first, angles.size(), kPassesOfG, stop, factors_at,
                          [&](const std::vector<double>& factors) { lower_from(from, factors); });
  return beyond || all;
}

}  // namespace

AlbedoLimits AlbedoLimitsOf(const Objective& data, const FactorModel& model) {
  constexpr double kSlack = 1.5;  // of what goes on: Fresnel factors rise steeply
  constexpr double kMore = 1.15;  // than the mean of a cell, within it
  constexpr double kHalf = 0.5;   // of a cell
  const BrdfSamples& samples = data.samples();
  AlbedoLimits limits{.theta_i = Angles(), .beyond = {}};
  const auto raise = [&](const Rgb& reflected) {
    for (int c = 0; c < kChannels; ++c) {
      limits.everywhere[c] = std::max(limits.everywhere[c], reflected[c]);
    }
  };
  MeasuredAlbedo measured;
  double from = 0;  // the angle beyond which nothing was measured
  if (samples.on_grid()) {
    measured = MeasuredAlbedoOf(samples);
    for (const Rgb& reflected : measured.reflected) raise(reflected);
    // In other units 1 means nothing: what goes on unmeasured in a cell is its share, and more.
    double largest = 0;
    for (const Rgb& reflected : measured.reflected) {
      largest = std::max(largest, std::ranges::max(reflected));
    }
    const bool dark = largest < kMostOfUnits && IsInOtherUnits(largest);
    if (dark) limits.everywhere.fill(kOfShown * largest);
    for (int c = 0; c < kChannels && !dark; ++c) {
      if (!IsInOtherUnits(limits.everywhere[c])) continue;
      for (int k = 0; k < MeasuredAlbedo::kCells; ++k) {
        if (!(measured.share[k] >= kHalf)) continue;
        limits.everywhere[c] =
            std::max(limits.everywhere[c], kMore * measured.reflected[k][c] / measured.share[k]);
      }
    }
    from = LastWellCovered(data.coverage(), model);
  } else {
    limits.everywhere.fill(LimitByShown(samples, model, data.num_threads()));
    for (const SphericalAngles& at : samples.directions) {
      from = std::max({from, at.theta_i, at.theta_o});
    }
    measured = ModelledAlbedo(model, from, data.num_threads());
  }
  limits.beyond_theta = from;
  const ContinuedAlbedo continued(measured, from);
  for (const double theta_i : limits.theta_i) {
    Rgb limit = limits.everywhere;
    for (int c = 0; c < kChannels && theta_i > from; ++c) {
      limit[c] = std::min(limit[c], kSlack * continued(theta_i, c));
    }
    limits.beyond.push_back(limit);
  }
  return limits;
}

Rgb LimitAt(const AlbedoLimits& limits, double theta) {
  if (!(theta > limits.beyond_theta)) return limits.everywhere;
  Rgb limit;
  for (int c = 0; c < kChannels; ++c) {
    std::vector<double> of_channel;
    for (const Rgb& at : limits.beyond) of_channel.push_back(at[c]);
    limit[c] = At(theta, limits.theta_i, of_channel);
  }
  return limit;
}

PeakAlbedo PeakAlbedoOf(const FactorModel& model, int num_threads) {
  std::vector<double> angles = Angles();
  std::ranges::copy(NodesOf(model.spec().g_axis), std::back_inserter(angles));
  const std::vector<Rgb> albedos = AlbedosOf(model, angles, num_threads);
  PeakAlbedo peak;
  for (size_t k = 0; k < angles.size(); ++k) {
    const double here = std::ranges::max(albedos[k]);
    if (here > peak.albedo) peak = {.albedo = here, .theta_i = angles[k]};
  }
  return peak;
}

bool LimitAlbedo(const AlbedoLimits& limits, double from, const TableLayout& layout,
                 int num_threads, const StopCheck& stop, FactorModel* model) {
  const Axis& g_axis = model->spec().g_axis;
  const auto between = [&](std::span<const int> nodes, size_t i, const auto& factor) {
    return At(g_axis.Theta(nodes[i]), limits.theta_i, factor);
  };
  const bool lowered = LowerG(limits, from, between, layout, num_threads, stop, model);
  const std::vector<double> nodes_of_g = NodesOf(g_axis);
  const AlbedoLimits at_nodes{.theta_i = nodes_of_g,
                              .everywhere = limits.everywhere,
                              .beyond = std::vector<Rgb>(nodes_of_g.size(), limits.everywhere),
                              .beyond_theta = limits.beyond_theta};
  const auto around = [&](std::span<const int> nodes, size_t i, const auto& factor) {
    return LeastAround(g_axis, nodes, i, nodes_of_g, factor);
  };
  return LowerG(at_nodes, from, around, layout, num_threads, stop, model) || lowered;
}

}  // namespace trilobe
