#include "model/measurement/directions_to_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include "core/base/radical_inverse.h"
#include "core/base/text.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

Direction Mirrored(const Direction& wi, const Direction& h) {
  const double twice = 2 * Dot(wi, h);
  return {twice * h[0] - wi[0], twice * h[1] - wi[1], twice * h[2] - wi[2]};
}

// Point `number` of the sequence, whether or not the device reaches it.
DirectionPair Point(size_t number, const Goniometer& device) {
  const double theta_h = kPi / 2 * RadicalInverse(2, number);
  const double u = RadicalInverse(3, number), v = RadicalInverse(5, number);
  // In the plane of incidence the half vector lies on one side of the normal or the other.
  const double phi = !device.in_plane ? kPi * v : v < 0.5 ? 0 : kPi;
  if (device.incidences.empty()) {
    return ToDirections(HalfDiffAngles{theta_h, device.max_theta * u, phi});
  }
  const auto count = static_cast<double>(device.incidences.size());
  const Direction wi = ToDirection({device.incidences[static_cast<size_t>(count * u)], 0});
  return {wi, Mirrored(wi, ToDirection({theta_h, phi}))};
}

double Stepped(double angle, double step) {
  return step > 0 ? step * std::round(angle / step) : angle;
}

// The same with the light at phi_i = 0 and the detector on one side, as the device sets it.
SphericalAngles Set(const DirectionPair& pair, const Goniometer& device) {
  const SphericalAngles at = ToSphericalAngles(pair);
  const double phi = std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
  double stepped = Stepped(phi, device.step);
  if (stepped > kPi + 1e-9) stepped -= device.step;
  const double theta_i = device.incidences.empty() ? Stepped(at.theta_i, device.step) : at.theta_i;
  return {theta_i, 0, Stepped(at.theta_o, device.step),
          device.in_plane ? (phi < kPi / 2 ? 0 : kPi) : stepped};
}

bool IsReached(const SphericalAngles& at, const Goniometer& device) {
  constexpr double kRounding = 1e-9;
  if (at.theta_i > device.max_theta + kRounding || at.theta_o > device.max_theta + kRounding) {
    return false;
  }
  const DirectionPair pair = ToDirections(at);
  const double between = std::acos(std::clamp(Dot(pair.wi, pair.wo), -1.0, 1.0));
  return between >= device.blind - kRounding;
}

// Equal for directions that say the same of an isotropic material, also exchanged.
std::array<int64_t, 3> KeyOf(const SphericalAngles& at) {
  const auto micro = [](double angle) { return std::llround(angle * 1e6); };
  const auto [least, most] = std::minmax(at.theta_i, at.theta_o);
  // Along the normal an azimuth says nothing.
  return {micro(least), micro(most), least > 1e-6 ? micro(at.phi_o) : 0};
}

// Finds what was measured already, whatever digits a file has kept of its angles.
class Measured {
 public:
  explicit Measured(std::span<const SphericalAngles> directions) {
    for (const SphericalAngles& at : directions) {
      const auto [least, most] = std::minmax(at.theta_i, at.theta_o);
      const double phi = std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
      for (const int64_t low : CellsNear(least)) {
        for (const int64_t high : CellsNear(most)) {
          for (const int64_t around : CellsNear(phi)) {
            cells_.insert({low, high, low > 0 ? around : 0});
          }
        }
      }
    }
  }

  bool Contains(const SphericalAngles& at) const {
    const auto [least, most] = std::minmax(at.theta_i, at.theta_o);
    const int64_t low = CellOf(least);
    return cells_.contains({low, CellOf(most), low > 0 ? CellOf(at.phi_o) : 0});
  }

 private:
  static constexpr double kCell = DegreesToRadians(0.1);
  static int64_t CellOf(double angle) { return std::llround(angle / kCell); }
  // The cells of what is about the same angle, by just less than half a cell.
  static std::set<int64_t> CellsNear(double angle) {
    constexpr double kSame = 0.49 * kCell;
    return {CellOf(angle - kSame), CellOf(angle + kSame)};
  }

  std::set<std::array<int64_t, 3>> cells_;
};

void Check(int count, const Goniometer& device) {
  const auto refuse = [](const std::string& what, const std::string& name, double value) {
    throw Error(ErrorKind::kRange, what).About(name, value);
  };
  const auto degrees = [](double angle) { return Text(RadiansToDegrees(angle)); };
  if (count < 1 || count > kMostDirections) {
    refuse(std::to_string(count) + " directions; give 1 to " + std::to_string(kMostDirections),
           "directions", count);
  }
  if (!(device.max_theta > 0 && device.max_theta < kPi / 2)) {
    refuse("theta up to " + degrees(device.max_theta) + " deg; it must be above 0 and below 90",
           "theta_max", RadiansToDegrees(device.max_theta));
  }
  for (const double theta : device.incidences) {
    if (theta >= 0 && theta <= device.max_theta) continue;
    refuse("an incidence of " + degrees(theta) + " deg; it must be from 0 to theta_max, " +
               degrees(device.max_theta),
           "incidences", RadiansToDegrees(theta));
  }
  if (!(device.step >= 0 && device.step <= DegreesToRadians(45))) {
    refuse("steps of " + degrees(device.step) + " deg; give 0, for any angle, to 45", "step",
           RadiansToDegrees(device.step));
  }
  if (!(device.blind >= 0 && device.blind < kPi)) {
    refuse("blind within " + degrees(device.blind) + " deg of the light; give 0 to below 180",
           "blind", RadiansToDegrees(device.blind));
  }
}

}  // namespace

std::vector<SphericalAngles> DirectionsLeft(int most, const Goniometer& device,
                                            std::span<const SphericalAngles> measured) {
  Check(most, device);
  constexpr size_t kMostPoints = 2000000;  // whose number makes up what the device reaches
  const Measured before(measured);
  std::vector<SphericalAngles> directions;
  std::set<std::array<int64_t, 3>> known;
  for (size_t number = 1; number <= kMostPoints && std::ssize(directions) < most; ++number) {
    const DirectionPair pair = Point(number, device);
    if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) continue;
    const SphericalAngles at = Set(pair, device);
    if (!IsReached(at, device) || before.Contains(at) || !known.insert(KeyOf(at)).second) continue;
    directions.push_back(at);
  }
  return directions;
}

std::vector<SphericalAngles> DirectionsToMeasure(int count, const Goniometer& device) {
  std::vector<SphericalAngles> directions = DirectionsLeft(count, device, {});
  if (std::ssize(directions) < count) {
    throw Error(ErrorKind::kRange,
                "the device reaches " + std::to_string(directions.size()) + " of " +
                    std::to_string(count) +
                    " directions; ask for fewer, or give it smaller steps, a larger theta_max, a "
                    "smaller blind cone or more incidences")
        .About("directions", count);
  }
  return directions;
}

}  // namespace trilobe
