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

#include "core/system/evaluation_count.h"
#include "model/measurement/join_samples.h"
#include "model/measurement/sample_numbers.h"
#include "model/objective/batch_evaluator.h"
#include "model/objective/stencils_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

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
    throw ErrorIn(ErrorKind::kMissing, samples.source,
                  "the samples' azimuths are not known; fit an isotropic model")
        .About("directions");
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
  const std::string number = std::to_string(at - samples.rho.begin());
  message << samples.source << ": sample " << number << ", the largest, is " << largest
          << "/sr; that must be from " << kMinBrdf << " to " << kMaxBrdf
          << ": check the file, or multiply all values by 2^" << -std::ilogb(largest);
  throw Error(ErrorKind::kRange, message.str())
      .At(samples.source)
      .About("sample " + number, largest);
}

// Checks that weights are >= 0 and keep E in range.
void CheckWeights(const std::string& weighting, bool nonnegative, double energy) {
  constexpr double kMinEnergy = 1e-200, kMaxEnergy = 1e200;
  if (!nonnegative) {
    throw Error(ErrorKind::kRange,
                "weighting '" + weighting + "' gives a weight that is negative or no number")
        .About("weighting", weighting);
  }
  if (energy == 0 || (energy >= kMinEnergy && energy <= kMaxEnergy)) return;
  std::ostringstream message;
  message << "weighting '" << weighting
          << "' and the samples' multiplicities make a black model's E " << energy
          << ", out of the range from " << kMinEnergy << " to " << kMaxEnergy
          << "; multiply them by another factor";
  throw Error(ErrorKind::kRange, message.str()).About("weighting", weighting);
}

