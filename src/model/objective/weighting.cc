#include "trilobe/model/objective/weighting.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "core/base/grid_cosines.h"
#include "core/base/names.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {
namespace {

double Square(double x) { return x * x; }

// A formula for one channel at a time.
std::function<Rgb(const WeightedPoint&, double)> ByChannel(double (*weight)(double, double)) {
  return [weight](const WeightedPoint& point, double /*level*/) {
    const auto [r, g, b] = point.rho;
    const double cos_i = point.cosines.i;
    return Rgb{weight(r, cos_i), weight(g, cos_i), weight(b, cos_i)};
  };
}

// Squared chord of log(1 + b), b = rho cos_i, from 0: (log(1+b)/rho)^2, which tends to cos_i^2.
double CompressiveWeight(double rho_star, double cos_i) {
  const double b = rho_star * cos_i;
  // log(1+b)/b, by its series where b may have lost digits to underflow.
  const double chord = b < 1e-9 ? 1 - b / 2 : std::log1p(b) / b;
  return Square(chord * cos_i);
}

// Squared slope of log(1 + rho cos_i).
double LogWeight(double rho_star, double cos_i) { return Square(cos_i / (1 + rho_star * cos_i)); }

double PercentageWeight(double rho_star, double /*cos_i*/) { return Square(1 / (rho_star + 1e-3)); }

double CosineWeight(double /*rho_star*/, double cos_i) { return Square(cos_i); }

double UniformWeight(double /*rho_star*/, double /*cos_i*/) { return 1; }

// The squared slope of f(b) = (b + epsilon)^(1 - exponent) or log(b + epsilon), up to a constant
// factor.
struct Power {
  double exponent = 1;
  double epsilon = 1e-3;  // [1/sr], or of the level
  bool relative = false;
  double by_channel = 0;  // share of the channel's own value in b, the rest being the mean's
  bool both_cosines = false;
  double solid_angle = 0;  // exponent of the solid angle

  Rgb operator()(const WeightedPoint& point, double level) const {
    const double cosine = both_cosines ? point.cosines.i * point.cosines.o : point.cosines.i;
    // Values are relative to the level if `relative`, so that no exponent depends on the unit. A
    // black measurement has no level; any value works. So for an extremely dark one, whose weights
    // would be infinite.
    const double scale = relative && level > 1e-100 ? 1 / level : 1;
    const double area = solid_angle == 0 ? 1 : std::pow(point.solid_angle, solid_angle);
    const auto weight = [&](double rho_star) {
      const double x = rho_star * scale * cosine + epsilon;
      // The logarithm; avoids the cost of a power.
      const double slope = exponent == 1 ? 1 / x : std::pow(x, -exponent);
      return area * Square(cosine * slope);
    };
    const double mean = Mean(point.rho);
    if (by_channel == 0) {
      const double w = weight(mean);
      return {w, w, w};
    }
    Rgb w;
    for (int c = 0; c < kChannels; ++c) {
      w[c] = weight(by_channel * point.rho[c] + (1 - by_channel) * mean);
    }
    return w;
  }
};

Weighting PowerWeighting(std::string name, std::string description, const Power& power) {
  return {.name = std::move(name),
          .description = std::move(description),
          .scale_free = power.relative,
          .formula = power,
          .needs_level = power.relative};
}

[[noreturn]] void FailPower(const std::string& name, const std::string& problem, ErrorKind kind,
                            std::string_view key) {
  throw Error(kind,
              "weighting '" + name + "': " + problem +
                  "; write power:exponent=1,epsilon=0.001,relative=0,by_channel=0,both_cosines=0,"
                  "solid_angle=0, or less of it")
      .About(key, name);
}

// "power:KEY=VALUE,...".
Weighting ParsePower(const std::string& name) {
  Power power;
  std::istringstream items(name.substr(name.find(':') + 1));
  for (std::string item; std::getline(items, item, ',');) {
    std::istringstream text(item);
    std::string key;
    double value = -1;
    std::getline(text, key, '=');
    if (!(text >> value && text.peek() == EOF && value >= 0 && value <= 10)) {
      FailPower(name, "'" + item + "' is not KEY=NUMBER with a number from 0 to 10",
                ErrorKind::kFormat, item);
    }
    const auto yes = [&] {
      if (value != 0 && value != 1) {
        FailPower(name, "'" + item + "' is neither 0 nor 1", ErrorKind::kRange, key);
      }
      return value == 1;
    };
    if (key == "exponent") {
      power.exponent = value;
    } else if (key == "epsilon") {
      power.epsilon = value;
    } else if (key == "relative") {
      power.relative = yes();
    } else if (key == "by_channel") {
      if (value > 1) FailPower(name, "by_channel must be at most 1", ErrorKind::kRange, key);
      power.by_channel = value;
    } else if (key == "both_cosines") {
      power.both_cosines = yes();
    } else if (key == "solid_angle") {
      power.solid_angle = value;
    } else {
      FailPower(name, "unknown key '" + key + "'", ErrorKind::kUnknown, key);
    }
  }
  if (power.exponent > 2) {
    FailPower(name, "exponent must be at most 2", ErrorKind::kRange, "exponent");
  }
  if (!(power.epsilon >= 1e-9) && power.exponent > 0) {
    FailPower(name, "epsilon must be at least 1e-9, or weights of black samples are infinite",
              ErrorKind::kRange, "epsilon");
  }
  return PowerWeighting(name, "as written", power);
}

}  // namespace

