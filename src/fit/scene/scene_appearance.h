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

// Visible difference of a model and its measurement on the sphere of docs/appearance.md, limited to
// the channels and the directions that a scene uses: where those are a range from 0, as `trilobe
// score --max_angle` tells it.
class SceneAppearance {
 public:
  // Throws Error for scattered samples on no grid, which cannot be rendered.
  SceneAppearance(const SceneMaterial& material, Measurement measured,
                  const AppearanceOptions& options);
  SceneAppearance(const SceneAppearance&) = delete;
  SceneAppearance& operator=(const SceneAppearance&) = delete;

  // Throws Error if no pixel shows a direction that the scene uses.
  void CheckShowsSomething() const;

  // The error as `trilobe fit` reports it.
  SphereError Compare(const FactorModel& model) const;
  // The same on a quarter of the pixels, in a quarter of the time.
  SphereError CompareQuickly(const FactorModel& model) const;

 private:
  const std::optional<HemisphereGrid> grid_;  // of the whole measurement
  const Measurement seen_;
  const PictureData pictured_;
  const AppearanceOptions options_;
  std::optional<SphereJudge> judge_;  // for a table
};

// PruneOptions::error for a budget of appearance: mean Delta E, or 10^(-PSNR/20).
double ErrorIn(SceneBudget::Unit unit, const SphereError& error);
// PruneOptions::max_error for a budget of appearance, in the same unit.
double MaxError(const SceneBudget& budget);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_APPEARANCE_H_
