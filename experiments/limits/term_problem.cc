#include "experiments/limits/term_problem.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/algebra/symmetric_matrix.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

std::vector<bool> SharedByChannels(const TermSpec& spec) {
  const TermModel model(spec);
  std::vector<bool> shared(model.parameters().size(), false);
  for (int set = 0; set < static_cast<int>(spec.sets.size()); ++set) {
    const TableSet& tables = spec.sets[set];
    if (tables.per_channel || tables.count == 0) continue;
    std::fill_n(shared.begin() + model.TableOffset(set, 0, 0), tables.count * tables.axis.size,
                true);
  }
  return shared;
}

}  // namespace

TermProblem::TermProblem(const Objective& objective, const TermSpec& spec, bool bands)
    : spec_(spec),
      reader_((CheckTerms(spec), spec)),
      num_threads_(objective.num_threads()),
      samples_(objective.samples().size()),
      shared_(SharedByChannels(spec)) {
  const BrdfSamples& samples = objective.samples();
  if (bands && samples.spectra == nullptr) {
    throw ErrorIn(ErrorKind::kMissing, samples.source, "its samples have no spectra")
        .About("spectra");
  }
  const int channels = bands ? static_cast<int>(samples.spectra->bands()) : kChannels;
  if (spec.channels != channels) {
    throw Error(ErrorKind::kMismatch, "a model of " + std::to_string(spec.channels) +
                                          " channels, and samples of " + std::to_string(channels))
        .About("channels", spec.channels);
  }
  ParallelForShort(samples.size(), num_threads_, [&](int j) {
    Sample& sample = samples_[j];
    const WeightedSample weighted = objective.Sample(j);
    sample.at = reader_.StencilsAt(samples.Angles(j));
    if (bands) {
      const std::span<const double> rho = samples.SpectrumOf(j);
      sample.rho.assign(rho.begin(), rho.end());
      sample.weight.assign(channels, Mean(weighted.weight));
    } else {
      sample.rho.assign(weighted.rho.begin(), weighted.rho.end());
      sample.weight.assign(weighted.weight.begin(), weighted.weight.end());
    }
  });
  for (const Sample& sample : samples_) {
    for (int c = 0; c < channels; ++c) {
      energy_ += sample.weight[c] * sample.rho[c] * sample.rho[c];
    }
  }
}

void TermProblem::CheckSpec(const TermModel& model) const {
  if (!(model.spec() == spec_)) {
    throw Error(ErrorKind::kMismatch, "a model of other terms than the problem's").About("spec");
  }
}

double TermProblem::Value(const TermModel& model) const {
  CheckSpec(model);
  const int count = NumAccumulators(size());
  std::vector<double> sums(count, 0.0);
  ParallelFor(count, num_threads_, [&](int k) {
    std::vector<double> rho(spec_.channels);
    const int64_t n = size();
    for (auto j = static_cast<size_t>(n * k / count); j < static_cast<size_t>(n * (k + 1) / count);
         ++j) {
      const Sample& sample = samples_[j];
      UnclampedValues(model, reader_, sample.at, rho);
      for (int c = 0; c < spec_.channels; ++c) {
        const double off = rho[c] - sample.rho[c];
        sums[k] += sample.weight[c] * off * off;
      }
    }
  });
  double E = 0;
  for (const double sum : sums) E += sum;
  return E;
}

// Sums over samples. Of a sample it keeps the rows of J: entries that channels share, with a number
// a channel, and those of each channel alone.
class TermProblem::Accumulator {
 public:
  Accumulator(const TermProblem& problem, const TermModel& model)
      : gradient(model.parameters().size(), 0.0),
        H(gradient.size() * gradient.size(), 0.0),
        problem_(problem),
        model_(model),
        channels_(problem.spec_.channels),
        slot_(gradient.size(), -1),
        own_(channels_) {}

  std::vector<double> gradient;  // J'r
  std::vector<double> H;         // the lower triangle of J'J

  void Add(const Sample& sample) {
    Clear();
    residual_.assign(channels_, 0.0);
    for (int t = 0; t < static_cast<int>(problem_.spec_.terms.size()); ++t) AddTerm(sample, t);
    for (int c = 0; c < channels_; ++c) residual_[c] -= sample.rho[c];
    Sum(sample);
  }

 private:
  struct Entry {
    size_t parameter;
    double value;
  };

  void Clear() {
    for (const size_t p : shared_) slot_[p] = -1;
    shared_.clear();
    values_.clear();
    for (std::vector<Entry>& own : own_) {
      for (const Entry& entry : own) slot_[entry.parameter] = -1;
      own.clear();
    }
  }

  void AddEntry(size_t parameter, int c, double value) {
    int& slot = slot_[parameter];
    if (problem_.shared_[parameter]) {
      if (slot < 0) {
        slot = static_cast<int>(shared_.size());
        shared_.push_back(parameter);
        values_.resize(values_.size() + channels_, 0.0);
      }
      values_[static_cast<size_t>(slot) * channels_ + c] += value;
    } else if (slot < 0) {
      slot = static_cast<int>(own_[c].size());
      own_[c].push_back({parameter, value});
    } else {
      own_[c][slot].value += value;
    }
  }

