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

// A form of a model: what it is called, where its fit begins, and what that minimises.
struct ModelForm {
  std::string name;
  FactorModel start;
  Weighting weighting;
};

// Those with the same values that share less than a form: F by lobe, D by channel.
std::vector<ModelForm> FormsSharingLess(const ModelForm& base);

// Both at once, or the one that is not so yet; nothing where both are.
std::optional<ModelForm> FormSharingNeither(const ModelForm& base);

// A lobe more, the strongest one split; nothing where none can be.
std::optional<ModelForm> FormWithALobeMore(const ModelForm& base);

// What a solver makes of few samples.
FactorModel FitBySolver(const char* solver, const Objective& few, const FactorModel& start,
                        const StopCheck& stop);

// Where highlights widen towards grazing a fit without stretches may let F and G cancel over many
// decades (docs/stored-model.md), from which no stretch leads back; so a second way begins at the
// default start. Nothing if it ends no lower on `few` than `stretched`, the way from the fit.
std::optional<SteppedModel> FitStretchesAnew(const Objective& few, const FactorModel& fitted,
                                             const FactorModel& stretched, const StopCheck& stop);

// Whether the data rather have a form that shares less: a stretch may look like one. What more
// parameters fit of few samples by chance is taken off; those of the prior tell nothing.
bool SharesLess(const Objective& few, int num_measured, const FactorModel& fitted,
                const SteppedModel& stretched, const StopCheck& stop);

// Whether much of what a material reflects has a channel near 0, where a picture shows errors that
// are small beside the mean of the channels, by which samples are weighed.
bool IsSaturated(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_MODEL_FORMS_H_
