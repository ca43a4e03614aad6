#include "trilobe/model/axis.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/merl_grid.h"

namespace trilobe {
namespace {

// [degrees] Nodes must be above the surface, so 89.9 stands for the horizon. G is about 0 there
// whatever G / cos theta is; the ring at 84 lets G / cos theta grow.
constexpr double kTowardsHorizon[] = {84, 89.9};

// Snaps to a node within kAtEntry. If both nodes are the same, the only one of a circle, it is read
// once.
Between Snapped(Between at) {
  if (at.t > 1 - kAtEntry) return {at.upper, at.upper, 0};
  return at.t < kAtEntry || at.lower == at.upper ? Between{at.lower, at.lower, 0} : at;
}

Between LocateTheta(const std::vector<double>& nodes, double degrees) {
  const int last = static_cast<int>(nodes.size()) - 1;
  if (degrees <= nodes.front()) return {0, 0, 0};
  if (degrees >= nodes.back()) return {last, last, 0};
  const auto upper = std::ranges::upper_bound(nodes, degrees);
  const int a = static_cast<int>(upper - nodes.begin()) - 1;
  return Snapped({a, a + 1, (degrees - nodes[a]) / (nodes[a + 1] - nodes[a])});
}

// A cheap check that all entries exist, before reading.
void CheckEntries(const Axis& axis) {
  if (!axis.polar()) return;
  if (!axis.theta.empty() && axis.phi_nodes >= 1 &&
      static_cast<int64_t>(axis.theta.size()) * axis.phi_nodes == axis.size) {
    return;
  }
  throw Error(ErrorKind::kMismatch, "an axis of " + std::to_string(axis.size) +
                                        " entries cannot have " +
                                        std::to_string(axis.theta.size()) + " x " +
                                        std::to_string(axis.phi_nodes) + " nodes")
      .About("axis", axis.size);
}

void CheckEntry(const Axis& axis, int entry) {
  CheckEntries(axis);
  CheckIndex(entry, axis.size, "the entry of a table");
}

Stencil PolarStencil(const Axis& axis, double theta, double phi) {
  if (!(std::isfinite(theta) && std::isfinite(phi))) {
    throw Error(ErrorKind::kRange, "theta or phi of a direction is not a finite number")
        .About("theta, phi");
  }
  const Between a = LocateTheta(axis.theta, RadiansToDegrees(theta));
  const Between b = Snapped(OnCircle(phi, axis.phi_nodes));
  Stencil stencil;
  const auto add = [&](int row, int column, double weight) {
    if (weight == 0) return;
    stencil.index[stencil.size] = row * axis.phi_nodes + column;
    stencil.weight[stencil.size++] = weight;
  };
  add(a.lower, b.lower, (1 - a.t) * (1 - b.t));
  add(a.lower, b.upper, (1 - a.t) * b.t);
  add(a.upper, b.lower, a.t * (1 - b.t));
  add(a.upper, b.upper, a.t * b.t);
  return stencil;
}

}  // namespace

Axis Axis::Polar(std::vector<double> theta_degrees, int phi_nodes) {
  constexpr auto kFit = [](size_t nodes) { return nodes >= 1 && nodes <= kMaxTableSize; };
  if (phi_nodes < 1 || !kFit(phi_nodes) || !kFit(theta_degrees.size())) {
    throw Error(ErrorKind::kRange, "an axis of " + std::to_string(theta_degrees.size()) +
                                       " theta by " + std::to_string(phi_nodes) +
                                       " phi; it needs from 1 to " + std::to_string(kMaxTableSize) +
                                       " of each")
        .About("axis");
  }
  const int size = static_cast<int>(theta_degrees.size()) * phi_nodes;
  return {.rule = Rule::kPolar,
          .size = size,
          .theta = std::move(theta_degrees),
          .phi_nodes = phi_nodes};
}

Axis Axis::EvenPolar(int thetas, Steps steps, int phi_nodes) {
  constexpr double kLast = 75;
  CheckNumber("the number of theta of an axis", thetas, thetas >= 1 && thetas <= kMaxTableSize,
              "from 1 to " + std::to_string(kMaxTableSize));
  std::vector<double> nodes;
  for (int a = 0; a < thetas; ++a) {
    const double t = thetas > 1 ? static_cast<double>(a) / (thetas - 1) : 0;
    nodes.push_back(kLast * (steps == Steps::kOfRoot ? t * t : t));
  }
  return Polar(std::move(nodes), phi_nodes);
}

Axis Axis::ToHorizon() const {
  std::vector<double> nodes = theta;
  nodes.insert(nodes.end(), std::begin(kTowardsHorizon), std::end(kTowardsHorizon));
  return Polar(std::move(nodes), phi_nodes);
}

bool Axis::reaches_horizon() const {
  return polar() && !theta.empty() && theta.back() >= kTowardsHorizon[1];
}

Axis Axis::WithoutHorizon() const {
  if (!reaches_horizon()) return *this;
  const auto end = std::ranges::lower_bound(theta, kTowardsHorizon[0]);
  return Polar({theta.begin(), end}, phi_nodes);
}

Axis Axis::Utia() { return EvenPolar(6, Steps::kOfTheta, 48); }

int Axis::SplineNodesFor(int data_thetas) {
  // (k + 1/2) 90 / size = 75 only for odd multiples of 3.
  const int odd = (data_thetas / 2 - 1) / 2 * 2 + 1;
  return 3 * std::clamp(odd, 3, 29);
}

Stencil Axis::At(double theta_radians, double phi_radians) const {
  CheckEntries(*this);
  switch (rule) {
    case Rule::kRootTheta:
      return LinearStencil(MerlGrid{.theta_h = size}.ThetaHCoordinate(theta_radians), size);
    case Rule::kTheta:
      return LinearStencil(MerlGrid{.theta_d = size}.ThetaDCoordinate(theta_radians), size);
    case Rule::kSpline:
      return CatmullRom(size).StencilAt(theta_radians);
    case Rule::kPolar:
      return PolarStencil(*this, theta_radians, phi_radians);
  }
  return {};
}

double Axis::Theta(int entry) const {
  CheckEntry(*this, entry);
  if (polar()) return DegreesToRadians(theta[entry / phi_nodes]);
  if (rule == Rule::kRootTheta) return MerlGrid{.theta_h = size}.ThetaH(entry + 0.5);
  return (entry + 0.5) / size * (kPi / 2);
}

double Axis::Phi(int entry) const {
  CheckEntry(*this, entry);
  return polar() ? entry % phi_nodes * (2 * kPi / phi_nodes) : 0;
}

double Axis::Cell::SolidAngle() const {
  return phi_width * (std::cos(theta_begin) - std::cos(theta_end));
}

Axis::Cell Axis::CellOf(int entry) const {
  CheckEntry(*this, entry);
  if (!polar()) {
    const MerlGrid grid{.theta_h = size, .theta_d = size};
    if (rule == Rule::kRootTheta) return {grid.ThetaH(entry), grid.ThetaH(entry + 1), 2 * kPi};
    return {grid.ThetaD(entry), grid.ThetaD(entry + 1), 2 * kPi};
  }
  const int a = entry / phi_nodes, last = static_cast<int>(theta.size()) - 1;
  const double inner = a > 0 ? theta[a] - theta[a - 1] : last > 0 ? theta[1] - theta[0] : 180;
  const double outer = a < last ? theta[a + 1] - theta[a] : inner;
  return {DegreesToRadians(std::max(theta[a] - inner / 2, 0.0)),
          DegreesToRadians(std::min(theta[a] + outer / 2, 90.0)), 2 * kPi / phi_nodes};
}

void CheckAxis(const Axis& axis, const char* name) {
  const auto fail = [&](ErrorKind kind, double value, const std::string& problem) {
    throw Error(kind, std::string(name) + " tables " + problem).About(name, value);
  };
  const int max_size = axis.polar() ? kMaxTableSize : kMaxBins;
  if (axis.size < 4 || axis.size > max_size) {
    fail(ErrorKind::kRange, axis.size,
         "have " + std::to_string(axis.size) + " entries; they need 4 to " +
             std::to_string(max_size));
  }
  if (!axis.polar()) return;
  const std::vector<double>& theta = axis.theta;
  if (theta.empty() || axis.phi_nodes < 1 ||
      static_cast<int64_t>(theta.size()) * axis.phi_nodes != axis.size) {
    fail(ErrorKind::kMismatch, axis.size,
         "of " + std::to_string(axis.size) + " entries cannot have " +
             std::to_string(theta.size()) + " x " + std::to_string(axis.phi_nodes) + " nodes");
  }
  // Written so that it fails for NaN.
  const auto not_below = [](double a, double b) { return !(a < b); };
  const bool ascend = std::ranges::adjacent_find(theta, not_below) == theta.end();
  if (!(ascend && theta.front() >= 0 && theta.back() < 90)) {
    fail(ErrorKind::kRange, theta.back(),
         "have nodes theta that do not ascend from 0 degrees or more to below 90");
  }
}

}  // namespace trilobe