const std::vector<Weighting>& Weightings() {
  static const std::vector<Weighting> weightings = {
      PowerWeighting(
          "appearance",
          "W^(3/4) c^2 (c rho/L+1/20)^(-3/2), c = cos theta_i cos theta_o, rho the mean "
          "over the channels, L that of the measurement, W the solid angle of the bin: the "
          "one whose fits look best (docs/appearance.md)",
          {.exponent = 0.75,
           .epsilon = 0.05,
           .relative = true,
           .both_cosines = true,
           .solid_angle = 0.75}),
      PowerWeighting(
          "appearance_channel",
          "as appearance, (9 rho + mean)/10 by channel in the place of the mean: for saturated "
          "colours (docs/forms.md)",
          {.exponent = 0.75,
           .epsilon = 0.05,
           .relative = true,
           .by_channel = 0.9,
           .both_cosines = true,
           .solid_angle = 0.75}),
      PowerWeighting("log_relative",
                     "(cos theta_i/(b+1e-3))^2, b = rho cos theta_i, its mean over the channels: "
                     "the tangent of log(b+1e-3), Nielsen et al. 2015",
                     {}),
      PowerWeighting("log_relative_channel", "the same, b by channel", {.by_channel = 1}),
      PowerWeighting("cube_root",
                     "cos^2 theta_i (b+1e-3)^(-4/3), by channel: the tangent of a cube root, "
                     "Fores et al. 2012",
                     {.exponent = 2.0 / 3, .by_channel = 1}),
      {"percentage", "1/(rho+1e-3)^2: relative error, Tofallis 2008", false,
       ByChannel(PercentageWeight)},
      {"compressive", "(log(1+b)/rho)^2: the chord of Low's log metric", false,
       ByChannel(CompressiveWeight)},
      {"log", "(cos theta_i/(1+b))^2: the tangent of log(1+b), Low et al. 2012", false,
       ByChannel(LogWeight)},
      {"cosine", "cos^2 theta_i", true, ByChannel(CosineWeight)},
      {"uniform", "1", true, ByChannel(UniformWeight)},
  };
  return weightings;
}

Weighting FindWeighting(std::string_view name) {
  if (name.starts_with("power:")) return ParsePower(std::string(name));
  return FindNamed("weighting", name, Weightings());
}

Weighting ForSamples(Weighting weighting, const BrdfSamples& samples, int num_threads) {
  if (!weighting.formula) {
    throw Error(ErrorKind::kMissing, "weighting '" + weighting.name + "' has no formula")
        .About("weighting", weighting.name);
  }
  if (weighting.needs_level && !(weighting.level > 0)) {
    weighting.level = MeanReflectance(samples, num_threads);
  }
  return weighting;
}

double MeanReflectance(const BrdfSamples& samples, int num_threads) {
  constexpr int kBlock = 1 << 14;
  struct Sums {
    double light = 0, reflected = 0;
  };
  std::vector<Sums> blocks((samples.size() + kBlock - 1) / kBlock);
  std::optional<GridCosines> of_bins;
  if (samples.on_grid()) of_bins.emplace(samples.grid);
  ParallelFor(static_cast<int>(blocks.size()), num_threads, [&](int block) {
    Sums sums;
    double solid_angle = 1;
    for (int j = block * kBlock, row = -1; j < std::min(samples.size(), (block + 1) * kBlock);
         ++j) {
      // All bins of a row have the same solid angle.
      if (of_bins && std::exchange(row, samples.bins[j] / samples.grid.phi_d) != row) {
        solid_angle = samples.SolidAngle(j);
      }
      const Cosines cosines = of_bins ? (*of_bins)(samples.bins[j]) : samples.CosinesOf(j);
      const double counts = of_bins ? solid_angle : samples.Multiplicity(j);
      const double through = counts * cosines.i * cosines.o;
      sums.light += through;
      sums.reflected += through * Mean(samples.rho[j]);
    }
    blocks[block] = sums;
  });
  double light = 0, reflected = 0;
  for (const Sums& sums : blocks) {
    light += sums.light;
    reflected += sums.reflected;
  }
  return light > 0 ? reflected / light : 0;
}

}  // namespace trilobe
