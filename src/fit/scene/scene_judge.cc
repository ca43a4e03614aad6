#include "fit/scene/scene_judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "fit/scene/directions.h"
#include "model/appearance/color.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

double ErrorByPsnr(double psnr_db) { return std::pow(10, -psnr_db / 20); }

// The part of a measurement that the scene sees.
Measurement LimitToScene(const SceneMaterial& material, Measurement measured) {
  if (material.reductions.samples) {
    // Bins reach beyond the bound of ranges, where the model has entries without data.
    const auto* const ranges = std::get_if<DirectionRanges>(&material.directions);
    if (ranges) LimitAngles(std::max(ranges->theta_i.max, ranges->theta_o.max), &measured);
  }
  BrdfSamples samples = SamplesOf(measured);
  if (material.reductions.samples) {
    samples = UsedSamples(samples, material.directions, measured.anisotropic);
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

// The samples in the scene's channels.
BrdfSamples SamplesInChannels(const SceneMaterial& material, const Measurement& measured) {
  BrdfSamples samples = SamplesOf(measured);
  const bool grey = material.channels == SceneChannels::kLuminance;
  return grey ? LuminanceOf(std::move(samples)) : samples;
}

// The samples of a measurement that LimitToScene has limited.
BrdfSamples SamplesOfSeen(const SceneMaterial& material, const Measurement& seen) {
  if (!seen.table) return seen.samples;
  BrdfSamples samples = SamplesOf(seen);
  if (!material.reductions.samples) return samples;
  return UsedSamples(samples, material.directions, seen.anisotropic);
}

}  // namespace

BrdfSamples LuminanceOf(BrdfSamples samples) {
  for (Rgb& rho : samples.rho) rho.fill(Luminance(rho));
  return samples;
}

FactorModel LuminanceOf(const FactorModel& model) {
  ModelSpec spec = model.spec();
  if (spec.D.per_channel || spec.G.per_channel) {
    throw Error(ErrorKind::kUnsupported,
                "a model whose D or G differ between the channels has no luminance of its form")
        .About("luminance");
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

SceneJudge::SceneJudge(const SceneMaterial& material, Measurement measured,
                       const AppearanceOptions& options)
    : grid_(GridOf(measured)),
      all_(SamplesInChannels(material, measured)),
      seen_(LimitToScene(material, std::move(measured))),
      samples_(SamplesOfSeen(material, seen_)),
      pictured_(PictureDataOf(seen_, grid_)),
      options_(options) {
  const bool by_places = material.reads_places();
  if (!by_places && pictured_.table != nullptr) quick_.emplace(*pictured_.table, options_);
  if (by_places || !SphereShowsSomething()) {
    reads_.emplace(all_, samples_, material.directions);
  }
  all_ = {};
}

// One of black and grey differs from anything that is seen.
bool SceneJudge::SphereShowsSomething() const {
  return std::ranges::any_of(std::array{0.0, 0.1}, [this](double diffuse) {
    FactorModel model(ModelSpec::SharedFactors(0));
    std::ranges::fill(model.d(), diffuse);
    // CompareQuickly reads some of the pixels: what these show, all of them do.
    return CompareQuickly(model).mean_delta_e > 0 || Compare(model).mean_delta_e > 0;
  });
}

SeenError SceneJudge::CompareSampled(const FactorModel& model) const {
  return CompareSampledSphere(samples_, EvaluateSamples(model, samples_, options_.num_threads),
                              MaterialOf(model).spherical, seen_.anisotropic, options_);
}

SeenError SceneJudge::Compare(const FactorModel& model) const {
  if (reads_) return reads_->Compare(model, options_.num_threads);
  if (pictured_.empty()) return CompareSampled(model);
  const ImagePair pair =
      pictured_.table != nullptr
          ? RenderMeasuredPair(*pictured_.table, MaterialOf(model).angular, options_)
          : RenderMeasuredPair(*pictured_.nodes, MaterialOf(model).spherical, options_);
  return CompareSpheres(pair.measured, pair.fitted);
}

SeenError SceneJudge::CompareQuickly(const FactorModel& model) const {
  if (reads_) return reads_->Compare(model, options_.num_threads);
  if (pictured_.empty()) return CompareSampled(model);
  if (quick_) return (*quick_)(MaterialOf(model).angular);
  AppearanceOptions smaller = options_;
  smaller.size /= 2;
  const ImagePair pair = RenderMeasuredPair(*pictured_.nodes, MaterialOf(model).spherical, smaller);
  return CompareSpheres(pair.measured, pair.fitted);
}

double ErrorIn(SceneBudget::Unit unit, const SeenError& error) {
  return unit == SceneBudget::Unit::kMeanDeltaE ? error.mean_delta_e : ErrorByPsnr(error.psnr_db);
}

double MaxError(const SceneBudget& budget) {
  return budget.unit == SceneBudget::Unit::kMeanDeltaE ? budget.amount : ErrorByPsnr(budget.amount);
}

}  // namespace trilobe
