#include "trilobe/solvers/awls/sample_sweep.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "trilobe/math/bounded_quadratic.h"
#include "trilobe/math/element_step.h"

namespace trilobe {
namespace {

static_assert(1 + kMaxLobes <= kMaxBoundedUnknowns);

void ReadAll(const std::vector<WeightedSample>& samples, Stencil SampleStencils::*stencil,
             std::span<const double> table, std::vector<double>* readings) {
  for (size_t j = 0; j < samples.size(); ++j) {
    (*readings)[j] = (samples[j].stencils.*stencil)(table);
  }
}

}  // namespace

SampleSweep::Readers SampleSweep::ReadersOf(const std::vector<WeightedSample>& samples,
                                            const ModelSpec& spec, Factor factor) {
  // A sample whose two readings of G share an entry is its reader once.
  const auto for_each_entry = [&](const SampleStencils& at, const auto& visit) {
    if (factor != Factor::kG) {
      const Stencil& stencil = factor == Factor::kD ? at.D : at.F;
      for (int k = 0; k < stencil.size; ++k) visit(stencil.index[k], stencil.weight[k], 0.0);
      return;
    }
    for (int k = 0; k < at.G_i.size; ++k) {
      const int entry = at.G_i.index[k];
      visit(entry, at.G_i.weight[k], at.G_o.WeightOf(entry));
    }
    for (int k = 0; k < at.G_o.size; ++k) {
      const int entry = at.G_o.index[k];
      const bool seen = std::find(at.G_i.index.begin(), at.G_i.index.begin() + at.G_i.size,
                                  entry) != at.G_i.index.begin() + at.G_i.size;
      if (!seen) visit(entry, 0.0, at.G_o.weight[k]);
    }
  };
  Readers readers;
  readers.begin.assign(spec.table_size(factor) + 1, 0);
  for (const WeightedSample& sample : samples) {
    for_each_entry(sample.stencils, [&](int entry, double, double) { ++readers.begin[entry + 1]; });
  }
  std::partial_sum(readers.begin.begin(), readers.begin.end(), readers.begin.begin());
  readers.sample.resize(readers.begin.back());
  readers.weight.resize(readers.begin.back());
  if (factor == Factor::kG) readers.weight_o.resize(readers.begin.back());
  std::vector<int> next = readers.begin;
  for (int j = 0; j < static_cast<int>(samples.size()); ++j) {
    for_each_entry(samples[j].stencils, [&](int entry, double weight, double weight_o) {
      const int at = next[entry]++;
      readers.sample[at] = j;
      readers.weight[at] = weight;
      if (factor == Factor::kG) readers.weight_o[at] = weight_o;
    });
  }
  return readers;
}

SampleSweep::SampleSweep(const Objective& objective, PhaseSeconds* phases)
    : Sweep(/*rounds=*/1),  // each costs as much as the first
      spec_(objective.spec()),
      num_samples_(objective.samples().size()),
      phases_(phases),
      samples_(objective.weighted_samples()),
      ones_(num_samples_, 1.0),
      inverse_cosines_(num_samples_) {
  const ScopedTimer timer(&phases->preparing);
  for (const Factor factor : kFactors) {
    readers_[static_cast<int>(factor)] = ReadersOf(samples_, spec_, factor);
  }
  all_.resize(num_samples_);
  std::iota(all_.begin(), all_.end(), 0);
  for (int c = 0; c < kChannels; ++c) {
    weight_[c].resize(num_samples_);
    residual_[c].resize(num_samples_);
    for (int j = 0; j < num_samples_; ++j) weight_[c][j] = samples_[j].weight[c];
  }
  for (int j = 0; j < num_samples_; ++j) {
    inverse_cosines_[j] = samples_[j].stencils.inverse_cosines;
  }
  const auto resize = [&](Factor factor, Readings* readings) {
    readings->assign(spec_.num_tables(factor), std::vector<double>(num_samples_));
  };
  resize(Factor::kD, &D_);
  resize(Factor::kF, &F_);
  resize(Factor::kG, &G_i_);
  resize(Factor::kG, &G_o_);
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < spec_.lobes; ++m) {
      const int G = spec_.table(Factor::kG, m, c);
      lobes_[c][m] = {D_[spec_.table(Factor::kD, m, c)].data(),
                      F_[spec_.table(Factor::kF, m, c)].data(), G_i_[G].data(), G_o_[G].data()};
    }
  }
}

