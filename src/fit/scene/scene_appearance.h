#ifndef TRILOBE_FIT_SCENE_SCENE_APPEARANCE_H_
#define TRILOBE_FIT_SCENE_SCENE_APPEARANCE_H_

#include <optional>

#include "fit/scene/scene_file.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// The samples in grey: all three channels are the luminance.
BrdfSamples LuminanceOf(BrdfSamples samples);

// The model in grey, whose values are the luminance of the model's. F becomes one table a lobe,
// sum_C y_C s_C F_C, so D and G must be shared by the channels; throws Error if they are not.
FactorModel LuminanceOf(const FactorModel& model);

// How a model looks beside its measurement, on the sphere of docs/appearance.md, as far as a scene
// sees that: in its channels and, of a table, from its directions alone.
class SceneAppearance {
 public:
  // Throws Error where scattered samples stand on no grid, as these make no picture.
  SceneAppearance(const SceneMaterial& material, Measurement measured,
                  const AppearanceOptions& options);
  SceneAppearance(const SceneAppearance&) = delete;
  SceneAppearance& operator=(const SceneAppearance&) = delete;

  // Throws Error where no pixel shows a direction that the scene uses: what is left out there would
  // not be seen.
  void CheckShowsSomething() const;

  // As `trilobe fit` tells it.
  SphereError Compare(const FactorModel& model) const;
  // On a quarter of the pixels, in a quarter of the time.
  SphereError CompareQuickly(const FactorModel& model) const;

 private:
  const Measurement seen_;
  const PictureData pictured_;
  const AppearanceOptions options_;
  std::optional<SphereJudge> judge_;  // of a table
};

// PruneOptions::error of a budget of appearance: mean Delta E, or 10^(-PSNR/20).
double ErrorIn(SceneBudget::Unit unit, const SphereError& error);
// The same of the budget's amount.
double MaxError(const SceneBudget& budget);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_APPEARANCE_H_
