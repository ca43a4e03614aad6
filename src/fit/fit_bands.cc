#include "trilobe/fit/fit_bands.h"

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "fit/band_sums.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/nonnegative_step.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {
namespace {

// y of a channel of the model.
std::vector<double> ParametersOf(const FactorModel& rgb, int channel) {
  std::vector<double> y = {rgb.d()[channel]};
  const ModelSpec& spec = rgb.spec();
  for (int m = 0; m < spec.lobes; ++m) y.push_back(rgb.s(m)[channel]);
  for (int m = 0; m < (spec.F.per_lobe ? spec.lobes : std::min(spec.lobes, 1)); ++m) {
    const std::span<const double> F = rgb.F(m, channel);
    y.insert(y.end(), F.begin(), F.end());
  }
  return y;
}

// The minimum over one band's parameters from several starting points.
class BandSolver {
 public:
  BandSolver(const BandSums& sums, bool own_F, int band)
      : sums_(sums), own_F_(own_F), band_(band), parts_(sums.Parts()) {}

  void From(std::vector<double> y) {
    MinimizeOver(&y, /*F=*/false, 1);
    const double E = own_F_ ? MinimizeOver(&y, /*F=*/true, kMostSteps) : sums_.Value(band_, y);
    if (best_.empty() || E < best_E_) {
      best_ = std::move(y);
      best_E_ = E;
    }
  }

  const std::vector<double>& best() const { return best_; }

 private:
  static constexpr int kMostSteps = 200;

  // Damped steps of all parameters, or of d and s alone, of which E is a quadratic function.
  // Returns E.
  double MinimizeOver(std::vector<double>* y, bool F, int most_steps) {
    constexpr double kLeast = 1e-12, kMost = 1e8, kSmall = 1e-9;
    double lambda = F ? 1e-3 : kLeast;
    double E = sums_.Value(band_, *y);
    const double rounding = 1e-15 * sums_.energy()[band_];
    for (int k = 0; k < most_steps; ++k) {
      const QuadraticModel at = sums_.Linearized(band_, *y);
      std::vector<double> metric = DampingMetric(parts_, at.squared_lengths);
      if (!F) std::fill(metric.end() - sums_.num_F(), metric.end(), 0.0);
      NonnegativeStep step;
      step.MoveTo(at, metric, *y);
      double lower = E;
      for (; !(lower < E) && lambda < kMost; lambda *= 4) {
        NonnegativeStep::Result tried = step.Solve(lambda);
        const double there = sums_.Value(band_, tried.x);
        if (!(there < E)) continue;
        lower = there;
        *y = std::move(tried.x);
      }
      const bool converged = !(E - lower > kSmall * E + rounding);
      E = lower;
      if (converged) break;
      lambda = std::max(lambda / 20, kLeast);  // a fifth of the one that was taken
    }
    return E;
  }

  const BandSums& sums_;
  const bool own_F_;
  const int band_;
  const std::vector<FactorModel::Part> parts_;
  std::vector<double> best_;
  double best_E_ = std::numeric_limits<double>::infinity();
};

void SetBand(std::span<const double> y, int band, SpectralModel* model) {
  const ModelSpec& spec = model->spec();
  model->d()[band] = y[0];
  for (int m = 0; m < spec.lobes; ++m) {
    model->s(m)[band] = y[1 + m];
    const auto F = model->F(m, band);
    std::ranges::copy(y.subspan(1 + spec.lobes + (spec.F.per_lobe ? m * F.size() : 0), F.size()),
                      F.begin());
  }
}

// Beyond and between the entries that samples read, F is the mean F of the colours, times what it
// is of that at these entries.
void FillUnread(const Objective& objective, const FactorModel& rgb, SpectralModel* model) {
  const ModelSpec& spec = rgb.spec();
  for (int m = 0; m < (spec.F.per_lobe ? spec.lobes : std::min(spec.lobes, 1)); ++m) {
    const int size = spec.table_size(Factor::kF);
    const int offset = rgb.TableOffset(Factor::kF, spec.table(Factor::kF, m, 0));
    std::vector<int> read;
    std::vector<double> mean(size);
    for (int k = 0; k < size; ++k) {
      if (objective.coverage()[offset + k] > 0) read.push_back(k);
      for (int c = 0; c < kChannels; ++c) mean[k] += rgb.F(m, c)[k] / kChannels;
    }
    if (read.empty() || static_cast<int>(read.size()) == size) continue;
    for (int l = 0; l < model->bands(); ++l) {
      const std::span<double> F = model->F(m, l);
      const auto ratio = [&](int node) {
        const int k = read[node];
        return mean[k] > 0 ? F[k] / mean[k] : 1;
      };
      for (int k = 0, next = 0; k < size; ++k) {
        if (next < static_cast<int>(read.size()) && read[next] == k) {
          ++next;
          continue;
        }
        const auto [left, right, t] = WeightsAt(read, k);
        F[k] = mean[k] * ((1 - t) * ratio(left) + t * ratio(right));
      }
    }
  }
}

// Lobes that share an F reflect 4 s together.
void SetScale(const Objective& objective, SpectralModel* model) {
  const ModelSpec& spec = model->spec();
  for (int first = 0; first < model->bands(); first += kChannels) {
    const LobeLight light =
        ComputeLobeLight(objective.coverage(), model->ThreeBands(first), objective.num_threads());
    for (int l = first; l < std::min(first + kChannels, model->bands()); ++l) {
      for (int m = 0; m < spec.lobes; m += spec.F.per_lobe ? 1 : spec.lobes) {
        const int end = spec.F.per_lobe ? m + 1 : spec.lobes;
        double albedo = 0, four_s = 0;
        for (int n = m; n < end; ++n) {
          albedo += light.lobes[n][l - first];
          four_s += 4 * model->s(n)[l];
        }
        const bool reflects = albedo > 0 && four_s > 0;
        for (int n = m; n < end; ++n) model->s(n)[l] *= reflects ? albedo / four_s : 0;
        for (double& x : model->F(m, l)) x = reflects ? x * four_s / albedo : 1;
      }
    }
  }
}

}  // namespace