void SampleSweep::Evaluate(const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  for (size_t t = 0; t < D_.size(); ++t) {
    ReadAll(samples_, &SampleStencils::D, model.table(Factor::kD, static_cast<int>(t)), &D_[t]);
  }
  for (size_t t = 0; t < F_.size(); ++t) {
    ReadAll(samples_, &SampleStencils::F, model.table(Factor::kF, static_cast<int>(t)), &F_[t]);
  }
  for (size_t t = 0; t < G_i_.size(); ++t) {
    const std::span<const double> table = model.table(Factor::kG, static_cast<int>(t));
    ReadAll(samples_, &SampleStencils::G_i, table, &G_i_[t]);
    ReadAll(samples_, &SampleStencils::G_o, table, &G_o_[t]);
  }
  for (int c = 0; c < kChannels; ++c) {
    for (int j = 0; j < num_samples_; ++j) {
      double rho = model.d()[c];
      for (int m = 0; m < spec_.lobes; ++m) {
        rho += model.s(m)[c] * D(m, c, j) * F(m, c, j) * K(m, c, j);
      }
      residual_[c][j] = samples_[j].rho[c] - rho;
    }
  }
}

template <typename Respond>
void SampleSweep::Update(std::span<const int> samples, std::span<const double> weights,
                         ModelSpec::ChannelRange channels, const Respond& respond,
                         std::span<double* const> elements, double E, double* steps) {
  const int size = static_cast<int>(elements.size());
  std::array<double, kMaxBoundedUnknowns> g{}, v{};
  std::array<double, kMaxBoundedUnknowns * kMaxBoundedUnknowns> H{};
  for (int c = channels.begin; c < channels.end; ++c) {
    for (size_t n = 0; n < samples.size(); ++n) {
      const int j = samples[n];
      respond(j, c, v.data());
      const double w = weight_[c][j] * weights[n], r = residual_[c][j];
      for (int k = 0; k < size; ++k) {
        const double w_k = w * v[k];
        g[k] += w_k * r;
        for (int l = k; l < size; ++l) H[k * size + l] += w_k * weights[n] * v[l];
      }
    }
  }
  for (int k = 0; k < size; ++k) {
    for (int l = 0; l < k; ++l) H[k * size + l] = H[l * size + k];
  }
  const auto count = static_cast<size_t>(size);
  if (!MoveToMinimum({H.data(), count * count}, {g.data(), count}, E, elements, steps)) return;
  for (int c = channels.begin; c < channels.end; ++c) {
    for (size_t n = 0; n < samples.size(); ++n) {
      const int j = samples[n];
      respond(j, c, v.data());
      double change = 0;
      for (int k = 0; k < size; ++k) change += v[k] * steps[k];
      residual_[c][j] -= weights[n] * change;
    }
  }
}

void SampleSweep::UpdateAmplitudes(int channel, int first, int count, double E,
                                   FactorModel* model) {
  std::array<double*, kMaxBoundedUnknowns> elements{};
  for (int k = 0; k < count; ++k) {
    const int a = first + k;
    elements[k] = a == 0 ? &model->d()[channel] : &model->s(a - 1)[channel];
  }
  const auto respond = [&](int j, int c, double* v) {
    for (int k = 0; k < count; ++k) {
      const int m = first + k - 1;
      v[k] = m < 0 ? 1 : D(m, c, j) * F(m, c, j) * K(m, c, j);
    }
  };
  std::array<double, kMaxBoundedUnknowns> steps{};
  Update(all_, ones_, {channel, channel + 1}, respond,
         {elements.data(), static_cast<size_t>(count)}, E, steps.data());
}

void SampleSweep::UpdateEntries(Factor factor, std::span<const int> tables, int entry, double E,
                                FactorModel* model) {
  const bool is_D = factor == Factor::kD;
  const Readers& all = readers(factor);
  const size_t begin = all.begin[entry], size = all.begin[entry + 1] - begin;
  const std::span<const int> samples(all.sample.data() + begin, size);
  const std::span<const double> weights(all.weight.data() + begin, size);
  std::array<double*, kMaxBoundedUnknowns> elements{};
  std::array<std::array<int, kMaxLobes>, kChannels> element_of{};  // that a lobe reads, or -1
  const ModelSpec::ChannelRange channels = spec_.channels(factor, tables[0]);
  for (size_t k = 0; k < tables.size(); ++k) elements[k] = &model->table(factor, tables[k])[entry];
  for (int c = channels.begin; c < channels.end; ++c) {
    for (int m = 0; m < spec_.lobes; ++m) {
      const auto found = std::ranges::find(tables, spec_.table(factor, m, c));
      element_of[c][m] = found == tables.end() ? -1 : static_cast<int>(found - tables.begin());
    }
  }
  const FactorModel& now = *model;
  const auto respond = [&](int j, int c, double* v) {
    std::fill_n(v, tables.size(), 0.0);
    for (int m = 0; m < spec_.lobes; ++m) {
      const int k = element_of[c][m];
      if (k >= 0) v[k] += now.s(m)[c] * (is_D ? F(m, c, j) : D(m, c, j)) * K(m, c, j);
    }
  };
  std::array<double, kMaxBoundedUnknowns> steps{};
  Update(samples, weights, channels, respond, {elements.data(), tables.size()}, E, steps.data());
  Readings& readings = is_D ? D_ : F_;
  for (size_t k = 0; k < tables.size(); ++k) {
    if (steps[k] == 0) continue;
    for (size_t n = 0; n < size; ++n) readings[tables[k]][samples[n]] += weights[n] * steps[k];
  }
}

