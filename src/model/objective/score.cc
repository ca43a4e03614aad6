#include "trilobe/model/objective/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

constexpr int kPart = 1 << 14;
constexpr size_t kWorst = 10;
constexpr double kRelativeErrorFloor = 1e-3;  // [1/sr]

// Sorts by error, largest first; ties in sample order.
bool Worse(const WorstSample& a, const WorstSample& b) {
  return std::tuple(-a.error, a.sample, a.channel) < std::tuple(-b.error, b.sample, b.channel);
}

double LogError(double rho, double rho_star, double cos_i) {
  return std::abs(std::log1p(std::max(rho, 0.0) * cos_i) - std::log1p(rho_star * cos_i));
}

// Sums over some of the samples.
struct Sums {
  double objective = 0;
  Rgb squared{};  // of (rho - rho*) / unit
  double relative = 0;
  double log = 0;
  double max_absolute = 0;
  std::vector<WorstSample> worst;  // sorted, at most kWorst

  void Keep(const WorstSample& candidate) {
    if (worst.size() == kWorst && !Worse(candidate, worst.back())) return;
    worst.insert(std::upper_bound(worst.begin(), worst.end(), candidate, Worse), candidate);
    if (worst.size() > kWorst) worst.pop_back();
  }

  void Add(const Sums& other) {
    for (int c = 0; c < kChannels; ++c) squared[c] += other.squared[c];
    objective += other.objective;
    relative += other.relative;
    log += other.log;
    max_absolute = std::max(max_absolute, other.max_absolute);
    for (const WorstSample& sample : other.worst) Keep(sample);
  }
};

Sums SumRange(const Objective& objective, const std::vector<Rgb>& fitted, int begin, int end,
              double unit) {
  const BrdfSamples& samples = objective.samples();
  Sums sums;
  for (int j = begin; j < end; ++j) {
    const HalfDiffAngles angles = samples.Angles(j);
    const Cosines cosines = samples.CosinesOf(j);
    const double cos_i = cosines.i;
    const Rgb weights = objective.weighting()({samples.rho[j], cosines, samples.SolidAngle(j)});
    for (int c = 0; c < kChannels; ++c) {
      const double rho = fitted[j][c], rho_star = samples.rho[j][c];
      const double difference = std::abs(rho - rho_star);
      const double weight = samples.Multiplicity(j) * weights[c];
      sums.objective += weight * difference * difference;
      sums.squared[c] += difference / unit * (difference / unit);
      sums.relative += difference / (rho_star + kRelativeErrorFloor);
      sums.log += LogError(rho, rho_star, cos_i);
      sums.max_absolute = std::max(sums.max_absolute, difference);
      sums.Keep({j, c, angles, rho_star, rho, weight * difference * difference});
    }
  }
  return sums;
}

double Peak(const BrdfSamples& samples) {
  double peak = 0;
  for (const Rgb& rho : samples.rho) peak = std::max({peak, rho[0], rho[1], rho[2]});
  return peak;
}

}  // namespace

ScoreReport ScoreModel(const Objective& objective, const FactorModel& model) {
  ScoreReport report =
      ScoreValues(objective, EvaluateSamples(model, objective.samples(), objective.num_threads()));
  report.objective = objective.Value(model);
  report.irreducible_objective = objective.IrreducibleEnergy();
  if (objective.MeasuredEnergy() > 0) {
    report.relative_objective = report.objective / objective.MeasuredEnergy();
  }
  return report;
}

double MeanLogError(const BrdfSamples& samples, const FactorModel& model, int num_threads) {
  const std::vector<Rgb> fitted = EvaluateSamples(model, samples, num_threads);
  std::vector<double> parts((samples.size() + kPart - 1) / kPart);
  ParallelFor(static_cast<int>(parts.size()), num_threads, [&](int i) {
    const int end = std::min(samples.size(), (i + 1) * kPart);
    for (int j = i * kPart; j < end; ++j) {
      const double cos_i = samples.CosinesOf(j).i;
      for (int c = 0; c < kChannels; ++c) {
        parts[i] += LogError(fitted[j][c], samples.rho[j][c], cos_i);
      }
    }
  });
  return std::accumulate(parts.begin(), parts.end(), 0.0) / (kChannels * samples.size());
}

ScoreReport ScoreValues(const Objective& objective, const std::vector<Rgb>& fitted) {
  const BrdfSamples& samples = objective.samples();
  if (fitted.size() != samples.rho.size()) {
    throw ErrorIn(ErrorKind::kMismatch, samples.source,
                  std::to_string(fitted.size()) + " values for " + std::to_string(samples.size()) +
                      " samples; each needs one")
        .About("values", fitted.size());
  }
  ScoreReport report;
  report.valid_samples = samples.size();
  report.psnr_peak = Peak(samples);
  // Squares are summed in units of the peak, which keeps those of huge and tiny data in range.
  const double unit = report.psnr_peak > 0 ? report.psnr_peak : 1;

  std::vector<Sums> parts((samples.size() + kPart - 1) / kPart);
  ParallelFor(static_cast<int>(parts.size()), objective.num_threads(), [&](int i) {
    const int end = std::min(samples.size(), (i + 1) * kPart);
    parts[i] = SumRange(objective, fitted, i * kPart, end, unit);
  });
  Sums sums;
  for (const Sums& part : parts) sums.Add(part);
  report.objective = sums.objective;
  if (objective.MeasuredEnergy() > 0) {
    report.relative_objective = report.objective / objective.MeasuredEnergy();
  }

  const double n = samples.size();
  double mean_square = 0;
  for (int c = 0; c < kChannels; ++c) {
    report.rmse_channel[c] = unit * std::sqrt(sums.squared[c] / n);
    mean_square += sums.squared[c] / (n * kChannels);
  }
  report.rmse = unit * std::sqrt(mean_square);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  report.psnr_db = mean_square == 0        ? kInfinity
                   : report.psnr_peak == 0 ? -kInfinity
                                           : -10 * std::log10(mean_square);
  report.mean_relative_error = sums.relative / (n * kChannels);
  report.mean_log_error = sums.log / (n * kChannels);
  report.max_absolute_error = sums.max_absolute;
  report.worst = std::move(sums.worst);
  for (const double x : {report.objective, report.relative_objective, report.rmse,
                         report.mean_relative_error, report.mean_log_error}) {
    if (!std::isfinite(x)) {
      throw ErrorIn(ErrorKind::kData, samples.source,
                    "the model's errors overflow; its factors are too large")
          .About("model", "overflow");
    }
  }
  return report;
}

}  // namespace trilobe