void CheckBands(const std::string& source, const BrdfSamples& samples, const ModelSpec& spec) {
  if (samples.spectra == nullptr) {
    throw ErrorIn(ErrorKind::kMissing, source,
                  "its samples have no spectra, so there is no model of wavelengths; leave out "
                  "--spectral")
        .About("spectra");
  }
  if (spec.D.per_channel || spec.G.per_channel) {
    throw Error(ErrorKind::kConflict,
                "--spectral takes a form whose channels share D and G, as the default does")
        .About("spectral", "D, G");
  }
}

Objective WithSpectra(const Objective& data, const Measurement& measurement) {
  if (!measurement.table) return data;
  const BrdfSamples &all = data.samples(), &some = measurement.samples;
  std::vector<int> kept;
  for (int j = 0; j < some.size(); ++j) {
    const auto found = std::ranges::lower_bound(all.bins, some.bins[j]);
    if (found == all.bins.end() || *found != some.bins[j]) continue;
    if (all.rho[found - all.bins.begin()] == some.rho[j]) kept.push_back(j);
  }
  if (kept.empty()) {
    throw ErrorIn(ErrorKind::kData, measurement.source,
                  "no sample that is fitted has a spectrum with its value; leave out what changes "
                  "values")
        .About("spectra");
  }
  return {Selected(some, kept), data.spec(), data.weighting(), data.num_threads()};
}

BandsFit FitBands(const Objective& objective, const FactorModel& rgb, const StopCheck& stop) {
  const Objective& data = objective.data();  // a prior has no spectra
  const BrdfSamples& samples = data.samples();
  CheckBands(samples.source, samples, rgb.spec());
  CheckSameSpec(rgb.spec(), data.spec());
  BandsFit fit = {.model = SpectralModel(rgb.spec(), samples.spectra->wavelengths),
                  .objective = {},
                  .black = {}};
  SpectralModel& model = fit.model;
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < rgb.spec().num_tables(factor); ++t) {
      std::ranges::copy(rgb.table(factor, t), model.table(factor, t).begin());
    }
  }
  const BandSums sums(data, rgb);
  std::vector<std::vector<double>> best(sums.bands());
  ParallelFor(sums.bands(), data.num_threads(), [&](int band) {
    BandSolver solver(sums, rgb.spec().F.per_channel, band);
    for (int c = 0; c < kChannels && (c == 0 || !stop()); ++c) solver.From(ParametersOf(rgb, c));
    best[band] = solver.best();
  });
  for (int band = 0; band < sums.bands(); ++band) SetBand(best[band], band, &model);
  if (rgb.spec().F.per_channel) {
    FillUnread(data, rgb, &model);
    SetScale(data, &model);
  }
  fit.black = sums.energy();
  fit.objective.assign(sums.bands(), 0.0);
  std::vector<double> rho(sums.bands());
  for (int j = 0; j < samples.size(); ++j) {
    const WeightedSample sample = data.Sample(j);
    UnclampedValues(model, sample.stencils, rho);
    const std::span<const double> measured = samples.SpectrumOf(j);
    for (size_t l = 0; l < rho.size(); ++l) {
      const double off = rho[l] - measured[l];
      fit.objective[l] += Mean(sample.weight) * off * off;
    }
  }
  return fit;
}

}  // namespace trilobe