// rho(x + delta) = rho + p1 delta + p2 delta^2, the paper's third situation where both directions
// read the node.
void SampleSweep::UpdateNode(int table, int entry, FactorModel* model) {
  const Readers& all = readers(Factor::kG);
  const FactorModel& now = *model;
  const ModelSpec::ChannelRange channels = spec_.channels(Factor::kG, table);
  const auto for_each = [&](const auto& visit) {
    for (int c = channels.begin; c < channels.end; ++c) {
      for (int n = all.begin[entry]; n < all.begin[entry + 1]; ++n) {
        const int j = all.sample[n];
        double y = 0;
        for (int m = 0; m < spec_.lobes; ++m) {
          if (spec_.serves(Factor::kG, table, m, c)) y += now.s(m)[c] * D(m, c, j) * F(m, c, j);
        }
        y *= inverse_cosines_[j];
        const double p1 = y * (all.weight[n] * G_o_[table][j] + all.weight_o[n] * G_i_[table][j]);
        visit(c, j, p1, y * all.weight[n] * all.weight_o[n]);
      }
    }
  };
  ElementQuartic change;
  for_each([&](int c, int j, double p1, double p2) {
    change.AddSample(weight_[c][j], residual_[c][j], p1, p2);
  });
  double& element = model->table(Factor::kG, table)[entry];
  const double step = BestElement(element, change) - element;
  if (step == 0) return;
  for_each([&](int c, int j, double p1, double p2) { residual_[c][j] -= step * (p1 + step * p2); });
  element += step;
  for (int n = all.begin[entry]; n < all.begin[entry + 1]; ++n) {
    G_i_[table][all.sample[n]] += all.weight[n] * step;
    G_o_[table][all.sample[n]] += all.weight_o[n] * step;
  }
}

void SampleSweep::operator()(const OnElement& on_element, FactorModel* model) {
  Evaluate(*model);
  const auto tell = [&] {
    if (on_element) on_element(*model);
  };
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    for (int a = 0; a <= spec_.lobes; ++a) {
      for (int c = 0; c < kChannels; ++c) {
        UpdateAmplitudes(c, a, 1, 0, model);
        tell();
      }
    }
    for (const Factor factor : {Factor::kD, Factor::kF}) {
      for (int t = 0; t < spec_.num_tables(factor); ++t) {
        for (int k = 0; k < spec_.table_size(factor); ++k) {
          UpdateEntries(factor, {&t, 1}, k, 0, model);
          tell();
        }
      }
    }
  }
  UpdateG(on_element, model);
}

void SampleSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block,
                               FactorModel* model) {
  Evaluate(*model);
  const ScopedTimer timer(&phases_->linear_algebra);
  const auto tell = [&] {
    if (on_block) on_block(*model);
  };
  for (int round = 0; round < rounds; ++round) {
    for (int c = 0; c < kChannels; ++c) {
      UpdateAmplitudes(c, 0, 1 + spec_.lobes, E, model);
      tell();
    }
    for (const Factor factor : {Factor::kD, Factor::kF}) {
      // Tables that serve the same channels: those of the lobes.
      const TableSharing& sharing = spec_.sharing(factor);
      const int groups = sharing.per_channel ? kChannels : 1;
      const int count = spec_.num_tables(factor) / groups;
      if (count == 0) continue;
      for (int k = 0; k < spec_.table_size(factor); ++k) {
        for (int c = 0; c < groups; ++c) {
          std::array<int, kMaxLobes> tables{};
          for (int m = 0; m < count; ++m) tables[m] = spec_.table(factor, m, c);
          UpdateEntries(factor, {tables.data(), static_cast<size_t>(count)}, k, E, model);
          tell();
        }
      }
    }
  }
}

// After what has set the residuals.
void SampleSweep::UpdateG(const OnElement& on_element, FactorModel* model) {
  const ScopedTimer timer(&phases_->linear_algebra);
  for (int t = 0; t < spec_.num_tables(Factor::kG); ++t) {
    for (int k = 0; k < spec_.table_size(Factor::kG); ++k) {
      UpdateNode(t, k, model);
      if (on_element) on_element(*model);
    }
  }
}

}  // namespace trilobe
