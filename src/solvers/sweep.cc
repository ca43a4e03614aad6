#include "solvers/sweep.h"

#include <glog/logging.h>

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "core/algebra/nonnegative_least_squares.h"

namespace trilobe {

void Sweep::SweepInBlocks(const IterationRecord& last, const OnElement& on_block,
                          FactorModel* model) {
  // Other numbers of sweeps are compared in docs/decisions/sweeps.md.
  constexpr int kElementSweeps = 3;
  if (last.iteration < kElementSweeps) {
    (*this)(on_block, model);
    return;
  }
  UpdateBlocks(last.minimised(), rounds_, on_block, model);
  UpdateG(on_block, model);
}

GridSweep::GridSweep(const Objective& objective, PhaseSeconds* phases)
    : Sweep(/*rounds=*/5),  // after the first, they cost next to nothing
      objective_(objective),
      phases_(phases),
      cells_(*CHECK_NOTNULL(objective.folded()), objective.spec()) {}

void GridSweep::operator()(const OnElement& on_element, FactorModel* model) {
  AccumulateCells(*model);
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    cells_.UpdateAll(on_element, model);
  }
  UpdateG(on_element, model);
}

void GridSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) {
  AccumulateCells(*model);
  const ScopedTimer timer(&phases_->linear_algebra);
  for (int k = 0; k < rounds; ++k) {
    cells_.UpdateBlocks(E, objective_.num_threads(), on_block, model);
  }
}

void GridSweep::AccumulateCells(const FactorModel& model) {
  const ScopedTimer timer(&phases_->evaluating);
  cells_.Accumulate(model, objective_.num_threads());
}

void GridSweep::UpdateG(const OnElement& on_element, FactorModel* model) {
  if (!shadowing_) {
    const ScopedTimer timer(&phases_->preparing);
    shadowing_.emplace(objective_.spline_cells(), objective_.spec());
  }
  for (int t = 0; t < model->spec().num_tables(Factor::kG); ++t) {
    {
      const ScopedTimer timer(&phases_->evaluating);
      shadowing_->Accumulate(*model, t, objective_.num_threads());
    }
    const ScopedTimer timer(&phases_->linear_algebra);
    shadowing_->UpdateTable(t, on_element, model);
  }
}

static_assert(1 + kMaxLobes <= kMaxNonnegativeUnknowns);

SampleSweep::SampleSweep(std::shared_ptr<const FoldedSamples> samples, const ModelSpec& spec,
                         int num_threads, PhaseSeconds* phases)
    : Sweep(/*rounds=*/1),  // each costs as much as the first
      phases_(phases),
      samples_(std::move(samples)),
      lookups_(*samples_, spec, num_threads),
      shadowing_(lookups_) {
  const ScopedTimer timer(&phases->preparing);
  sums_.emplace_back(lookups_, ParameterKind::kAmplitudes, 0, 1 + spec.lobes);
  for (int t = 0; t < spec.num_tables(Factor::kD);) {
    const int end = lookups_.EndOfStretch(t);
    sums_.emplace_back(lookups_, ParameterKind::kD, t, end);
    t = end;
  }
  if (spec.lobes > 0) {
    sums_.emplace_back(lookups_, ParameterKind::kF, 0, spec.num_tables(Factor::kF));
  }
}

void SampleSweep::UpdateFrom(BlockEquations* sums, FactorModel* model,
                             const std::function<void()>& update) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    sums->Accumulate(*model);
  }
  {
    const ScopedTimer timer(&phases_->linear_algebra);
    update();
  }
  if (sums->kind() == ParameterKind::kAmplitudes) return;
  const ScopedTimer timer(&phases_->evaluating);
  lookups_.SetTables(*model);
}

void SampleSweep::operator()(const OnElement& on_element, FactorModel* model) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    lookups_.SetTables(*model);
  }
  for (BlockEquations& sums : sums_) {
    UpdateFrom(&sums, model, [&] {
      for (int t = sums.first(); t < sums.last(); ++t) {
        for (int entry = 0; entry < sums.entries(); ++entry) {
          sums.Update(entry, {&t, 1}, 0, model);
          if (on_element) on_element(*model);
        }
      }
    });
  }
  UpdateG(on_element, model);
}

void SampleSweep::UpdateBlocks(double E, int rounds, const OnElement& on_block,
                               FactorModel* model) {
  {
    const ScopedTimer timer(&phases_->evaluating);
    lookups_.SetTables(*model);
  }
  std::array<int, kMaxNonnegativeUnknowns> block{};
  for (int round = 0; round < rounds; ++round) {
    for (BlockEquations& sums : sums_) {
      // A block is an entry of those tables that serve the same channels.
      const bool per_channel = sums.kind() != ParameterKind::kAmplitudes &&
                               lookups_.spec().sharing(FactorOf(sums.kind())).per_channel;
      const int groups = per_channel ? kChannels : 1;
      UpdateFrom(&sums, model, [&] {
        for (int entry = 0; entry < sums.entries(); ++entry) {
          for (int group = 0; group < groups; ++group) {
            size_t size = 0;
            for (int t = sums.first() + group; t < sums.last(); t += groups) block[size++] = t;
            sums.Update(entry, {block.data(), size}, E, model);
            if (on_block) on_block(*model);
          }
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
  for (int t = 0; t < lookups_.spec().num_tables(Factor::kG); ++t) {
    shadowing_.UpdateTable(t, on_element, model);
  }
}

std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases) {
  if (objective.folded() != nullptr) return std::make_unique<GridSweep>(objective, phases);
  return std::make_unique<SampleSweep>(objective.folded_samples(), objective.spec(),
                                       objective.num_threads(), phases);
}

}  // namespace trilobe
