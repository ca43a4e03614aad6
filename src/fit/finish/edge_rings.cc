#include "fit/finish/edge_rings.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "fit/finish/albedos_of.h"
#include "fit/finish/edge_course.h"
#include "fit/finish/factored_albedos.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/axis.h"

namespace trilobe {
namespace {

// The largest theta_d [rad] of what samples read of F.
double EndOfF(const Objective& data, const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  double last = 0;
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    const int offset = model.TableOffset(Factor::kF, t);
    for (int k = 0; k < spec.f_axis.size; ++k) {
      if (data.coverage()[offset + k] > 0) last = std::max(last, spec.f_axis.Theta(k));
    }
  }
  return last;
}

// Angles at which rings are looked for, those of a course from 61 degrees on, the first of which
// are only what is beside them.
constexpr int kPerDegree = 2, kAround = 4 * kPerDegree, kFirstOfRings = (61 - 50) * kPerDegree;

std::vector<double> AnglesOfRings() {
  const std::vector<double> of_course = AnglesOfCourse();
  return {of_course.begin() + kFirstOfRings, of_course.end()};
}

// The highest ring of albedos at these angles.
EdgeRing HighestRing(const std::vector<Rgb>& albedos) {
  const std::vector<double> theta_i = AnglesOfRings();
  EdgeRing ring;
  const int end = static_cast<int>(albedos.size());
  for (int k = kAround; k < end; ++k) {
    for (int step = 1; step <= kAround && k + step < end; ++step) {
      for (int c = 0; c < kChannels; ++c) {
        const double before = albedos[k - step][c], here = albedos[k][c],
                     after = albedos[k + step][c];
        const double height =
            std::max(here - std::max(before, after), std::min(before, after) - here);
        if (height > ring.share) ring = {.share = height, .theta_i = theta_i[k]};
      }
    }
  }
  double largest = 0;
  for (const Rgb& albedo : albedos) largest = std::max(largest, std::ranges::max(albedo));
  if (largest > 0) ring.share /= largest;
  return ring;
}

}  // namespace

EdgeRing EdgeRingOf(const FactorModel& model, int num_threads) {
  if (model.spec().anisotropic()) return {};
  return HighestRing(AlbedosOf(model, AnglesOfRings(), num_threads));
}

std::optional<FactorModel> WithoutEdgeRings(
    const Objective& data, const FactorModel& model, const TableLayout& layout,
    const LightLimit* limit, const std::function<bool(const FactorModel&)>& acceptable,
    const StopCheck& stop) {
  constexpr double kAsItIs = -1;
  constexpr double kWidths[] = {0, kAsItIs, 1, 2};  // [deg]
  constexpr double kArounds[] = {3, 6, 10, 14};     // [deg]
  const int num_threads = data.num_threads();
  const Axis& f_axis = model.spec().f_axis;
  const double end = EndOfF(data, model);
  if (end >= f_axis.Theta(f_axis.size - 1)) return std::nullopt;
  double lowest = EdgeRingOf(model, num_threads).share;
  const auto is_done = [&] { return lowest <= kSeenEdgeRing || stop(); };
  if (is_done()) return std::nullopt;
  const FactoredAlbedos albedos(model, AnglesOfCourse(), num_threads);
  std::optional<FactorModel> even;
  const auto consider = [&](FactorModel candidate) {
    if (limit != nullptr) limit->LowerWhereExceeded(layout, stop, &candidate);
    const double share = HighestRing(albedos(candidate, kFirstOfRings)).share;
    if (!(share < lowest) || !acceptable(candidate)) return;
    lowest = share;
    even = std::move(candidate);
  };
  for (const double width : kWidths) {
    FactorModel candidate = model;
    if (width != kAsItIs) {
      ContinueTogether(end - DegreesToRadians(width), &candidate);
      ExpandStored(layout, &candidate);
      consider(candidate);
    }
    for (const double around : kArounds) {
      if (is_done()) return even;
      FollowCourse(around, layout, albedos, &candidate);
      consider(candidate);
    }
  }
  return even;
}

}  // namespace trilobe
