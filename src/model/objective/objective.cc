#include "trilobe/model/objective/objective.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/batch_evaluator.h"
#include "model/objective/stencils_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/lobes/reconstruct.h"

namespace trilobe {
namespace {

// Whether each sample reads a single entry of D and of F: the samples are on a grid with the
// tables' bins, and D is not stretched. Without lobes nothing is read, but the tables must have an
// entry for each bin of the grid.
bool ReadsBinByBin(const ModelSpec& spec, const BrdfSamples& samples) {
  if (!samples.on_grid() || spec.stretches.any()) return false;
  const int d = spec.d_axis.size, f = spec.f_axis.size;
  const MerlGrid& grid = samples.grid;
  return (d == grid.theta_h && f == grid.theta_d) ||
         (spec.lobes == 0 && d >= grid.theta_h && f >= grid.theta_d);
}

void CheckReadable(const ModelSpec& spec, const BrdfSamples& samples) {
  CheckSpec(spec);
  if (samples.on_grid()) {
    CheckIsotropic(spec, "a measurement on a MERL grid, which knows no azimuths,");
  } else if (spec.anisotropic() && samples.directions.empty()) {
    throw Error(samples.source + ": the samples' azimuths are not known; fit an isotropic model");
  }
}

// In this range products of factors and squares of residuals neither overflow nor vanish. Black
// measurements are exact.
void CheckRange(const BrdfSamples& samples) {
  constexpr double kMinBrdf = 1e-50, kMaxBrdf = 1e50;
  double largest = 0;
  const double* const values = samples.rho.front().data();
#pragma omp simd reduction(max : largest)
  for (size_t k = 0; k < kChannels * samples.rho.size(); ++k) {
    largest = values[k] > largest ? values[k] : largest;
  }
  if (largest == 0 || (largest >= kMinBrdf && largest <= kMaxBrdf)) return;
  std::ostringstream message;
  const auto at = std::ranges::find_if(
      samples.rho, [&](const Rgb& rho) { return std::ranges::max(rho) == largest; });
  message << samples.source << ": sample " << at - samples.rho.begin() << ", the largest, is "
          << largest << "/sr; that must be from " << kMinBrdf << " to " << kMaxBrdf
          << ": check the file, or multiply all values by 2^" << -std::ilogb(largest);
  throw Error(message.str());
}

// Checks that weights are >= 0 and keep E in range.
void CheckWeights(const std::string& weighting, bool nonnegative, double energy) {
  constexpr double kMinEnergy = 1e-200, kMaxEnergy = 1e200;
  if (!nonnegative) {
    throw Error("weighting '" + weighting + "' gives a weight that is negative or no number");
  }
  if (energy == 0 || (energy >= kMinEnergy && energy <= kMaxEnergy)) return;
  std::ostringstream message;
  message << "weighting '" << weighting
          << "' and the samples' multiplicities make a black model's E " << energy
          << ", out of the range from " << kMinEnergy << " to " << kMaxEnergy
          << "; multiply them by another factor";
  throw Error(message.str());
}

BrdfSamples Checked(BrdfSamples samples, const ModelSpec& spec, int num_threads) {
  if (num_threads < 1) {
    throw Error("num_threads is " + std::to_string(num_threads) + "; give 1 or more");
  }
  if (samples.size() == 0) {
    throw Error(samples.source + ": no sample; an objective needs one or more");
  }
  CheckReadable(spec, samples);
  CheckSamples(samples);
  CheckRange(samples);
  return samples;
}

bool AllNonnegative(std::span<const double> weights) {  // or NaN, which E shows
  const double* const w = weights.data();
  const size_t size = weights.size();
  double least = 0;
#pragma omp simd reduction(min : least)
  for (size_t k = 0; k < size; ++k) least = w[k] < least ? w[k] : least;
  return least == 0;
}

CoverageByChannel ScatteredCoverage(const FoldedSamples& samples, const ModelSpec& spec) {
  CoverageByChannel coverage;
  for (int c = 0; c < kChannels; ++c) {
    FactorCoverage& observed = coverage[c];
    observed.D.assign(samples.order.of_D, std::vector<double>(spec.d_axis.size, 0.0));
    observed.F.assign(spec.f_axis.size, 0.0);
    observed.G.assign(spec.g_axis.size, 0.0);
    for (int r = 0; r < samples.order.count(); ++r) {
      const Factor factor = samples.order.factor(r);
      std::vector<double>& table = factor == Factor::kD   ? observed.D[r]
                                   : factor == Factor::kF ? observed.F
                                                          : observed.G;
      const FoldedSamples::Lookup& lookup = samples.lookups[r];
      for (int j = 0; j < samples.size(); ++j) {
        const Cell& cell = samples.cells_of(factor)[lookup.cell[j]];
        for (int k = 0; k < cell.size; ++k) {
          table[cell.entry[k]] += samples.weight[c][j] * std::abs(lookup.weight[k][j]);
        }
      }
    }
  }
  return coverage;
}

// Sums for each parameter the weight of its channels' samples.
std::vector<double> CoverageOfParameters(const CoverageByChannel& by_channel,
                                         const ModelSpec& spec) {
  FactorModel coverage(spec);  // borrowed for its layout: an entry a parameter
  for (int c = 0; c < kChannels; ++c) {
    double total = 0;
    for (const double w : by_channel[c].D[0]) total += w;
    coverage.d()[c] = total;
    for (int m = 0; m < spec.lobes; ++m) coverage.s(m)[c] = total;
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        const auto [begin, end] = spec.channels(factor, t);
        if (c < begin || c >= end) continue;
        const std::vector<double>& from = factor == Factor::kD
                                              ? by_channel[c].D[spec.StretchOfTable(t)]
                                          : factor == Factor::kF ? by_channel[c].F
                                                                 : by_channel[c].G;
        const std::span<double> target = coverage.table(factor, t);
        for (size_t k = 0; k < target.size(); ++k) target[k] += from[k];
      }
    }
  }
  return {coverage.parameters().begin(), coverage.parameters().end()};
}

}  // namespace

