#include "fit/choose_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/system/stopwatch.h"
#include "model/objective/canonical_form.h"

namespace trilobe {
namespace {

ModelCandidate Judged(const std::string& name, const SolvedForm& form,
                      const std::function<double(const FactorModel&)>& judge, double seconds) {
  FactorModel model = form.model;
  Canonicalize(form.data, &model);
  const double score = judge(model);
  return {.name = name,
          .num_parameters = form.model.spec().num_parameters(),
          .E = form.summary.final_objective,
          // Below all others, with which NaN has no order.
          .score = std::isnan(score) ? -std::numeric_limits<double>::infinity() : score,
          .seconds = seconds};
}

}  // namespace

ChosenForm ChooseForm(const std::vector<AnisotropicForm>& forms, SolvedForm first,
                      const std::function<double(const FactorModel&)>& judge,
                      const std::function<SolvedForm(const AnisotropicForm&)>& solve,
                      const StopCheck& stop) {
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
