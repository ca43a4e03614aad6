#ifndef TRILOBE_FIT_PRUNE_MODEL_FORMS_H_
#define TRILOBE_FIT_PRUNE_MODEL_FORMS_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
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

// Whether much of what a material reflects has a channel near 0, where a picture shows errors that
// are small beside the mean of the channels, by which samples are weighed.
bool IsSaturated(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_MODEL_FORMS_H_