struct Objective::Prepared {
  Prepared(BrdfSamples all, const ModelSpec& form, const Weighting& weights, int num_threads)
      : samples(Checked(std::move(all), form, num_threads)),
        spec(form),
        weighting(ForSamples(weights, samples, num_threads)) {
    bool nonnegative = true;
    if (ReadsBinByBin(spec, samples)) {
      folded =
          std::make_unique<FoldedGrid>(Fold(samples, spec.g_axis.size, weighting, num_threads));
      measured_energy = folded->measured_energy;
      coverage = FoldedCoverage(*folded);
      for (const std::vector<double>& w : folded->weight) {
        nonnegative = nonnegative && AllNonnegative(w);
      }
    } else {
      std::atomic<bool> negative = false;
      const auto make = [&](int j) {
        WeightedSample sample = Sample(j);
        if (!AllNonnegative(sample.weight)) negative = true;
        return sample;
      };
      folded_samples = std::make_unique<FoldedSamples>(Fold(samples.size(), make, num_threads));
      nonnegative = !negative;
      measured_energy = folded_samples->measured_energy;
      coverage = ScatteredCoverage(*folded_samples, spec);
    }
    CheckWeights(weighting.name, nonnegative, measured_energy);
  }

  WeightedSample Sample(int j) const {
    WeightedSample sample;
    sample.stencils = StencilsOf(spec, samples, j);
    sample.rho = samples.rho[j];
    sample.weight = weighting({sample.rho, samples.CosinesOf(j), samples.SolidAngle(j)});
    for (double& w : sample.weight) w *= samples.Multiplicity(j);
    return sample;
  }

  std::vector<WeightedSample> AllSamples(int num_threads) const {
    std::vector<WeightedSample> all(samples.size());
    constexpr int kChunk = 4096;
    ParallelFor((samples.size() + kChunk - 1) / kChunk, num_threads, [&](int chunk) {
      const int end = std::min((chunk + 1) * kChunk, samples.size());
      for (int j = chunk * kChunk; j < end; ++j) all[j] = Sample(j);
    });
    return all;
  }

  const std::vector<WeightedSample>& WeightedSamples(int num_threads) const {
    std::call_once(weighted_samples_once, [&] { weighted_samples = AllSamples(num_threads); });
    return weighted_samples;
  }

  const BrdfSamples samples;
  const ModelSpec spec;  // of which axes and stretches count
  const Weighting weighting;
  double measured_energy = 0;
  CoverageByChannel coverage;
  std::unique_ptr<const FoldedGrid> folded;
  std::unique_ptr<const FoldedSamples> folded_samples;
  mutable std::once_flag spline_cells_once;
  mutable std::unique_ptr<const SplineCells> spline_cells;
  mutable std::once_flag weighted_samples_once;
  mutable std::vector<WeightedSample> weighted_samples;
};

