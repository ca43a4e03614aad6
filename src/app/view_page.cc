#include "app/view_page.h"

#include <utility>

#include "app/fit_page.h"
#include "fit/reports/ggx_lobe.h"
#include "fit/reports/verdict_report.h"
#include "io/pictures/page.h"
#include "io/pictures/plots.h"
#include "model/appearance/picture_data.h"
#include "model/appearance/verdict.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

void Compare(const SeenError& seen, const Measurement& measured, const std::optional<Basis>& known,
             PageContents* contents) {
  const Basis basis = known ? *known : BasisOf(SamplesOf(measured), contents->parameters);
  const Verdict verdict = VerdictOf(seen, basis);
  contents->verdict = Words(verdict);
  contents->measured_share = basis.measured_share;
  contents->visibility = VisibilityName(verdict);
  contents->psnr_db = seen.psnr_db;
  contents->mean_delta_e = seen.mean_delta_e;
  contents->delta_e_95 = seen.delta_e_95;
}

// Compares at samples, as a fit does.
void CompareAtSamples(const FactorModel& model, const Measurement& measured,
                      const AppearanceOptions& appearance, PageContents* contents) {
  const int threads = appearance.num_threads;
  const BrdfSamples& samples = measured.samples;
  contents->of_sphere = false;
  Compare(CompareSampledSphere(samples, EvaluateSamples(model, samples, threads),
                               MaterialOf(model).spherical, measured.anisotropic, appearance),
          measured, std::nullopt, contents);
  contents->reach = ReachOf(samples, model, threads).between;
}

}  // namespace

ViewedPage ViewPage(const ModelFile& model, const std::string& path, const Measurement* measured,
                    const Compared& compared, std::span<const IterationRecord> trace,
                    const AppearanceOptions& appearance) {
  const std::optional<SeenError>& seen = compared.seen;
  const ModelSpec& spec = model.model.spec();
  PageContents contents;
  const std::string& source = measured != nullptr ? measured->source : model.fit.source;
  contents.name = FitNameOf(source.empty() ? path : source);
  contents.parameters = model.layout ? model.layout->num_parameters(spec) : spec.num_parameters();
  contents.wavelengths = model.spectral ? WavelengthsText(*model.spectral) : compared.wavelengths;
  contents.trace.assign(trace.begin(), trace.end());
  for (int m = 0; m < spec.lobes; ++m) {
    const std::optional<GgxLobe> ggx = NearestGgx(model.model, m);
    contents.ggx.push_back(ggx ? GgxText(*ggx) : "");
  }
  const Material fitted = MaterialOf(model.model);
  PictureData pictured;
  std::optional<BrdfTable> sampled;
  const Environment& environment = EnvironmentOf(appearance);
  if (environment.name != StudioEnvironment().name) contents.probe = &environment;
  if (compared.reach) contents.reach = compared.reach->between;
  if (measured != nullptr) {
    contents.source = measured->source;
    contents.notes = measured->notes;
    PictureData data = PictureDataOf(*measured);
    contents.of_sphere = !data.empty() || !seen;
    if (data.empty()) {
      sampled = TableOfSamples(*measured);
      if (sampled) data.table = &*sampled;
    }
    // A table says nothing of azimuths.
    const bool drawn = data.nodes || (data.table != nullptr && fitted.angular);
    if (drawn) {
      contents.measured = data.nodes ? EncodeMeasured(*data.nodes) : EncodeMeasured(*data.table);
      Compare(seen ? *seen : CompareAppearance(data, fitted, appearance).sphere, *measured,
              compared.basis, &contents);
      pictured = std::move(data);
    } else {
      if (!measured->table) {
        contents.measured =
            EncodeMeasured(measured->samples, measured->max_theta, measured->anisotropic);
      }
      if (seen) {
        Compare(*seen, *measured, compared.basis, &contents);
      } else if (!measured->table) {
        CompareAtSamples(model.model, *measured, appearance, &contents);
      }
    }
  }
  contents.spheres = PngOfSpheres(pictured, fitted, appearance);
  contents.notes.insert(contents.notes.end(), compared.advice.begin(), compared.advice.end());
  return {.text = FormatPage(model, contents), .has_measured = contents.measured.has_value()};
}

}  // namespace trilobe
