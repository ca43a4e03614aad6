#include "fit/finish/anisotropic_albedo.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "fit/finish/lower_g.h"
#include "fit/finish/shown_light.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

constexpr int kAzimuths = 12;
constexpr int kThetas = 9;  // of a G without azimuths
constexpr double kFarthest = DegreesToRadians(89.5);

double Azimuth(int b) { return 2 * kPi * b / kAzimuths; }

std::vector<Rgb> AlbedosAt(const FactorModel& model, std::span<const PolarAngles> incidences,
                           int num_threads) {
  const PreparedModel<double> prepared(model);
  std::vector<Rgb> albedos(incidences.size());
  ParallelFor(static_cast<int>(incidences.size()), num_threads, [&](int k) {
    const double phi = incidences[k].phi;
    albedos[k] = DirectionalAlbedo(
        [&](const DirectionPair& pair) {
          return prepared.Value(TurnedAboutNormal(pair.wi, phi), TurnedAboutNormal(pair.wo, phi));
        },
        incidences[k].theta);
  });
  return albedos;
}

// Incidences at which albedos are computed: thetas, ascending, at each azimuth.
class Incidences {
 public:
  explicit Incidences(const Axis& g_axis) {
    thetas_.push_back(DegreesToRadians(88));
    const int step = g_axis.polar() ? g_axis.phi_nodes : std::max(g_axis.size / kThetas, 1);
    for (int k = 0; k < g_axis.size; k += step) {
      thetas_.push_back(std::min(g_axis.Theta(k), kFarthest));
    }
    std::ranges::sort(thetas_);
    for (int b = 0; b < kAzimuths; ++b) {
      for (const double theta : thetas_) all_.push_back({theta, Azimuth(b)});
    }
  }

  std::span<const PolarAngles> all() const { return all_; }

  // The least value around a node of G, between the rings beside it; linear between azimuths.
  // values: [all().size()]
  double LeastAround(const Axis& g_axis, int node, double phi,
                     std::span<const double> values) const {
    const int beside = g_axis.phi_nodes, size = g_axis.size;
    const double from = node >= beside ? g_axis.Theta(node - beside) : -1;
    const double to = node + beside < size ? g_axis.Theta(node + beside) : kPi;
    const double turns = phi / (2 * kPi) * kAzimuths, left = std::floor(turns), t = turns - left;
    const auto value = [&](int b, size_t a) { return values[b % kAzimuths * thetas_.size() + a]; };
    const int b = static_cast<int>(left);
    double least = 1;
    for (size_t a = 0; a < thetas_.size(); ++a) {
      if (!(thetas_[a] > from && thetas_[a] < to)) continue;
      least = std::min(least, (1 - t) * value(b, a) + t * value(b + 1, a));
    }
    return least;
  }

 private:
  std::vector<double> thetas_;
  std::vector<PolarAngles> all_;
};

}  // namespace

Rgb AnisotropicAlbedoLimit(const Objective& data, const FactorModel& model) {
  Rgb limit;
  limit.fill(LimitByShown(data.samples(), model, data.num_threads()));
  return limit;
}

bool LimitAnisotropicAlbedo(const Rgb& limit, const TableLayout& layout, int num_threads,
                            const StopCheck& stop, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  const Axis& axis = spec.g_axis;
  const Incidences incidences(axis);
  const auto factors_at = [&](std::span<const size_t> numbers) {
    std::vector<PolarAngles> at;
    std::vector<double> factors;
    for (const size_t k : numbers) at.push_back(incidences.all()[k]);
    for (const Rgb& albedo : AlbedosAt(*model, at, num_threads)) {
      factors.push_back(FactorOfG(albedo, limit, model->d()));
    }
    return factors;
  };
  const auto lower_by = [&](const std::vector<double>& factors) {
    for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
      for (const int k : layout.of(Factor::kG, t)) {
        double least = 1;
        for (int b = 0; b < (axis.polar() ? 1 : kAzimuths); ++b) {
          const double phi = axis.polar() ? axis.Phi(k) : Azimuth(b);
          least = std::min(least, incidences.LeastAround(axis, k, phi, factors));
        }
        model->table(Factor::kG, t)[k] *= least;
      }
    }
    ExpandStored(layout, model);
  };
  return LowerWhileExceeding(0, incidences.all().size(), kPassesOfG, stop, factors_at, lower_by);
}

PeakAlbedo PeakAnisotropicAlbedo(const FactorModel& model, int num_threads) {
  const Incidences incidences(model.spec().g_axis);
  const std::vector<Rgb> albedos = AlbedosAt(model, incidences.all(), num_threads);
  PeakAlbedo peak;
  for (size_t k = 0; k < albedos.size(); ++k) {
    const double here = std::ranges::max(albedos[k]);
    if (here > peak.albedo) peak = {.albedo = here, .theta_i = incidences.all()[k].theta};
  }
  return peak;
}

}  // namespace trilobe
