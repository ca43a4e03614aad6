#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "model/measurement/corruption_kinds.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {
namespace {

// A direction rotated from z towards x.
Direction Turned(const Direction& w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w[0] + s * w[2], w[1], c * w[2] - s * w[0]};
}

// Replaces each reading by that of moved directions, divided by the recorded cosine.
void ReadElsewhere(Readings* readings,
                   const std::function<DirectionPair(const DirectionPair&)>& move) {
  const Readings::Between between = readings->ReadBetween();
  readings->ForEach([&](int j) {
    const DirectionPair said = readings->Directions(j), seen = move(said);
    const std::optional<Rgb> rho = between(seen);
    if (!rho) {
      readings->Lose(j);
      return;
    }
    const double light = seen.wi[2] / said.wi[2];
    for (int c = 0; c < kChannels; ++c) readings->rho(j)[c] = (*rho)[c] * light;
  });
}

}  // namespace

void Tilt(double strength, uint64_t /*seed*/, Readings* readings) {
  if (strength == 0) return;
  const double angle = DegreesToRadians(strength);
  // The normal leans towards x: in its frame, all directions lean the other way.
  ReadElsewhere(readings, [&](const DirectionPair& pair) {
    return DirectionPair{Turned(pair.wi, -angle), Turned(pair.wo, -angle)};
  });
}

void ShiftOrigin(double strength, uint64_t /*seed*/, Readings* readings) {
  if (strength == 0) return;
  const double angle = DegreesToRadians(strength);
  ReadElsewhere(readings, [&](const DirectionPair& pair) {
    return DirectionPair{pair.wi, Turned(pair.wo, -angle)};
  });
}

void BlurByAperture(double strength, uint64_t /*seed*/, Readings* readings) {
  if (strength == 0) return;
  // Points at the middle of rings of equal area of a disc.
  struct Point {
    double radius, azimuth;
  };
  std::vector<Point> points = {{0, 0}};
  constexpr int kRings = 2, kPerRing = 6;
  constexpr double kPoints = 1 + kPerRing * kRings * (kRings + 1) / 2.0;
  double inner = 1 / kPoints;  // the disc's share of area within the ring
  for (int ring = 1; ring <= kRings; ++ring) {
    const int count = kPerRing * ring;
    const double outer = inner + count / kPoints;
    for (int k = 0; k < count; ++k) {
      points.push_back({std::sqrt((inner + outer) / 2), 2 * kPi * k / count});
    }
    inner = outer;
  }
  const double radius = DegreesToRadians(strength) / 2;
  const Readings::Between between = readings->ReadBetween();
  readings->ForEach([&](int j) {
    const DirectionPair pair = readings->Directions(j);
    const PolarAngles at = ToPolarAngles(pair.wo);
    const double c = std::cos(at.phi), s = std::sin(at.phi);
    Rgb sum{};
    int seen = 0;
    for (const Point& point : points) {
      // Around the normal, and from there to wo.
      const Direction near =
          Turned(ToDirection({.theta = radius * point.radius, .phi = point.azimuth}), at.theta);
      const std::optional<Rgb> rho =
          between({pair.wi, {c * near[0] - s * near[1], s * near[0] + c * near[1], near[2]}});
      if (!rho) continue;
      ++seen;
      for (int k = 0; k < kChannels; ++k) sum[k] += (*rho)[k];
    }
    for (int k = 0; k < kChannels && seen > 0; ++k) readings->rho(j)[k] = sum[k] / seen;
  });
}

void RepeatBeyond(double strength, uint64_t /*seed*/, Readings* readings) {
  const double last = DegreesToRadians(strength);
  const Readings::Between between = readings->ReadBetween();
  readings->ForEach([&](int j) {
    PolarAngles i = ToPolarAngles(readings->Directions(j).wi);
    PolarAngles o = ToPolarAngles(readings->Directions(j).wo);
    if (std::max(i.theta, o.theta) <= last) return;
    i.theta = std::min(i.theta, last);
    o.theta = std::min(o.theta, last);
    if (const auto rho = between({ToDirection(i), ToDirection(o)})) readings->rho(j) = *rho;
  });
}

}  // namespace trilobe
