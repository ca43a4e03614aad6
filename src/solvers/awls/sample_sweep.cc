#include "trilobe/solvers/awls/sample_sweep.h"

#include <array>
#include <cstddef>
#include <span>

#include "trilobe/math/nonnegative_least_squares.h"

namespace trilobe {

static_assert(1 + kMaxLobes <= kMaxNonnegativeUnknowns);

SampleSweep::SampleSweep(const FoldedSamples& samples, const ModelSpec& spec, int num_threads,
                         PhaseSeconds* phases)
    : Sweep(/*rounds=*/1),  // each costs as much as the first
      spec_(spec),
      phases_(phases),
      readings_(samples, spec, num_threads),
      amplitudes_(readings_),
      shadowing_(&readings_) {
  const ScopedTimer timer(&phases->preparing);
  for (int t = 0; t < spec.num_tables(Factor::kD);) {
    int end = t + 1;
    while (end < spec.num_tables(Factor::kD) &&
           spec.StretchOfTable(end) == spec.StretchOfTable(t)) {
      ++end;
    }
    tables_.emplace_back(readings_, Kind::kD, t, end);
    t = end;
  }
  if (spec.lobes > 0) tables_.emplace_back(readings_, Kind::kF, 0, spec.num_tables(Factor::kF));
}

void SampleSweep::UpdateFrom(ReadingSums* sums, FactorModel* model,
                             const std::function<void()>& update) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    sums->Accumulate(*model);
  }
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    update();
  }
  if (sums->kind() == Kind::kAmplitudes) return;
  const ScopedTimer timer(&phases_->evaluating);
  readings_.Read(*model, FactorOf(sums->kind()), sums->first(), sums->last());
}

void SampleSweep::operator()(const OnElement& on_element, FactorModel* model) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    readings_.Read(*model);
  }
  const auto update_all = [&](ReadingSums* sums) {
    UpdateFrom(sums, model, [&] {
      for (int t = sums->first(); t < sums->last(); ++t) {
        for (int entry = 0; entry < sums->entries(); ++entry) {
          sums->Update(entry, {&t, 1}, 0, model);
          if (on_element) on_element(*model);
        }
      }
    });
  };
  update_all(&amplitudes_);
  for (ReadingSums& sums : tables_) update_all(&sums);
  UpdateG(on_element, model);
}

void SampleSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block,
                               FactorModel* model) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    readings_.Read(*model);
  }
  std::array<int, kMaxNonnegativeUnknowns> block{};
  // Of tables first, first + stride ...
  const auto update = [&](ReadingSums* sums, int entry, int first, int stride) {
    size_t size = 0;
    for (int t = first; t < sums->last(); t += stride) block[size++] = t;
    sums->Update(entry, {block.data(), size}, E, model);
    if (on_block) on_block(*model);
  };
  for (int round = 0; round < rounds; ++round) {
    UpdateFrom(&amplitudes_, model, [&] {
      for (int c = 0; c < kChannels; ++c) update(&amplitudes_, c, 0, 1);
    });
    for (ReadingSums& sums : tables_) {
      // Tables that serve the same channels: those of the lobes.
      const int groups = spec_.sharing(FactorOf(sums.kind())).per_channel ? kChannels : 1;
      UpdateFrom(&sums, model, [&] {
        for (int entry = 0; entry < sums.entries(); ++entry) {
          for (int c = 0; c < groups; ++c) update(&sums, entry, sums.first() + c, groups);
        }
      });
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
