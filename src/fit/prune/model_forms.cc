#include "fit/prune/model_forms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fit/finish/stretch_search.h"
#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "solvers/joint/reduction.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// The same values with tables shared by less.
FactorModel SharingLess(const FactorModel& model, const ModelSpec& spec) {
  FactorModel result(spec);
  const Reduction repeat = Reduction::BySharing(spec, model.spec());
  std::ranges::copy(repeat.Expand(model.parameters()), result.parameters().begin());
  return result;
}

std::string NameOf(const ModelForm& base, const char* what) {
  return (base.name.empty() ? "" : base.name + ", ") + what;
}

}  // namespace

std::vector<ModelForm> FormsSharingLess(const ModelForm& base) {
  const ModelSpec& own = base.start.spec();
  std::vector<ModelForm> forms;
  if (own.lobes > 1 && !own.F.per_lobe) {
    ModelSpec spec = own;
    spec.F.per_lobe = true;
    forms.push_back({NameOf(base, "F by lobe"), SharingLess(base.start, spec), base.weighting});
  }
  if (own.lobes > 0 && !own.D.per_channel) {
    ModelSpec spec = own;
    spec.D.per_channel = true;
    forms.push_back({NameOf(base, "D by channel"), SharingLess(base.start, spec), base.weighting});
  }
  return forms;
}

std::optional<ModelForm> FormSharingNeither(const ModelForm& base) {
  std::optional<ModelForm> form;
  for (std::vector<ModelForm> next = FormsSharingLess(base); !next.empty();
       next = FormsSharingLess(*form)) {
    form = std::move(next.front());
  }
  return form;
}

std::optional<ModelForm> FormWithALobeMore(const ModelForm& base) {
  const ModelSpec& own = base.start.spec();
  if (own.lobes == 0 || own.lobes >= kMaxLobes || !own.D.per_lobe) return std::nullopt;
  return ModelForm{NameOf(base, "a lobe more"), SplitLobe(base.start, StrongestLobe(base.start)),
                   base.weighting};
}

FactorModel FitBySolver(const char* solver, const Objective& few, const FactorModel& start,
                        const StopCheck& stop) {
  FactorModel model = start;
  SolverOptions options;
  options.diagnose = false;
  options.stop = stop;
  MakeSolver(solver)->Solve(few, options, &model);
  return model;
}

std::optional<SteppedModel> FitStretchesAnew(const Objective& few, const FactorModel& fitted,
                                             const FactorModel& stretched, const StopCheck& stop) {
  FactorModel start = InitialModels().front().make(few, /*seed=*/1);
  CopyUnobservedParameters(few.coverage(), fitted, &start);
  start = FitBySolver("hybrid", few, start, stop);
  // In the same minimum, to this share of E, the search would end where the first did, with lobes
  // in another order.
  constexpr double kSame = 0.01;
  const Objective of_fit(few, fitted.spec());
  const double E = of_fit.Value(fitted);
  if (std::abs(of_fit.Value(start) - E) < kSame * E) return std::nullopt;
  SteppedModel anew = FitStretches(few, start, stop);
  if (!anew.model.spec().stretches.any()) return std::nullopt;
  if (!(anew.E < Objective(few, stretched.spec()).Value(stretched))) return std::nullopt;
  return anew;
}

bool SharesLess(const Objective& few, int num_measured, const FactorModel& fitted,
                const SteppedModel& stretched, const StopCheck& stop) {
  constexpr int kSteps = 5;
  const double values = kChannels * num_measured / 2.0;  // exchanged ones say the same
  const auto expected = [&](double E, const ModelSpec& spec) {
    const double share = std::min(spec.num_parameters() / values, 0.9);
    return E * (1 + share) / (1 - share);
  };
  return std::ranges::any_of(
      FormsSharingLess({"", fitted, few.weighting()}), [&](const ModelForm& form) {
        const ModelSpec& spec = form.start.spec();
        const double E = JointSteps(Objective(few, spec), form.start, kSteps, stop).E;
        return expected(E, spec) < expected(stretched.E, stretched.model.spec());
      });
}

bool IsSaturated(const BrdfSamples& samples) {
  constexpr double kNearBlack = 0.1, kMuch = 0.1;
  double all = 0, saturated = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const Rgb& rho = samples.rho[j];
    const double mean = Mean(rho);
    const Cosines cosines = samples.CosinesOf(j);
    const double light = samples.SolidAngle(j) * cosines.i * cosines.o * mean;
    all += light;
    if (std::ranges::min(rho) < kNearBlack * mean) saturated += light;
  }
  return saturated > kMuch * all;
}

}  // namespace trilobe