const BrdfSamples& Checked(const BrdfSamples& samples, const ModelSpec& spec, int num_threads) {
  if (num_threads < 1) {
    throw Error(ErrorKind::kRange,
                "num_threads is " + std::to_string(num_threads) + "; give 1 or more")
        .About("num_threads", num_threads);
  }
  if (samples.size() == 0) {
    throw ErrorIn(ErrorKind::kData, samples.source, "no sample; an objective needs one or more")
        .About("samples", 0);
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
  Prepared(std::shared_ptr<const BrdfSamples> all, const ModelSpec& form, const Weighting& weights,
           int num_threads)
      : own(std::move(all)),
        spec(form),
        weighting(ForSamples(weights, Checked(*own, form, num_threads), num_threads)) {
    if (ReadsBinByBin(spec, *own)) {
      folded =
          std::make_shared<const FoldedGrid>(Fold(*own, spec.g_axis.size, weighting, num_threads));
      measured_energy = folded->measured_energy;
      irreducible_energy = folded->constant;
      coverage = FoldedCoverage(*folded);
      CheckWeights(weighting.name, std::ranges::all_of(folded->weight, AllNonnegative),
                   measured_energy);
    } else {
      FoldedPart none;
      FoldAll(num_threads, &none);
    }
  }

  // Nothing is computed yet.
  Prepared(std::shared_ptr<const Prepared> data, std::shared_ptr<const BrdfSamples> samples,
           const ModelSpec& form, Weighting weights)
      : measured(std::move(data)),
        own(std::move(samples)),
        spec(form),
        weighting(std::move(weights)) {}

  // The samples of `data`, which are scattered, and others behind them.
  Prepared(std::shared_ptr<const Prepared> data, BrdfSamples added, int num_threads)
      : measured(std::move(data)),
        own(std::make_shared<const BrdfSamples>(std::move(added))),
        spec(measured->spec),
        weighting(measured->weighting) {
    CheckSamples(*own);
    FoldedPart part;
    FoldAll(num_threads, &part);
    part.whole = folded_samples;
    const std::lock_guard<std::mutex> lock(measured->mutex);
    measured->as_part = std::make_shared<const FoldedPart>(std::move(part));
  }

  void FoldAll(int num_threads, FoldedPart* part) {
    std::atomic<bool> negative = false;
    const auto make = [&](int j) {
      WeightedSample sample = Sample(j);
      if (!AllNonnegative(sample.weight)) negative = true;
      return sample;
    };
    folded_samples = std::make_shared<const FoldedSamples>(
        FoldWithPart(size(), make, num_threads, num_measured(), part));
    measured_energy = folded_samples->measured_energy;
    irreducible_energy = folded_samples->constant;
    coverage = ScatteredCoverage(*folded_samples, spec);
    CheckWeights(weighting.name, !negative, measured_energy);
  }

  int num_measured() const { return measured == nullptr ? 0 : measured->size(); }
  int size() const { return num_measured() + own->size(); }

  const BrdfSamples& AllSamples() const {
    if (measured == nullptr) return *own;
    std::call_once(joined_once, [&] { joined = JoinSamples(measured->AllSamples(), *own); });
    return joined;
  }

  // In ascending order.
  BrdfSamples Selected(std::vector<int> numbers) const {
    if (measured == nullptr) return trilobe::Selected(*own, numbers);
    const auto middle = std::ranges::lower_bound(numbers, num_measured());
    std::vector<int> of_own(middle, numbers.end());
    numbers.erase(middle, numbers.end());
    for (int& j : of_own) j -= num_measured();
    return JoinSamples(measured->Selected(std::move(numbers)), trilobe::Selected(*own, of_own));
  }

  WeightedSample Sample(int j) const {
    if (j < num_measured()) return measured->Sample(j);
    j -= num_measured();
    WeightedSample sample;
    sample.stencils = StencilsOf(spec, *own, j);
    sample.rho = own->rho[j];
    sample.weight = weighting({sample.rho, own->CosinesOf(j), own->SolidAngle(j)});
    for (double& w : sample.weight) w *= own->Multiplicity(j);
    return sample;
  }

  std::vector<WeightedSample> AllWeighted(int num_threads) const {
    std::vector<WeightedSample> all(size());
    constexpr int kChunk = 4096;
    ParallelFor((size() + kChunk - 1) / kChunk, num_threads, [&](int chunk) {
      const int end = std::min((chunk + 1) * kChunk, size());
      for (int j = chunk * kChunk; j < end; ++j) all[j] = Sample(j);
    });
    return all;
  }

  const std::vector<WeightedSample>& WeightedSamples(int num_threads) const {
    std::call_once(weighted_samples_once, [&] { weighted_samples = AllWeighted(num_threads); });
    return weighted_samples;
  }

  // Made anew after ReleaseFold.
  std::shared_ptr<const FoldedSamples> Folded(int num_threads) const {
    const std::lock_guard<std::mutex> lock(mutex);
    if (folded_samples == nullptr) {
      folded_samples = std::make_shared<const FoldedSamples>(Fold(
          size(), [&](int j) { return Sample(j); }, num_threads));
    }
    return folded_samples;
  }

  // The samples as part of those of a prior, if they have no fold of their own.
  std::shared_ptr<const FoldedPart> Part() const {
    const std::lock_guard<std::mutex> lock(mutex);
    return folded_samples == nullptr ? as_part : nullptr;
  }

  // The same with other samples, which are equal.
  std::shared_ptr<Prepared> With(std::shared_ptr<const BrdfSamples> samples) const {
    const std::lock_guard<std::mutex> lock(mutex);
    auto copy = std::make_shared<Prepared>(measured, std::move(samples), spec, weighting);
    copy->measured_energy = measured_energy;
    copy->irreducible_energy = irreducible_energy;
    copy->coverage = coverage;
    copy->folded = folded;
    copy->folded_samples = folded_samples;
    copy->as_part = as_part;
    return copy;
  }

  void ReleaseFold() const {
    const std::lock_guard<std::mutex> lock(mutex);
    folded_samples.reset();
    as_part.reset();
  }

  const std::shared_ptr<const Prepared> measured;  // whose samples come first, or null
  const std::shared_ptr<const BrdfSamples> own;
  const ModelSpec spec;  // of which axes and stretches count
  const Weighting weighting;
  double measured_energy = 0, irreducible_energy = 0;
  CoverageByChannel coverage;
  std::shared_ptr<const FoldedGrid> folded;
  mutable std::mutex mutex;  // of what ReleaseFold changes
  mutable std::shared_ptr<const FoldedSamples> folded_samples;
  mutable std::shared_ptr<const FoldedPart> as_part;
  mutable std::once_flag joined_once;
  mutable BrdfSamples joined;
  mutable std::once_flag spline_cells_once;
  mutable std::unique_ptr<const SplineCells> spline_cells;
  mutable std::once_flag weighted_samples_once;
  mutable std::vector<WeightedSample> weighted_samples;
};

Objective::Objective(BrdfSamples samples, const ModelSpec& spec, const Weighting& weighting,
                     int num_threads)
    : Objective(std::make_shared<const BrdfSamples>(std::move(samples)), spec, weighting,
                num_threads) {}

Objective::Objective(std::shared_ptr<const BrdfSamples> samples, const ModelSpec& spec,
                     const Weighting& weighting, int num_threads)
    : prepared_(std::make_shared<Prepared>(std::move(samples), spec, weighting, num_threads)),
      spec_(spec),
      num_threads_(num_threads),
      coverage_(CoverageOfParameters(prepared_->coverage, spec)) {}

Objective::Objective(const Objective& other, const ModelSpec& spec)
    : prepared_(other.prepared_), spec_(spec), num_threads_(other.num_threads_) {
  CheckReadable(spec, *prepared_->own);
  const bool reads_alike = spec.stretches.distinct() == other.spec_.stretches.distinct() &&
                           std::ranges::all_of(kFactors, [&](Factor factor) {
                             return spec.axis(factor) == other.spec_.axis(factor);
                           });
  if (!reads_alike) {
    std::shared_ptr<const BrdfSamples> all = prepared_->measured == nullptr
                                                 ? prepared_->own
                                                 : std::make_shared<const BrdfSamples>(samples());
    prepared_ = std::make_shared<Prepared>(std::move(all), spec, weighting(), num_threads_);
  }
  coverage_ = CoverageOfParameters(prepared_->coverage, spec);
  if (other.has_prior()) data_ = std::make_shared<const Objective>(other.data(), spec);
}

Objective::Objective(Objective objective, BrdfSamples added, double weight)
    : spec_(objective.spec()), num_threads_(objective.num_threads()) {
  if (objective.prepared_->own->on_grid()) {
    throw ErrorIn(ErrorKind::kUnsupported, objective.prepared_->own->source,
                  "samples are added to scattered ones alone")
        .About("grid");
  }
  added.multiplicity.assign(added.rho.size(), weight);
  std::shared_ptr<const Prepared> shared = objective.prepared_;
  if (added.size() == 0) {
    data_ = std::make_shared<const Objective>(objective.data());
    prepared_ = std::move(shared);
    coverage_ = std::move(objective.coverage_);
    return;
  }
  if (objective.has_prior() && shared->measured != nullptr) {
    added = JoinSamples(*shared->own, added);
    shared = shared->measured;
  }
  data_ = objective.has_prior() ? objective.data_ : std::make_shared<const Objective>(objective);
  objective.prepared_ = nullptr;  // before there is another fold
  shared->ReleaseFold();
  prepared_ = std::make_shared<Prepared>(std::move(shared), std::move(added), num_threads_);
  coverage_ = CoverageOfParameters(prepared_->coverage, spec_);
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

const BrdfSamples& Objective::samples() const { return prepared_->AllSamples(); }

int Objective::num_samples() const { return prepared_->size(); }

bool Objective::on_grid() const { return prepared_->own->on_grid(); }

const BrdfSamples* Objective::added() const {
  return prepared_->measured != nullptr ? prepared_->own.get() : nullptr;
}

BrdfSamples Objective::Thinned(int stride) const {
  return on_grid() ? trilobe::Thinned(samples(), stride)
                   : prepared_->Selected(ThinnedNumbers(num_samples(), stride));
}

BrdfSamples Objective::Selected(std::vector<int> numbers) const {
  return prepared_->Selected(std::move(numbers));
}

BrdfSamples Objective::EvenlySpread(int count) const {
  return prepared_->Selected(EvenlySpreadNumbers(num_samples(), prepared_->own->grid, count));
}

Objective Objective::WithOwnSamples() const {
  Objective owner = *this;
  owner.prepared_ = prepared_->With(std::make_shared<const BrdfSamples>(*prepared_->own));
  return owner;
}

void Objective::ReleaseFold() const { prepared_->ReleaseFold(); }

const Weighting& Objective::weighting() const { return prepared_->weighting; }

double Objective::MeasuredEnergy() const { return prepared_->measured_energy; }

double Objective::IrreducibleEnergy() const { return prepared_->irreducible_energy; }

const FoldedGrid* Objective::folded() const { return prepared_->folded.get(); }

std::shared_ptr<const FoldedSamples> Objective::folded_samples() const {
  return folded() != nullptr ? nullptr : prepared_->Folded(num_threads_);
}

double Objective::Value(const FactorModel& model) const {
  CheckSameSpec(model.spec(), spec_);
  CountValues(1);
  if (folded() != nullptr) return FoldedValue(*folded(), model, num_threads_);
  if (const auto part = prepared_->Part()) return FoldedValue(*part, model, num_threads_);
  return FoldedValue(*folded_samples(), model, num_threads_);
}

const SplineCells& Objective::spline_cells() const {
  if (folded() == nullptr) {
    throw ErrorIn(ErrorKind::kUnsupported, samples().source, "the samples are on no grid")
        .About("grid");
  }
  std::call_once(prepared_->spline_cells_once,
                 [this] { prepared_->spline_cells = std::make_unique<SplineCells>(*folded()); });
  return *prepared_->spline_cells;
}

WeightedSample Objective::Sample(int j) const {
  if (j < 0 || j >= num_samples()) {
    throw ErrorIn(
        ErrorKind::kRange, prepared_->own->source,
        "there is no sample " + std::to_string(j) + " among " + std::to_string(num_samples()))
        .About("sample", j);
  }
  return prepared_->Sample(j);
}

const std::vector<WeightedSample>& Objective::weighted_samples() const {
  return prepared_->WeightedSamples(num_threads_);
}

}  // namespace trilobe
