#include "trilobe/solvers/awls/sample_sweep.h"

#include <array>
#include <cstddef>

#include "trilobe/math/nonnegative_least_squares.h"

namespace trilobe {

static_assert(1 + kMaxLobes <= kMaxNonnegativeUnknowns);

SampleSweep::SampleSweep(const FoldedSamples& samples, const ModelSpec& spec, int num_threads,
                         PhaseSeconds* phases)
    : Sweep(/*rounds=*/1),  // each costs as much as the first
      spec_(spec),
      phases_(phases),
      shadowing_(samples, spec, num_threads) {
  const ScopedTimer timer(&phases->preparing);
  for (const Kind kind : {Kind::kAmplitudes, Kind::kD, Kind::kF}) {
    equations_.emplace_back(samples, spec, num_threads, kind);
  }
}

void SampleSweep::Accumulate(Kind kind, const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  equations_[static_cast<int>(kind)].Evaluate(model, Hessian::kGaussNewton, &at_);
}

void SampleSweep::Update(std::span<const int> places, int first, double E, FactorModel* model) {
  const size_t size = places.size(), n = at_.gradient.size();
  std::array<double, kMaxNonnegativeUnknowns> g{}, steps{};
  std::array<double, kMaxNonnegativeUnknowns * kMaxNonnegativeUnknowns> H{};
  std::array<double*, kMaxNonnegativeUnknowns> elements{};
  for (size_t k = 0; k < size; ++k) {
    elements[k] = &model->parameters()[first + places[k]];
    g[k] = -at_.gradient[places[k]];
    for (size_t l = 0; l < size; ++l) H[k * size + l] = at_.H[places[k] * n + places[l]];
  }
  if (!MoveToMinimum({H.data(), size * size}, {g.data(), size}, E, {elements.data(), size},
                     steps.data())) {
    return;
  }
  for (size_t k = 0; k < size; ++k) {
    if (steps[k] == 0) continue;
    const double* const row = &at_.H[places[k] * n];
    for (size_t l = 0; l < n; ++l) at_.gradient[l] += steps[k] * row[l];
  }
}

void SampleSweep::operator()(const OnElement& on_element, FactorModel* model) {
  const auto update = [&](int place, int first) {
    const ScopedTimer timer(&phases_->linear_algebra);
    Update({&place, 1}, first, 0, model);
    if (on_element) on_element(*model);
  };
  Accumulate(Kind::kAmplitudes, *model);
  for (int k = 0; k < kChannels * (1 + spec_.lobes); ++k) update(k, 0);
  for (const Factor factor : {Factor::kD, Factor::kF}) {
    Accumulate(KindOf(factor), *model);
    const int size = spec_.num_tables(factor) * spec_.table_size(factor);
    for (int k = 0; k < size; ++k) update(k, model->TableOffset(factor, 0));
  }
  UpdateG(on_element, model);
}

void SampleSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block,
                               FactorModel* model) {
  const auto update = [&](std::span<const int> places, int first) {
    const ScopedTimer timer(&phases_->linear_algebra);
    Update(places, first, E, model);
    if (on_block) on_block(*model);
  };
  std::array<int, kMaxNonnegativeUnknowns> places{};
  for (int round = 0; round < rounds; ++round) {
    Accumulate(Kind::kAmplitudes, *model);
    for (int c = 0; c < kChannels; ++c) {
      for (int a = 0; a <= spec_.lobes; ++a) places[a] = kChannels * a + c;
      update({places.data(), static_cast<size_t>(1 + spec_.lobes)}, 0);
    }
    for (const Factor factor : {Factor::kD, Factor::kF}) {
      // Tables that serve the same channels: those of the lobes.
      const int groups = spec_.sharing(factor).per_channel ? kChannels : 1;
      const int count = spec_.num_tables(factor) / groups;
      if (count == 0) continue;
      Accumulate(KindOf(factor), *model);
      const int table_size = spec_.table_size(factor);
      for (int k = 0; k < table_size; ++k) {
        for (int c = 0; c < groups; ++c) {
          for (int m = 0; m < count; ++m) places[m] = spec_.table(factor, m, c) * table_size + k;
          update({places.data(), static_cast<size_t>(count)}, model->TableOffset(factor, 0));
        }
      }
    }
  }
}

void SampleSweep::UpdateG(const OnElement& on_element, FactorModel* model) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    shadowing_.Read(*model);
  }
  const ScopedTimer timer(&phases_->linear_algebra);
  for (int t = 0; t < spec_.num_tables(Factor::kG); ++t) {
    shadowing_.UpdateTable(t, on_element, model);
  }
}

}  // namespace trilobe
