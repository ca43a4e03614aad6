#include "experiments/limits/compare_forms.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/names.h"
#include "core/system/process.h"
#include "experiments/limits/term_forms.h"
#include "experiments/limits/term_problem.h"
#include "fit/held_out.h"
#include "fit/prune/thinned_objective.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {
namespace {

// Some of the samples if there are many; these need no prior. A prior of colours has no spectra.
Objective SomeOf(const FitProblem& problem, bool bands, int num_parameters) {
  constexpr int kMost = 100'000;
  if (problem.solved().num_samples() <= kMost) return bands ? problem.data : problem.solved();
  return ThinnedObjective(problem.data, num_parameters, kFewSamples);
}

double Share(double E, double of) { return of > 0 ? E / of : 0; }

}  // namespace

std::vector<FormFit> CompareForms(const FitProblem& problem, const TermModel& start,
                                  const CompareFormsOptions& options) {
  std::vector<const TermForm*> forms = {&TermForms().front()};
  for (const std::string& name : options.forms) {
    const TermForm& form = FindNamed("form", name, TermForms());
    if (std::ranges::find(forms, &form) == forms.end()) forms.push_back(&form);
  }
  std::vector<TermModel> starts;
  for (const TermForm* form : forms) {
    try {
      starts.push_back(form->from(start));
    } catch (const Error& error) {
      throw error.WithMessage("form " + form->name + ": " + error.what() +
                              "; leave it out of --forms");
    }
  }
  const Objective all = SomeOf(problem, options.bands, start.num_parameters());
  const HeldOutPart held_out(all.data().samples(), options.seed, all.num_threads());
  const Objective kept = held_out.RemoveFrom(all);
  const Objective held(held_out.samples(), all.spec(), all.weighting(), all.num_threads());
  std::vector<FormFit> fits;
  for (size_t k = 0; k < forms.size() && !options.stop(); ++k) {
    const Stopwatch stopwatch;
    const TermSpec spec = starts[k].spec();
    const auto problem_of = [&](const Objective& part) {
      return TermProblem(part, spec, options.bands);
    };
    const auto share_in = [](const TermProblem& judged, const TermModel& model) {
      return Share(judged.Value(model), judged.MeasuredEnergy());
    };
    constexpr double kSmall = 3e-5;  // forms differ by more
    const TermFitOptions steps{.tolerance = kSmall, .stop = options.stop};
    const TermFit part = FitTerms(problem_of(kept), starts[k], steps);
    const TermProblem of_all = problem_of(all);
    const TermFit whole = FitTerms(of_all, part.model, steps);
    if (options.stop()) break;
    FormFit fit{.form = forms[k]->name,
                .model = whole.model,
                .objective = all.has_prior() ? share_in(problem_of(all.data()), whole.model)
                                             : share_in(of_all, whole.model),
                .held_out = share_in(problem_of(held), part.model),
                .steps = static_cast<int>(part.trace.size() + whole.trace.size()) - 2,
                .converged = part.converged && whole.converged,
                .seconds = stopwatch.Seconds()};
    if (options.on_form) options.on_form(fit);
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace trilobe
