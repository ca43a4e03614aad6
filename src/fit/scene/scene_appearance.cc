#include "fit/scene/scene_appearance.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fit/scene/directions.h"
#include "model/appearance/color.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/material.h"

namespace trilobe {
namespace {

double ErrorByPsnr(double psnr_db) { return std::pow(10, -psnr_db / 20); }

// What the scene sees of a measurement.
Measurement LimitToScene(const SceneMaterial& material, Measurement measured) {
  if (material.reductions.samples) {
    // Bins reach beyond the bound of ranges, where the model has entries without data.
    const auto* const ranges = std::get_if<DirectionRanges>(&material.directions);
    if (ranges) LimitAngles(std::max(ranges->theta_i.max, ranges->theta_o.max), &measured);
  }
  BrdfSamples samples = SamplesOf(measured);
  if (material.reductions.samples)
    samples = UsedSamples(samples, material.directions, measured.anisotropic);
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

SphereError CompareAtNodes(const NodeBrdf& nodes, const FactorModel& model,
                           const AppearanceOptions& options) {
  const ImagePair pair = RenderMeasuredPair(nodes, MaterialOf(model).spherical, options);
  return CompareSpheres(pair.measured, pair.fitted);
}

}  // namespace

BrdfSamples LuminanceOf(BrdfSamples samples) {
  for (Rgb& rho : samples.rho) rho.fill(Luminance(rho));
  return samples;
}

FactorModel LuminanceOf(const FactorModel& model) {
  ModelSpec spec = model.spec();
  if (spec.D.per_channel || spec.G.per_channel) {
    throw Error("a model whose D or G differ between the channels has no luminance of its form");
  }
  spec.F = {.per_lobe = true, .per_channel = false};
  FactorModel grey(spec);
  std::ranges::fill(grey.d(), Luminance({model.d()[0], model.d()[1], model.d()[2]}));
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::fill(grey.s(m), 1.0);
    const std::span<double> F = grey.table(Factor::kF, m);
    for (size_t k = 0; k < F.size(); ++k) {
      const Rgb reflected = {model.s(m)[0] * model.F(m, 0)[k], model.s(m)[1] * model.F(m, 1)[k],
                             model.s(m)[2] * model.F(m, 2)[k]};
      F[k] = Luminance(reflected);
    }
  }
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      std::ranges::copy(model.table(factor, t), grey.table(factor, t).begin());
    }
  }
  return grey;
}

SceneAppearance::SceneAppearance(const SceneMaterial& material, Measurement measured,
                                 const AppearanceOptions& options)
    : grid_(GridOf(measured)),
      seen_(LimitToScene(material, std::move(measured))),
      pictured_(PictureDataOf(seen_, grid_)),
      options_(options) {
  if (pictured_.empty()) {
    throw Error(seen_.source +
                ": samples on no grid make no picture to compare with; give a budget in "
                "relative_rise, psnr_drop_db, bytes or seconds");
  }
  if (pictured_.table != nullptr) judge_.emplace(*pictured_.table, options_);
}

void SceneAppearance::CheckShowsSomething() const {
  // One of black and grey differs from anything that is seen.
  const auto differs_from = [this](double diffuse) {
    FactorModel model(ModelSpec::SharedFactors(0));
    std::ranges::fill(model.d(), diffuse);
    // What some of the pixels show, all of them do.
    return CompareQuickly(model).mean_delta_e > 0 || Compare(model).mean_delta_e > 0;
  };
  if (differs_from(0) || differs_from(0.1)) return;
  throw Error(seen_.source +
              ": no pixel of the sphere shows a direction that the scene uses; give a budget in "
              "relative_rise, psnr_drop_db, bytes or seconds");
}

SphereError SceneAppearance::Compare(const FactorModel& model) const {
  if (pictured_.table == nullptr) return CompareAtNodes(*pictured_.nodes, model, options_);
  const ImagePair pair = RenderMeasuredPair(*pictured_.table, MaterialOf(model).angular, options_);
  return CompareSpheres(pair.measured, pair.fitted);
}

SphereError SceneAppearance::CompareQuickly(const FactorModel& model) const {
  if (judge_) return (*judge_)(MaterialOf(model).angular);
  AppearanceOptions smaller = options_;
  smaller.size /= 2;
  return CompareAtNodes(*pictured_.nodes, model, smaller);
}

double ErrorIn(SceneBudget::Unit unit, const SphereError& error) {
  return unit == SceneBudget::Unit::kMeanDeltaE ? error.mean_delta_e : ErrorByPsnr(error.psnr_db);
}

double MaxError(const SceneBudget& budget) {
  return budget.unit == SceneBudget::Unit::kMeanDeltaE ? budget.amount : ErrorByPsnr(budget.amount);
}

}  // namespace trilobe
