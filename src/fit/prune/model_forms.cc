#include "fit/prune/model_forms.h"

#include <algorithm>
#include <utility>

#include "model/lobes/lobes.h"
#include "solvers/joint/reduction.h"

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
