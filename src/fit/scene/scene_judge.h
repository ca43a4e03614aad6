#ifndef TRILOBE_FIT_SCENE_SCENE_JUDGE_H_
#define TRILOBE_FIT_SCENE_SCENE_JUDGE_H_

#include <optional>

#include "fit/scene/scene_file.h"
#include "fit/scene/scene_reads.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/channels.h"
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

// Visible difference of a model and its measurement in the channels and directions that a scene
// uses.
//
// A scene that uses a range of directions is judged on the sphere of docs/appearance.md, where that
// shows them: with a range from 0, as `trilobe score --max_angle` judges. Samples on no grid are
// judged on the sphere of CompareSampledSphere. A list, a histogram, and directions that no pixel
// of the sphere shows are judged by what is read of them (SceneReads).
class SceneJudge {
 public:
  enum class Kind { kSphere, kReads };

  SceneJudge(const SceneMaterial& material, Measurement measured, const AppearanceOptions& options);
  SceneJudge(const SceneJudge&) = delete;
  SceneJudge& operator=(const SceneJudge&) = delete;

  Kind kind() const { return reads_ ? Kind::kReads : Kind::kSphere; }

  SeenError Compare(const FactorModel& model) const;
  // The same on a quarter of the pixels, in a quarter of the time, where there is a sphere.
  SeenError CompareQuickly(const FactorModel& model) const;

 private:
  bool SphereShowsSomething() const;
  SeenError CompareSampled(const FactorModel& model) const;

  const std::optional<HemisphereGrid> grid_;  // of the whole measurement
  BrdfSamples all_;                           // that the scene could use, while it is made
  const Measurement seen_;
  const BrdfSamples samples_;  // of seen_
  const PictureData pictured_;
  const AppearanceOptions options_;
  std::optional<SphereJudge> quick_;  // for a table
  std::optional<SceneReads> reads_;
};

// PruneOptions::error for a budget of appearance: mean Delta E, or 10^(-PSNR/20).
double ErrorIn(SceneBudget::Unit unit, const SeenError& error);
// PruneOptions::max_error for a budget of appearance, in the same unit.
double MaxError(const SceneBudget& budget);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_JUDGE_H_
