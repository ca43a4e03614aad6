#include "fit/choose_form.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "fit/finish/search.h"
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

}  // namespace

void CheckMayChooseForms(const FitOptions& options) {
  if (options.start_model) {
    throw Error(ErrorKind::kConflict, "--model=auto has starts of its own; leave one out")
        .About("start_model");
  }
  if (options.form.nodes == FormOptions::NodeRule::kHeldOut || options.form.d_nodes ||
      options.form.g_nodes) {
    throw Error(ErrorKind::kConflict,
                "--model=auto chooses the nodes; leave out --nodes, --d_nodes and --g_nodes")
        .About("nodes");
  }
}

std::vector<FormSpec> AnisotropicForms(const ModelSpec& by_default, const HemisphereGrid& data,
                                       int max_parameters) {
  std::vector<FormSpec> forms;
  const auto add = [&](const std::string& name, const std::optional<ModelSpec>& spec) {
    if (!spec) return;
    const auto same = [&](const FormSpec& form) { return form.spec == *spec; };
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
    throw Error(ErrorKind::kRange,
                "no anisotropic form keeps to " + std::to_string(max_parameters) + " parameters")
        .About("max_parameters", max_parameters);
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

ChosenForm ChooseForm(const std::vector<FormSpec>& forms, SolvedForm first, const Judge& judge,
                      const std::function<SolvedForm(const FormSpec&)>& solve,
                      const StopCheck& stop) {
  Search search(judge, {.over_first = kAhead});
  const auto judged = [&search](const FormSpec& form, const SolvedForm& solved) {
    FactorModel model = solved.model;
    Canonicalize(solved.data, &model);
    search.Try(form.name, model, form.spec.num_parameters(), solved.summary.final_objective);
  };
  SolvedForm best = std::move(first);
  judged(forms.front(), best);
  search.last().seconds = best.summary.seconds;
  search.TakeLast();
  for (size_t k = 1; k < forms.size() && !stop(); ++k) {
    SolvedForm form = solve(forms[k]);
    if (stop()) break;  // what was stopped half-way says nothing
    judged(forms[k], form);
    if (!search.LastLeads()) continue;
    search.TakeLast();
    best = std::move(form);
  }
  return {.form = std::move(best), .candidates = search.candidates(), .chosen = search.chosen()};
}

}  // namespace trilobe
