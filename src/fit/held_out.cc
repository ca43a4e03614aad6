#include "fit/held_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/choose_form.h"
#include "fit/finish/data_edge.h"
#include "fit/prune/unmeasured_prior.h"
#include "model/measurement/counter_random.h"
#include "model/objective/canonical_form.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

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

// Without samples, nothing is known but that a material is hardly ever brighter than where there
// are some. ChooseModel lets a form lose 3 dB there, which is to be four times the reach.
double ScoreBeyond(const Objective& part, const FactorModel& model) {
  constexpr double kOvershoot = 4;  // as in CorrectOvershoot
  const Reach reach = ReachOf(part.data().samples(), model, part.num_threads());
  if (!(reach.between < kOvershoot)) return -std::numeric_limits<double>::infinity();
  return -5 * std::log10(std::max(reach.beyond, 1.0));
}

// Refits the stored parameters of a form that was fitted to a part of the samples, to all of them.
FactorModel FitToAll(const Objective& solved, const ChosenModel& chosen, const StopCheck& stop) {
  constexpr int kSteps = 10;
  constexpr double kSmall = 1e-3;
  const ModelSpec& spec = chosen.model.spec();
  const Objective all =
      chosen.weighting.name == solved.weighting().name
          ? Objective(solved, spec)
          : Objective(solved.samples(), spec, chosen.weighting, solved.num_threads());
  const Reduction stored(spec, chosen.layout);
  const Objective held = UnmeasuredPrior(solved, chosen.model).JoinTo(all);
  return JointSteps(held, chosen.model, kSteps, stop, &stored, kSmall).model;
}

}  // namespace

bool HeldOutPart::CanDivide(const BrdfSamples& measured, uint64_t seed) {
  int held = 0;
  for (int j = 0; j < measured.size(); ++j) held += IsHeldOut(measured.Angles(j), seed) ? 1 : 0;
  return held > 0 && held < measured.size();
}

HeldOutPart::HeldOutPart(const BrdfSamples& measured, uint64_t seed, int num_threads)
    : num_measured_(measured.size()), num_threads_(num_threads) {
  std::vector<int> held;
  for (int j = 0; j < num_measured_; ++j) {
    (IsHeldOut(measured.Angles(j), seed) ? held : kept_).push_back(j);
  }
  if (held.empty() || kept_.empty()) {
    throw ErrorIn(
        ErrorKind::kData, measured.source,
        "too few directions to hold out some of them, as --model=auto and `trilobe forms` do")
        .About("directions", measured.size());
  }
  held_ = Selected(measured, held);
}

BrdfSamples HeldOutPart::RemoveFrom(const BrdfSamples& samples) const {
  std::vector<int> numbers = kept_;
  for (int j = num_measured_; j < samples.size(); ++j) numbers.push_back(j);
  return Selected(samples, numbers);
}

Objective HeldOutPart::RemoveFrom(const Objective& objective) const {
  const auto of_part = [&](const Objective& whole) -> Objective {
    return {RemoveFrom(whole.samples()), whole.spec(), whole.weighting(), whole.num_threads()};
  };
  if (!objective.has_prior()) return of_part(objective);
  return {of_part(objective.data()), RemoveFrom(objective.samples())};
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

ChosenModel ChooseModel(const Objective& solved, const HeldOutPart& held_out,
                        const FactorModel& fitted, int max_parameters, const StopCheck& stop) {
  const Objective part = held_out.RemoveFrom(solved);
  FactorModel first = FitToPart(part, fitted, stop);
  TieEntriesAtDataEdge(part, &first, stop);
  Canonicalize(part, &first);
  const ModelChoiceOptions choice{
      .max_parameters = max_parameters,
      .judge = [&](const FactorModel& model) { return held_out.Score(model); },
      .judge_beyond = [&](const FactorModel& model) { return ScoreBeyond(part, model); },
      .stop = stop};
  ChosenModel chosen = ChooseModel(part, first, choice);
  const bool may_stay = fitted.spec().num_parameters() <= max_parameters;
  const std::vector<Candidate>& tried = chosen.candidates;
  if (may_stay && !(tried[chosen.chosen].score > tried.front().score + kAhead)) {
    chosen.chosen = 0;
    chosen.model = fitted;
    chosen.layout = TableLayout::Full(fitted.spec());
    chosen.weighting = solved.weighting();
  } else {
    chosen.model = FitToAll(solved, chosen, stop);
  }
  return chosen;
}

}  // namespace trilobe
