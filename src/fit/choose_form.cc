#include "fit/choose_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "appearance/node_judge.h"
#include "objective/canonical_form.h"
#include "system/stopwatch.h"
#include "trilobe/appearance/material.h"

namespace trilobe {
namespace {

// What another form has to be ahead by [dB]: the judge knows the material no better than that
// (docs/decisions/forms-of-anisotropic.md).
constexpr double kAhead = 0.5;

Material MaterialOf(const SolvedForm& form) {
  FactorModel model = form.model;
  Canonicalize(form.data, &model);
  return MaterialOf(model);
}

ModelCandidate Judged(const std::string& name, const SolvedForm& form, const NodeJudge& judge,
                      double seconds) {
  const double score = judge(MaterialOf(form).spherical);
  return {.name = name,
          .num_parameters = form.model.spec().num_parameters(),
          .E = form.summary.final_objective,
          // Below all others, with which NaN has no order.
          .score = std::isnan(score) ? -std::numeric_limits<double>::infinity() : score,
          .seconds = seconds};
}

}  // namespace

ChosenForm ChooseForm(const std::vector<AnisotropicForm>& forms, SolvedForm first,
                      const NodeBrdf& measured, const AppearanceOptions& appearance,
                      const std::function<SolvedForm(const AnisotropicForm&)>& solve,
                      const StopCheck& stop) {
  AppearanceOptions small = appearance;  // many are rendered
  small.size = std::max(small.size / 3, 8);
  const NodeJudge judge(measured, MaterialOf(first).spherical, small);
  const double seconds = first.summary.seconds;
  ChosenForm best{.form = std::move(first), .candidates = {}};
  best.candidates.push_back(Judged(forms.front().name, best.form, judge, seconds));
  for (size_t k = 1; k < forms.size() && !stop(); ++k) {
    const Stopwatch since;
    SolvedForm form = solve(forms[k]);
    if (stop()) break;  // what was stopped half-way says nothing
    best.candidates.push_back(Judged(forms[k].name, form, judge, since.Seconds()));
    const double score = best.candidates.back().score;
    if (!(score > best.candidates[best.chosen].score &&
          score > best.candidates.front().score + kAhead)) {
      continue;
    }
    best.chosen = static_cast<int>(k);
    best.form = std::move(form);
  }
  return best;
}

}  // namespace trilobe
