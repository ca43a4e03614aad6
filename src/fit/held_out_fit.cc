#include "fit/held_out_fit.h"

#include <utility>

#include "fit/held_out.h"
#include "fit/samples_to_fit.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {

std::optional<HeldOutError> FitWithoutHeldOut(
    const Measurement& measurement, const FitOptions& options, const ModelSpec& spec,
    const std::function<std::optional<FactorModel>(const FitOptions&)>& fit) {
  const BrdfSamples all = SamplesToFit(measurement, options.select);
  if (!HeldOutPart::CanDivide(all, *options.held_out)) return std::nullopt;
  const HeldOutPart held_out(all, *options.held_out, options.num_threads);
  const BrdfSamples kept = held_out.RemoveFrom(all);

  FitOptions of_part = options;
  of_part.held_out.reset();
  of_part.select = [&kept](const BrdfSamples& /*all*/) { return BrdfSamples(kept); };
  of_part.compare = of_part.bands = false;
  of_part.on_begin = nullptr;
  of_part.on_stage = nullptr;
  of_part.on_progress = nullptr;
  of_part.on_start = nullptr;
  of_part.on_iteration = nullptr;
  of_part.on_model = nullptr;
  if (options.choose_form) {
    // A choice among what is left holds out other blocks of it: those of the same seed are gone.
    of_part.seed = ~*options.held_out;
  } else if (!options.start_model) {
    // The default form of fewer scattered samples would be a smaller one.
    const Objective part(kept, spec, options.weighting, options.num_threads);
    of_part.start_model = FindInitialModel(options.init).make(part, options.seed);
  }
  const std::optional<FactorModel> model = fit(of_part);
  if (!model) return std::nullopt;

  const Objective held(held_out.samples(), model->spec(), options.weighting, options.num_threads);
  const double black = held.MeasuredEnergy();
  const SeenError seen = CompareSamples(
      held_out.samples(), EvaluateSamples(*model, held_out.samples(), options.num_threads));
  HeldOutError error{.samples = held_out.size(),
                     .objective = held.Value(*model),
                     .psnr_db = seen.psnr_db,
                     .mean_delta_e = seen.mean_delta_e};
  if (black > 0) error.relative_objective = error.objective / black;
  return error;
}

}  // namespace trilobe
