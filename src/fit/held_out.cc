#include "fit/held_out.h"

#include <algorithm>
#include <cmath>

#include "model/appearance/seen_samples.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/lobes/reconstruct.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Blocks of theta_d, and of the root of theta_h, as bins are.
constexpr int kBlocks = 45;
constexpr double kShare = 0.2;  // of the blocks

bool IsHeldOut(const HalfDiffAngles& at, uint64_t seed) {
  const auto block = [](double share) {
    return std::clamp(static_cast<int>(share * kBlocks), 0, kBlocks - 1);
  };
  const int number =
      kBlocks * block(std::sqrt(at.theta_h / (kPi / 2))) + block(at.theta_d / (kPi / 2));
  return UniformAt(seed, number) < kShare;
}

}  // namespace

HeldOutPart::HeldOutPart(const BrdfSamples& measured, uint64_t seed, int num_threads)
    : num_measured_(measured.size()), num_threads_(num_threads) {
  std::vector<int> held;
  for (int j = 0; j < num_measured_; ++j) {
    (IsHeldOut(measured.Angles(j), seed) ? held : kept_).push_back(j);
  }
  if (held.empty() || kept_.empty()) {
    throw Error(measured.source +
                ": too few directions to hold out some of them; leave --model=auto out");
  }
  held_ = Selected(measured, held);
}

Objective HeldOutPart::Without(const Objective& objective) const {
  const auto part = [&](const BrdfSamples& samples) {
    std::vector<int> numbers = kept_;
    for (int j = num_measured_; j < samples.size(); ++j) numbers.push_back(j);
    return Selected(samples, numbers);
  };
  const auto of_part = [&](const Objective& whole) -> Objective {
    return {part(whole.samples()), whole.spec(), whole.weighting(), whole.num_threads()};
  };
  if (!objective.has_prior()) return of_part(objective);
  return {of_part(objective.data()), part(objective.samples())};
}

double HeldOutPart::Score(const FactorModel& model) const {
  return CompareSamples(held_, EvaluateSamples(model, held_, num_threads_)).psnr_db;
}

FactorModel FitToPart(const Objective& part, FactorModel fitted, const StopCheck& stop) {
  SolverOptions steps;
  steps.max_iterations = 20;
  steps.relative_decrease_tolerance = 1e-3;
  steps.diagnose = false;
  steps.stop = stop;
  MakeSolver("varpro")->Solve(part, steps, &fitted);
  return fitted;
}

int LeastToHoldOut(int max_parameters) {
  constexpr int kSamplesPerParameter = 10;
  return kSamplesPerParameter * max_parameters;
}

}  // namespace trilobe
