#include "trilobe/io/hemisphere_grid.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/base/parallel.h"
#include "trilobe/brdf/merl_grid.h"
#include "trilobe/brdf/tabulated_brdf.h"
#ifdef TRILOBE_RGL
#include "trilobe/io/rgl_file.h"
#endif

namespace trilobe {
namespace {

constexpr double kSame = 1e-6;  // [rad]

using MeasuredValue = std::function<std::optional<Rgb>(const DirectionPair&)>;

// What a measurement that is no list of samples has for single directions.
MeasuredValue FunctionOf(const Measurement& measurement) {
#ifdef TRILOBE_RGL
  if (measurement.rgl) {
    const double limit =
        measurement.table ? measurement.table->max_theta : measurement.rgl->max_theta();
    return [rgl = measurement.rgl,
            min_cosine = std::cos(limit) - 1e-12](const DirectionPair& pair) -> std::optional<Rgb> {
      const RglBrdf::Value value = rgl->LookUp(pair);
      const bool within = std::min(pair.wi[2], pair.wo[2]) >= min_cosine;
      return within && value.measured ? std::optional(value.rho) : std::nullopt;
    };
  }
#endif
  const BrdfTable& table = *measurement.table;
  return [&table, valid = ValidBins(table),
          brdf = TabulatedBrdf(table)](const DirectionPair& pair) -> std::optional<Rgb> {
    return valid[table.grid.Bin(ToHalfDiff(pair))] ? std::optional(brdf.Interpolate(pair))
                                                   : std::nullopt;
  };
}

int ParsePositive(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? number : 0;
}

}  // namespace

std::optional<int> HemisphereGrid::Find(double theta, double phi) const {
  const double theta_step = kPi / 2 / thetas, phi_step = 2 * kPi / phis;
  const double a = std::round(theta / theta_step);
  const double turned = phi - 2 * kPi * std::floor(phi / (2 * kPi));
  const double b = std::round(turned / phi_step);
  if (!(a >= 0 && a < thetas && std::abs(theta - a * theta_step) <= kSame &&
        std::abs(turned - b * phi_step) <= kSame)) {
    return std::nullopt;
  }
  return static_cast<int>(a) * phis + static_cast<int>(b) % phis;
}

HemisphereGrid ParseHemisphereGrid(std::string_view text) {
  const size_t x = std::min(text.find('x'), text.size());
  const HemisphereGrid grid = {ParsePositive(text.substr(0, x)),
                               ParsePositive(text.substr(std::min(x + 1, text.size())))};
  constexpr int64_t kMostPairs = 10'000'000;
  const int64_t nodes = int64_t{grid.thetas} * grid.phis;
  if (grid.thetas < 1 || grid.phis < 1 || nodes > 100'000 || nodes * nodes > kMostPairs) {
    throw Error("'" + std::string(text) +
                "' is no grid of directions; give the numbers of theta and phi, as 6x48, of at "
                "most 3162 directions");
  }
  return grid;
}

NodeValues ValuesAtNodes(const Measurement& scattered, const HemisphereGrid& grid) {
  const auto nodes = static_cast<size_t>(grid.nodes());
  NodeValues values{std::vector<Rgb>(nodes * nodes), std::vector<bool>(nodes * nodes)};
  for (int j = 0; j < scattered.samples.size(); ++j) {
    const SphericalAngles& at = scattered.samples.directions[j];
    const auto i = grid.Find(at.theta_i, at.phi_i), o = grid.Find(at.theta_o, at.phi_o);
    const auto fail = [&](const std::string& problem) {
      std::ostringstream message;
      message << scattered.source
              << ": the sample at theta_i, phi_i, theta_o, phi_o = " << RadiansToDegrees(at.theta_i)
              << ", " << RadiansToDegrees(at.phi_i) << ", " << RadiansToDegrees(at.theta_o) << ", "
              << RadiansToDegrees(at.phi_o) << " deg " << problem;
      throw Error(message.str());
    };
    if (!i || !o) {
      std::ostringstream steps;
      steps << "is at no node of the grid, whose steps are " << 90.0 / grid.thetas
            << " deg in theta and " << 360.0 / grid.phis << " deg in phi";
      fail(steps.str());
    }
    const size_t index = *i * nodes + *o;
    if (values.present[index]) fail("is there twice; the grid has room for one");
    values.present[index] = true;
    values.rho[index] = scattered.samples.rho[j];
  }
  return values;
}

Measurement AtNodes(const Measurement& measurement, const HemisphereGrid& grid, int num_threads) {
  const int nodes = grid.nodes();
  NodeValues values;
  if (!measurement.table && !measurement.rgl) {
    values = ValuesAtNodes(measurement, grid);
  } else {
    std::vector<std::optional<Rgb>> found(static_cast<size_t>(nodes) * nodes);
    const MeasuredValue brdf = FunctionOf(measurement);
    ParallelFor(nodes, num_threads, [&](int i) {
      for (int o = 0; o < nodes; ++o) {
        found[static_cast<size_t>(i) * nodes + o] = brdf(ToDirections(grid.Angles(i, o)));
      }
    });
    for (const std::optional<Rgb>& rho : found) {
      values.present.push_back(rho.has_value());
      values.rho.push_back(rho.value_or(Rgb{}));
    }
  }
  SampleCollector collector(measurement.source, measurement.kind);
  for (int i = 0; i < nodes; ++i) {
    for (int o = 0; o < nodes; ++o) {
      const size_t index = static_cast<size_t>(i) * nodes + o;
      if (values.present[index]) {
        collector.Add(grid.Angles(i, o), values.rho[index]);
      } else {
        collector.LeaveOut(&BinCounts::missing);
      }
    }
  }
  Measurement at_nodes = collector.Take();
  at_nodes.anisotropic = true;
  return at_nodes;
}

}  // namespace trilobe