Objective::Objective(BrdfSamples samples, const ModelSpec& spec, const Weighting& weighting,
                     int num_threads)
    : prepared_(std::make_shared<Prepared>(std::move(samples), spec, weighting, num_threads)),
      spec_(spec),
      num_threads_(num_threads),
      coverage_(CoverageOfParameters(prepared_->coverage, spec)) {}

Objective::Objective(const Objective& other, const ModelSpec& spec)
    : prepared_(other.prepared_), spec_(spec), num_threads_(other.num_threads_) {
  CheckReadable(spec, samples());
  const bool reads_alike = spec.stretches.distinct() == other.spec_.stretches.distinct() &&
                           std::ranges::all_of(kFactors, [&](Factor factor) {
                             return spec.axis(factor) == other.spec_.axis(factor);
                           });
  if (!reads_alike) {
    prepared_ = std::make_shared<Prepared>(samples(), spec, weighting(), num_threads_);
  }
  coverage_ = CoverageOfParameters(prepared_->coverage, spec);
  if (other.has_prior()) data_ = std::make_shared<const Objective>(other.data(), spec);
}

Objective Objective::Alone(int num_threads) const {
  Objective alone = *this;
  alone.num_threads_ = num_threads;
  alone.data_ = nullptr;
  return alone;
}

Objective::Objective(const Objective& data, BrdfSamples with_prior)
    : Objective(std::move(with_prior), data.spec(), data.weighting(), data.num_threads()) {
  data_ = std::make_shared<const Objective>(data);
}

const BrdfSamples& Objective::samples() const { return prepared_->samples; }

const Weighting& Objective::weighting() const { return prepared_->weighting; }

double Objective::MeasuredEnergy() const { return prepared_->measured_energy; }

double Objective::IrreducibleEnergy() const {
  return folded() != nullptr ? folded()->constant : folded_samples()->constant;
}

const FoldedGrid* Objective::folded() const { return prepared_->folded.get(); }

const FoldedSamples* Objective::folded_samples() const { return prepared_->folded_samples.get(); }

double Objective::Value(const FactorModel& model) const {
  CheckSameSpec(model.spec(), spec_);
  return folded() != nullptr ? FoldedValue(*folded(), model, num_threads_)
                             : FoldedValue(*folded_samples(), model, num_threads_);
}

const SplineCells& Objective::spline_cells() const {
  if (folded() == nullptr) throw Error(samples().source + ": the samples are on no grid");
  std::call_once(prepared_->spline_cells_once,
                 [this] { prepared_->spline_cells = std::make_unique<SplineCells>(*folded()); });
  return *prepared_->spline_cells;
}

WeightedSample Objective::Sample(int j) const {
  if (j < 0 || j >= samples().size()) {
    throw Error(samples().source + ": there is no sample " + std::to_string(j) + " among " +
                std::to_string(samples().size()));
  }
  return prepared_->Sample(j);
}

const std::vector<WeightedSample>& Objective::weighted_samples() const {
  return prepared_->WeightedSamples(num_threads_);
}

BrdfSamples Reweighted(const Objective& objective, const FactorModel& model, double delta) {
  CheckSameSpec(objective.spec(), model.spec());
  if (!(delta > 0)) throw Error("the error from which a loss is linear must be above 0");
  BrdfSamples samples = objective.samples();
  const std::vector<Rgb> fitted = UnclampedSamples(model, samples, objective.num_threads());
  const double level = objective.weighting().level;
  const double unit = level > 0 ? level : 1;
  samples.multiplicity.resize(samples.rho.size());
  for (int j = 0; j < samples.size(); ++j) {
    // In units of the level if the weighting uses it. Without the solid angle, which is a number of
    // samples and not an error.
    const Rgb w = objective.weighting()({samples.rho[j], samples.CosinesOf(j)});
    double square = 0;
    for (int c = 0; c < kChannels; ++c) {
      const double difference = fitted[j][c] - samples.rho[j][c];
      square += w[c] * difference * difference / kChannels;
    }
    samples.multiplicity[j] =
        objective.samples().Multiplicity(j) * std::min(1.0, delta * unit / std::sqrt(square));
  }
  return samples;
}

}  // namespace trilobe
