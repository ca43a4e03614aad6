#include "fit/choose_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/system/process.h"
#include "model/objective/canonical_form.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Nodes of D, theta at even steps of its root, and of G; from fine to coarse.
struct Rung {
  int d_rings, d_phis, g_rings, g_phis;
};
constexpr Rung kRungs[] = {{24, 72, 10, 48}, {20, 60, 8, 40}, {16, 48, 6, 32}, {12, 36, 6, 24},
                           {12, 24, 6, 20},  {8, 18, 6, 16},  {8, 12, 6, 12},  {8, 8, 6, 8},
                           {6, 6, 4, 4},     {4, 4, 4, 4}};

// `form` on the finest of these nodes with which it keeps to the budget.
std::optional<ModelSpec> OnFinestNodes(const ModelSpec& form, const HemisphereGrid& data,
                                       int max_parameters) {
  for (const Rung& rung : kRungs) {
    ModelSpec spec = form;
    spec.d_axis =
        Axis::EvenPolar(rung.d_rings, Axis::Steps::kOfRoot, std::clamp(data.phis, 4, rung.d_phis));
    spec.g_axis = Axis::EvenPolar(std::min(rung.g_rings, std::max(data.thetas, 6)),
                                  Axis::Steps::kOfTheta, std::clamp(data.phis / 2, 4, rung.g_phis));
    if (form.g_axis.reaches_horizon()) spec.g_axis = spec.g_axis.ToHorizon();
    if (spec.num_parameters() <= max_parameters) return spec;
  }
  return std::nullopt;
}

ModelCandidate Judged(const std::string& name, const SolvedForm& form,
                      const std::function<double(const FactorModel&)>& judge, double seconds) {
  FactorModel model = form.model;
  Canonicalize(form.data, &model);
  const double score = judge(model);
  return {.name = name,
          .num_parameters = form.model.spec().num_parameters(),
          .E = form.summary.final_objective,
          // NaN has no order: it ranks below all others.
          .score = std::isnan(score) ? -std::numeric_limits<double>::infinity() : score,
          .seconds = seconds};
}

}  // namespace

std::vector<AnisotropicForm> AnisotropicForms(const ModelSpec& by_default,
                                              const HemisphereGrid& data, int max_parameters) {
  std::vector<AnisotropicForm> forms;
  const auto add = [&](const std::string& name, const std::optional<ModelSpec>& spec) {
    if (!spec) return;
    const auto same = [&](const AnisotropicForm& form) { return form.spec == *spec; };
    if (std::ranges::none_of(forms, same)) forms.push_back({name, *spec});
  };
  const std::optional<ModelSpec> finest = OnFinestNodes(by_default, data, max_parameters);
  if (by_default.num_parameters() <= max_parameters) {
    add("as fitted", by_default);
    if (by_default.lobes > 0) add("finer nodes", finest);
  } else {
    add("as fitted", finest);
  }
  if (forms.empty()) {
    throw Error("no anisotropic form keeps to " + std::to_string(max_parameters) + " parameters");
  }
  if (by_default.lobes > 0 && by_default.lobes < kMaxLobes) {
    ModelSpec more = by_default;
    ++more.lobes;
    add(std::to_string(more.lobes) + " lobes", OnFinestNodes(more, data, max_parameters));
  }
  if (by_default.lobes > 0) {
    ModelSpec by_channel = by_default;
    by_channel.D.per_channel = true;
    add("D by channel", OnFinestNodes(by_channel, data, max_parameters));
  }
  return forms;
}

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
