#include "fit/choose_held_out.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fit/choose_form.h"
#include "fit/finish/data_edge.h"
#include "fit/prune/unmeasured_prior.h"
#include "model/objective/canonical_form.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/fit/prior/reach.h"

namespace trilobe {
namespace {

// Where there are no samples nothing is known but that a material is hardly ever brighter than
// where there are. ChooseModel lets a form lose 3 dB there, which is to be four times the reach.
double ScoreBeyond(const Objective& part, const FactorModel& model) {
  constexpr double kOvershoot = 4;  // as in CorrectOvershoot
  const Reach reach = ReachOf(part.data().samples(), model, part.num_threads());
  if (!(reach.between < kOvershoot)) return -std::numeric_limits<double>::infinity();
  return -5 * std::log10(std::max(reach.beyond, 1.0));
}

// All samples move what is stored of a form that was fitted to a part of them.
FactorModel FittedToAll(const Objective& solved, const ChosenModel& chosen, const StopCheck& stop) {
  constexpr int kSteps = 10;
  constexpr double kSmall = 1e-3;
  const ModelSpec& spec = chosen.model.spec();
  const Objective all =
      chosen.weighting.name == solved.weighting().name
          ? Objective(solved, spec)
          : Objective(solved.samples(), spec, chosen.weighting, solved.num_threads());
  const Reduction stored(spec, chosen.layout);
  const Objective held = UnmeasuredPrior(solved, chosen.model).With(all);
  return JointSteps(held, chosen.model, kSteps, stop, &stored, kSmall).model;
}

}  // namespace

ChosenModel ChooseModel(const Objective& solved, const HeldOutPart& held_out,
                        const FactorModel& fitted, int max_parameters, const StopCheck& stop) {
  const Objective part = held_out.Without(solved);
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
  const std::vector<ModelCandidate>& tried = chosen.candidates;
  if (may_stay && !(tried[chosen.chosen].score > tried.front().score + kAhead)) {
    chosen.chosen = 0;
    chosen.model = fitted;
    chosen.layout = TableLayout::Full(fitted.spec());
    chosen.weighting = solved.weighting();
  } else {
    chosen.model = FittedToAll(solved, chosen, stop);
  }
  return chosen;
}

}  // namespace trilobe
