#include "fit/azimuths.h"

#include <algorithm>
#include <optional>
#include <string>

#include "core/base/text.h"
#include "fit/held_out_fit.h"
#include "model/measurement/anisotropy.h"

namespace trilobe {
namespace {

// Shares of the energy that change with the azimuth: less than the first, 1.4 % of a value, is not
// seen, and more than the second, 22 %, is more than noise.
constexpr double kVisible = 2e-4, kCertain = 0.05;
// How much lower E of held-out samples must be by an anisotropic model.
constexpr double kBetter = 0.9;

// E of the blocks that are held out, by the default fit to the others.
std::optional<HeldOutError> HeldOutErrorOf(const Measurement& measurement,
                                           const FitOptions& options, const FitModel& fit) {
  FitOptions part;  // whatever solver is to make the fit
  part.form.lobes = options.form.lobes;
  part.weighting = options.weighting;
  part.held_out = part.seed = options.seed;
  part.num_threads = options.num_threads;
  part.stop = options.stop;
  const ModelSpec spec = SpecFor(measurement, part.form, measurement.samples.size());
  return FitWithoutHeldOut(measurement, part, spec,
                           [&](const FitOptions& of_part) { return fit(measurement, of_part); });
}

std::string Percent(double share) { return Text(100 * share, 3) + " %"; }

}  // namespace

bool ChoosesAzimuths(const Measurement& measurement, const FitOptions& options) {
  const FormOptions& form = options.form;
  const bool nodes_given =
      form.d_nodes || form.f_bins || form.g_nodes || form.nodes == FormOptions::NodeRule::kHeldOut;
  return !measurement.table && measurement.anisotropic && !measurement.azimuths_matter &&
         form.kind == FormOptions::Kind::kShared && !nodes_given && !options.start_model;
}

AzimuthChoice ChooseAzimuths(const Measurement& measurement, const FitOptions& options,
                             const FitModel& fit) {
  const Anisotropy turned = AnisotropyOf(measurement);
  const int samples = measurement.samples.size();
  const bool is_turned = 2 * turned.samples >= samples;
  const std::string changes = "turned about its normal, the material changes by ";
  if (is_turned && (turned.share < kVisible || turned.share > kCertain)) {
    return {turned.share > kCertain, changes + Percent(turned.share) + " of its energy"};
  }
  if (2 * turned.with_neighbours >= samples) {
    const bool matter = turned.smooth_share > kVisible + turned.smooth_share_error;
    return {matter, changes + Percent(std::max(0.0, turned.smooth_share)) +
                        " of its energy beyond noise, " + Percent(turned.share) + " with it"};
  }
  const int parameters = SpecFor(measurement, options.form, samples).num_parameters();
  if (kChannels * samples < 2 * parameters) {
    return {false, std::to_string(samples) + " samples are too few for the " +
                       std::to_string(parameters) +
                       " parameters of an anisotropic model, which --model=anisotropic takes"};
  }
  const std::optional<HeldOutError> without =
      HeldOutErrorOf(WithoutAzimuths(measurement), options, fit);
  const std::optional<HeldOutError> with =
      without ? HeldOutErrorOf(measurement, options, fit) : std::nullopt;
  if (!with || !without) return {false, "no blocks of samples can be held out to tell"};
  const bool matter = with->objective < kBetter * without->objective;
  return {matter, "E of " + std::to_string(with->samples) + " held-out samples is " +
                      Text(with->objective, 3) + " by an anisotropic model and " +
                      Text(without->objective, 3) + " by an isotropic one"};
}

Measurement WithoutAzimuths(const Measurement& measurement) {
  Measurement isotropic = measurement;
  isotropic.anisotropic = false;
  return isotropic;
}

}  // namespace trilobe
