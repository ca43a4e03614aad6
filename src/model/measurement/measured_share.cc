#include "trilobe/model/measurement/measured_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {
namespace {

double ShareOfGrid(const BrdfSamples& samples) {
  const MerlGrid& grid = samples.grid;
  const std::vector<bool> above = BinsAboveSurface(grid);
  double all = 0, measured = 0;
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin]) continue;
    const int row = bin / grid.phi_d;
    const Cosines cosines = ToCosines(grid.Center(bin));
    all += grid.SolidAngle(row / grid.theta_d, row % grid.theta_d) * std::max(cosines.i, 0.0) *
           std::max(cosines.o, 0.0);
  }
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    measured += samples.SolidAngle(j) * cosines.i * cosines.o;
  }
  return all > 0 ? std::min(measured / all, 1.0) : 0;
}

constexpr double kReach = DegreesToRadians(7.5), kReachOfAzimuth = DegreesToRadians(15);
constexpr int kCells = 12;  // of 7.5 degrees, so that what is within reach is in a cell beside

// The angle between two azimuths, 0 to pi.
double AzimuthBetween(double phi_1, double phi_2) {
  return std::abs(std::remainder(phi_1 - phi_2, 2 * kPi));
}

// Pairs of directions by the cells of their theta.
class Reached {
 public:
  explicit Reached(const std::vector<SphericalAngles>& directions) {
    for (const SphericalAngles& at : directions) {
      const double phi = AzimuthBetween(at.phi_o, at.phi_i);
      Cell(CellOf(at.theta_i), CellOf(at.theta_o)).push_back({at.theta_i, at.theta_o, phi});
      Cell(CellOf(at.theta_o), CellOf(at.theta_i)).push_back({at.theta_o, at.theta_i, phi});
    }
  }

  bool operator()(double theta_i, double theta_o, double phi) const {
    const double sine = std::sin(std::min(theta_i, theta_o));
    const int i = CellOf(theta_i), o = CellOf(theta_o);
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, kCells - 1); ++a) {
      for (int b = std::max(o - 1, 0); b <= std::min(o + 1, kCells - 1); ++b) {
        for (const Pair& pair : cells_[a * kCells + b]) {
          if (std::abs(pair.theta_i - theta_i) <= kReach &&
              std::abs(pair.theta_o - theta_o) <= kReach &&
              std::abs(pair.phi - phi) * sine <= kReachOfAzimuth) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  struct Pair {
    double theta_i, theta_o, phi;
  };

  static int CellOf(double theta) {
    return std::clamp(static_cast<int>(theta / kReach), 0, kCells - 1);
  }
  std::vector<Pair>& Cell(int i, int o) { return cells_[i * kCells + o]; }

  std::array<std::vector<Pair>, kCells * kCells> cells_;
};

double ShareOfScattered(const std::vector<SphericalAngles>& directions) {
  constexpr int kSteps = 24;  // of sin^2 theta, which is even in cos theta d omega; and of phi
  const Reached reached(directions);
  const auto theta = [](int k) { return std::asin(std::sqrt((k + 0.5) / kSteps)); };
  int within = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int o = 0; o < kSteps; ++o) {
      for (int p = 0; p < kSteps; ++p) {
        if (reached(theta(i), theta(o), (p + 0.5) / kSteps * kPi)) ++within;
      }
    }
  }
  return static_cast<double>(within) / (kSteps * kSteps * kSteps);
}

}  // namespace

double MeasuredShare(const BrdfSamples& samples) {
  if (samples.on_grid()) return ShareOfGrid(samples);
  if (!samples.directions.empty()) return ShareOfScattered(samples.directions);
  std::vector<SphericalAngles> directions;
  for (const HalfDiffAngles& angles : samples.angles) {
    directions.push_back(ToSphericalAngles(ToDirections(angles)));
  }
  return ShareOfScattered(directions);
}

}  // namespace trilobe
