#include "fit/scene/look.h"

#include <cmath>
#include <utility>
#include <vector>

#include "fit/scene/directions.h"
#include "fit/scene/luminance.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/material.h"

namespace trilobe {
namespace {

double ErrorByPsnr(double psnr_db) { return std::pow(10, -psnr_db / 20); }

// What the scene sees of a measurement.
Measurement Seen(const SceneMaterial& material, Measurement measured) {
  BrdfSamples samples = SamplesOf(measured);
  if (measured.table && material.reductions.samples) {
    samples = UsedSamples(samples, material.directions);
  }
  if (material.channels == SceneChannels::kLuminance) {
    samples = LuminanceOf(std::move(samples));
    measured.formula = nullptr;
  }
  if (!measured.table) {
    measured.samples = std::move(samples);
    return measured;
  }
  BrdfTable& table = *measured.table;
  table.unmeasured.resize(table.grid.size(), Unmeasured::kNo);
  std::vector<bool> used(table.grid.size());
  for (int j = 0; j < samples.size(); ++j) {
    const int bin = samples.bins[j];
    used[bin] = true;
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, samples.rho[j][c]);
  }
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    Unmeasured& why = table.unmeasured[bin];
    if (!used[bin] && why == Unmeasured::kNo) why = Unmeasured::kBeyondMaxAngle;
  }
  return measured;
}

SphereError AtNodes(const NodeBrdf& nodes, const FactorModel& model,
                    const AppearanceOptions& options) {
  const ImagePair pair = RenderMeasuredPair(nodes, MaterialOf(model).spherical, options);
  return CompareSpheres(pair.measured, pair.fitted);
}

}  // namespace

Look::Look(const SceneMaterial& material, Measurement measured, const AppearanceOptions& options)
    : seen_(Seen(material, std::move(measured))),
      pictured_(PictureDataOf(seen_)),
      options_(options) {
  if (pictured_.empty()) {
    throw Error(seen_.source +
                ": samples on no grid make no picture to compare with; give a budget in "
                "relative_rise, psnr_drop_db, bytes or seconds");
  }
  if (pictured_.table != nullptr) judge_.emplace(*pictured_.table, options_);
}

SphereError Look::Of(const FactorModel& model) const {
  if (pictured_.table == nullptr) return AtNodes(*pictured_.nodes, model, options_);
  const ImagePair pair = RenderMeasuredPair(*pictured_.table, MaterialOf(model).angular, options_);
  return CompareSpheres(pair.measured, pair.fitted);
}

SphereError Look::Quickly(const FactorModel& model) const {
  if (judge_) return (*judge_)(MaterialOf(model).angular);
  AppearanceOptions smaller = options_;
  smaller.size /= 2;
  return AtNodes(*pictured_.nodes, model, smaller);
}

double ErrorIn(SceneBudget::Unit unit, const SphereError& error) {
  return unit == SceneBudget::Unit::kMeanDeltaE ? error.mean_delta_e : ErrorByPsnr(error.psnr_db);
}

double MaxError(const SceneBudget& budget) {
  return budget.unit == SceneBudget::Unit::kMeanDeltaE ? budget.amount : ErrorByPsnr(budget.amount);
}

}  // namespace trilobe