  void AddTerm(const Sample& sample, int t) {
    const TermSpec& spec = problem_.spec_;
    const Term& term = spec.terms[t];
    const double factor = term.over_cosines ? problem_.reader_.InverseCosines(sample.at, t) : 1;
    reads_.resize(term.reads.size());
    for (int c = 0; c < channels_; ++c) {
      for (size_t r = 0; r < term.reads.size(); ++r) {
        const TermRead& read = term.reads[r];
        if (c > 0 && !spec.sets[read.set].per_channel) continue;
        const TermReader::Place& place = PlaceOf(sample, t, r);
        const std::span<const double> table = model_.table(read.set, read.table, c);
        reads_[r] = ValueOfRead(read.site, place.in(table),
                                IsPair(read.site) ? place.out(table) : 0, sample.at.correlation);
      }
      const auto product_without = [&](size_t left_out) {
        double product = factor;
        for (size_t r = 0; r < reads_.size(); ++r) {
          if (r != left_out) product *= reads_[r].value;
        }
        return product;
      };
      const double strength = model_.strength(t)[c], all = product_without(reads_.size());
      residual_[c] += strength * all;
      AddEntry(model_.StrengthOffset(t) + c, c, all);
      for (size_t r = 0; r < term.reads.size(); ++r) {
        const TermRead& read = term.reads[r];
        if (spec.sets[read.set].fixed) continue;
        const TermReader::Place& place = PlaceOf(sample, t, r);
        const size_t offset = model_.TableOffset(read.set, read.table, c);
        const double others = strength * product_without(r);
        const auto add = [&](const Stencil& stencil, double slope) {
          for (int k = 0; k < stencil.size; ++k) {
            AddEntry(offset + stencil.index[k], c, slope * stencil.weight[k]);
          }
        };
        add(place.in, others * reads_[r].by_in);
        if (IsPair(read.site)) add(place.out, others * reads_[r].by_out);
      }
    }
  }

  const TermReader::Place& PlaceOf(const Sample& sample, int t, size_t r) const {
    return sample.at.places[problem_.reader_.PlaceOf(t, static_cast<int>(r))];
  }

  // Adds J'r and the lower triangle of J'J.
  void Sum(const Sample& sample) {
    const auto add = [this](size_t p, size_t q, double value) {
      H[std::max(p, q) * gradient.size() + std::min(p, q)] += value;
    };
    for (size_t a = 0; a < shared_.size(); ++a) {
      const double* const row = &values_[a * channels_];
      weighted_.assign(channels_, 0.0);
      for (int c = 0; c < channels_; ++c) {
        weighted_[c] = sample.weight[c] * row[c];
        gradient[shared_[a]] += weighted_[c] * residual_[c];
      }
      for (size_t b = 0; b <= a; ++b) {
        const double* const other = &values_[b * channels_];
        double sum = 0;
        for (int c = 0; c < channels_; ++c) sum += weighted_[c] * other[c];
        add(shared_[a], shared_[b], sum);
      }
      for (int c = 0; c < channels_; ++c) {
        for (const Entry& entry : own_[c]) {
          add(shared_[a], entry.parameter, weighted_[c] * entry.value);
        }
      }
    }
    for (int c = 0; c < channels_; ++c) {
      for (size_t a = 0; a < own_[c].size(); ++a) {
        const double weighted = sample.weight[c] * own_[c][a].value;
        gradient[own_[c][a].parameter] += weighted * residual_[c];
        for (size_t b = 0; b <= a; ++b) {
          add(own_[c][a].parameter, own_[c][b].parameter, weighted * own_[c][b].value);
        }
      }
    }
  }

  const TermProblem& problem_;
  const TermModel& model_;
  const int channels_;
  std::vector<int> slot_;       // of each parameter in shared_, or in own_ of its channel; or -1
  std::vector<size_t> shared_;  // parameters
  std::vector<double> values_;  // [shared_][channels]
  std::vector<std::vector<Entry>> own_;  // [channels]
  std::vector<double> residual_, weighted_;
  std::vector<ReadValue> reads_;
};

void TermProblem::Linearize(const TermModel& model, QuadraticModel* result) const {
  CheckSpec(model);
  NotNull(result, "the result");
  const int count = NumAccumulators(size());
  std::vector<Accumulator> sums(count, Accumulator(*this, model));
  ParallelFor(count, num_threads_, [&](int k) {
    const int64_t n = size();
    for (auto j = static_cast<size_t>(n * k / count); j < static_cast<size_t>(n * (k + 1) / count);
         ++j) {
      sums[k].Add(samples_[j]);
    }
  });
  result->objective = Value(model);
  result->gradient = std::move(sums[0].gradient);
  result->H = std::move(sums[0].H);
  for (int k = 1; k < count; ++k) {
    for (size_t p = 0; p < result->gradient.size(); ++p) result->gradient[p] += sums[k].gradient[p];
    for (size_t p = 0; p < result->H.size(); ++p) result->H[p] += sums[k].H[p];
  }
  const size_t n = result->gradient.size();
  MirrorTriangle(Triangle::kLower, n, result->H.data(), num_threads_);
  result->squared_lengths.resize(n);
  for (size_t p = 0; p < n; ++p) result->squared_lengths[p] = result->H[p * n + p];
}

}  // namespace trilobe
