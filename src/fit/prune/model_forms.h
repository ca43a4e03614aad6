#ifndef TRILOBE_FIT_PRUNE_MODEL_FORMS_H_
#define TRILOBE_FIT_PRUNE_MODEL_FORMS_H_

#include <optional>
#include <string>
#include <vector>

#include "solvers/joint/joint_step.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe {

// A form of a model: its name, the start of its fit, and the weighting that the fit minimises.
struct ModelForm {
  std::string name;
  FactorModel start;
  Weighting weighting;
};

// Forms that share less and start from the same values: F by lobe, D by channel.
std::vector<ModelForm> FormsSharingLess(const ModelForm& base);

// The form with F by lobe and D by channel. Nothing if the base has both.
std::optional<ModelForm> FormSharingNeither(const ModelForm& base);

// The form with the strongest lobe split. Nothing if none can be split.
std::optional<ModelForm> FormWithALobeMore(const ModelForm& base);

// Fits few samples by this solver.
FactorModel FitBySolver(const char* solver, const Objective& few, const FactorModel& start,
                        const StopCheck& stop);

// Fits stretches from the default start. If highlights widen towards grazing angles, F and G of a
// fit without stretches may cancel over many decades (docs/file-formats.md), and stretches fitted
// from it do not recover. Nothing where that start leads to the E of the fit, so that the search
// would end where the first did, or unless E on `few` is lower than that of `stretched`, the result
// from the fit.
std::optional<SteppedModel> FitStretchesAnew(const Objective& few, const FactorModel& fitted,
                                             const FactorModel& stretched, const StopCheck& stop);

// Whether a form that shares less fits better than `stretched`, since a stretch may imitate it. The
// comparison corrects for overfitting of few samples and ignores those of the prior.
bool SharesLess(const Objective& few, int num_measured, const FactorModel& fitted,
                const SteppedModel& stretched, const StopCheck& stop);

// Whether much of the reflected light has a channel near 0. Pictures then show errors that are
// small relative to the mean of the channels, which sets the weights of samples.
bool IsSaturated(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_MODEL_FORMS_H_
