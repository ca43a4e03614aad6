#include "trilobe/model/measurement/hemisphere_grid.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/text_lines.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {
namespace {

using MeasuredAt = std::function<std::optional<Rgb>(const DirectionPair&)>;

// For measurements that are not lists of samples: the value at single directions.
MeasuredAt FunctionOf(const Measurement& measurement) {
  if (measurement.look_up) {
    const double limit = measurement.table ? measurement.table->max_theta : kPi / 2;
    return [look_up = measurement.look_up,
            min_cosine = std::cos(limit) - 1e-12](const DirectionPair& pair) -> std::optional<Rgb> {
      const MeasuredValue value = look_up(pair);
      const bool within = std::min(pair.wi[2], pair.wo[2]) >= min_cosine;
      return within && value.measured ? std::optional(value.rho) : std::nullopt;
    };
  }
  const BrdfTable& table = *measurement.table;
  return [&table, valid = ValidBins(table),
          brdf = TabulatedBrdf(table)](const DirectionPair& pair) -> std::optional<Rgb> {
    return valid[table.grid.Bin(ToHalfDiff(pair))] ? std::optional(brdf.Interpolate(pair))
                                                   : std::nullopt;
  };
}

}  // namespace

HemisphereGrid ParseHemisphereGrid(std::string_view text) {
  std::vector<int> numbers = IntegersByX(text);
  if (numbers.size() != 2) numbers.assign(2, 0);
  const HemisphereGrid grid = {numbers[0], numbers[1]};
  constexpr int64_t kMostPairs = 10'000'000;
  const int64_t nodes = int64_t{grid.thetas} * grid.phis;
  if (grid.thetas < 1 || grid.phis < 1 || nodes > 100'000 || nodes * nodes > kMostPairs) {
    throw Error(ErrorKind::kFormat,
                "'" + std::string(text) +
                    "' is no grid of directions; give the numbers of theta and phi, as 6x48, of at "
                    "most 3162 directions")
        .About("grid of directions", text);
  }
  return grid;
}

NodeTable ValuesAtNodes(const Measurement& scattered, const HemisphereGrid& grid) {
  CheckHemisphereGrid(grid);
  CheckDirections(scattered);
  const auto nodes = static_cast<size_t>(grid.nodes());
  NodeTable values{.source = scattered.source,
                   .grid = grid,
                   .rho = std::vector<Rgb>(nodes * nodes),
                   .present = std::vector<bool>(nodes * nodes),
                   .max_theta = scattered.max_theta};
  for (int j = 0; j < scattered.samples.size(); ++j) {
    const SphericalAngles& at = scattered.samples.directions[j];
    const auto i = grid.Find(at.theta_i, at.phi_i), o = grid.Find(at.theta_o, at.phi_o);
    const auto fail = [&](ErrorKind kind, const std::string& problem) {
      std::ostringstream message;
      message << scattered.source
              << ": the sample at theta_i, phi_i, theta_o, phi_o = " << RadiansToDegrees(at.theta_i)
              << ", " << RadiansToDegrees(at.phi_i) << ", " << RadiansToDegrees(at.theta_o) << ", "
              << RadiansToDegrees(at.phi_o) << " deg " << problem;
      throw Error(kind, message.str()).At(scattered.source).About("sample", j);
    };
    if (!i || !o) {
      std::ostringstream steps;
      steps << "is at no node of the grid, whose steps are " << 90.0 / grid.thetas
            << " deg in theta and " << 360.0 / grid.phis << " deg in phi";
      fail(ErrorKind::kMismatch, steps.str());
    }
    const size_t index = *i * nodes + *o;
    if (values.present[index]) {
      fail(ErrorKind::kConflict, "is there twice; the grid has room for one");
    }
    values.present[index] = true;
    values.rho[index] = scattered.samples.rho[j];
  }
  return values;
}

Measurement AtNodes(const Measurement& measurement, const HemisphereGrid& grid, int num_threads) {
  CheckHemisphereGrid(grid);
  const int nodes = grid.nodes();
  NodeTable values;
  if (!measurement.table && !measurement.look_up) {
    values = ValuesAtNodes(measurement, grid);
  } else {
    std::vector<std::optional<Rgb>> found(static_cast<size_t>(nodes) * nodes);
    const MeasuredAt brdf = FunctionOf(measurement);
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
