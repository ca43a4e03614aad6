#ifndef TRILOBE_FIT_FIT_H_
#define TRILOBE_FIT_FIT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/bands/fit_bands.h"
#include "trilobe/fit/finish_fit.h"
#include "trilobe/fit/form.h"
#include "trilobe/fit/prior/node_choice.h"
#include "trilobe/fit/prior/reach.h"
#include "trilobe/fit/prior/synthetic_prior.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/lobes/lobe_light.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

namespace trilobe {

struct FitResult;

// Options of Fit. The defaults are those of `trilobe fit`.
struct FitOptions {
  FormOptions form = {};
  std::string init = InitialModels().front().name;
  // Model to start from. Replaces `form` and `init`.
  std::optional<FactorModel> start_model = {};
  // Selects or changes the samples to fit; null: all measured samples. With it, no reflectance is
  // matched and no appearance is compared.
  std::function<BrdfSamples(BrdfSamples)> select = nullptr;
  std::string solver = Solvers().front().name;
  // Returns the solver's options for a spec. Called before the solver starts; on_iteration and stop
  // are replaced.
  std::function<SolverOptions(const ModelSpec&)> solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions();
  };
  Weighting weighting = Weightings().front();
  // For scattered samples: SyntheticPriorOptions::weight, or 0 for no prior. Default: 1, with
  // kAnisotropic 0. An error for a table.
  std::optional<double> prior = {};
  double smoothness = 0.005;  // FinishOptions::smoothness
  double robust = 0;          // FinishOptions::robust
  // --model=auto: chooses the best form of at most max_parameters parameters (default: 822 for a
  // table, else the size of `form`). Forms of tables, and of samples on a grid of directions, are
  // compared by rendered pictures; others by held-out samples, if there are enough.
  bool choose_form = false;
  std::optional<int> max_parameters = {};
  bool match_reflectance = true;  // FinishOptions::match_reflectance
  // Returns the solver's model unchanged except for canonical form, which changes no value. Sets
  // smoothness to 0 and match_reflectance to false. An error with robust or choose_form.
  bool raw = false;
  // Of a measurement with spectra: also fits d, s and F of each wavelength, with D and G of the
  // model (FitBands). An error for one without, where D or G differ by channel, and with
  // choose_form, which may choose such a form.
  bool bands = false;
  bool compare = true;  // computes the result's appearance, samples_seen, left_out, reach and light
  AppearanceOptions appearance = {};  // num_threads is replaced
  uint64_t seed = 1;
  int num_threads = 1;

  // The fitting thread calls all callbacks but `stop` and `on_start`.
  // Called after the input has been checked, before the first step.
  std::function<void()> on_begin = [] {};
  // Called after each iteration of every fit.
  std::function<void(const IterationRecord&)> on_progress = [](const IterationRecord&) {};
  // SolverOptions::on_start of every fit.
  std::function<void(const StartProgress&)> on_start = [](const StartProgress&) {};
  // Called after each iteration of the solver; with several forms, for the first form only.
  std::function<void(const IterationRecord&, const FactorModel&)> on_iteration =
      [](const IterationRecord&, const FactorModel&) {};
  // Called with the solver's model, unless the fit was stopped, and with the finished model. `file`
  // and `summary` of the result are valid.
  std::function<void(const FitResult&)> on_model = [](const FitResult&) {};
  // Called after each step, from several threads. Return true to end with the best model so far.
  StopCheck stop = {};
};

// The objectives of a fit.
struct FitProblem {
  Objective data;  // judges models
  // Data and samples of a prior (WithPrior), if there is one: the solver minimises this.
  std::optional<Objective> with_prior = {};

  const Objective& solved() const { return with_prior ? *with_prior : data; }
};

struct FitResult {
  Objective objective;  // of the data, for the spec of file.model
  // The model in canonical form, its layout and fit information. The writer sets program, date and
  // run.
  ModelFile file = {};
  SolverSummary summary = {};
  std::optional<NodeChoice> nodes = {};  // with FormOptions::nodes_by_held_out
  // Samples of the prior that joined the data, and the weight of each.
  struct Prior {
    double weight = 0;
    int samples = 0;
  };
  std::optional<Prior> prior = {};
  // What changed the model after the solver (FinishedFit).
  struct Finished {
    std::vector<FinishingStep> steps = {};
    std::vector<ModelCandidate> candidates = {};
    int chosen = -1;
    int held_out = 0;           // samples that judged the candidates; 0: pictures did
    int too_few_to_choose = 0;  // samples that choose_form needs, if there were fewer; else 0
    std::optional<FinishedFit::Matched> matched = {};
    std::optional<FinishedFit::Glow> glow = {};  // FinishedFit::glow
  } finished = {};
  int stored_parameters = 0;
  // Of the stored model, on the data alone. summary.final_objective is of the solver's model.
  ScoreReport score = {};
  std::optional<AppearanceReport> appearance = {};  // for a table or samples on a grid
  std::optional<SeenError> samples_seen = {};       // for other samples
  // For an isotropic model of anisotropic data: the share of the energy that the mean over
  // rotations of the sample loses (AnisotropyOf).
  std::optional<double> left_out = {};
  std::optional<Reach> reach = {};  // for scattered samples
  double measured_share = 1;        // of what a renderer reads (MeasuredShare)
  // For an isotropic fit to what was not measured everywhere: what is expected of all directions
  // (EstimateWholeSphere, EstimateWholeOfSamples).
  std::optional<WholeSphere> whole = {};
  LobeLight light = {};
  std::optional<BandsFit> bands = {};        // FitOptions::bands, unless stopped before
  std::optional<SeenError> bands_seen = {};  // their colours, as `appearance` or samples_seen
  // The largest jump of the directional albedo from one entry of G to the next (RippleOf).
  struct Ripple {
    double share = 0, theta_i = 0;  // [rad]
  } ripple = {};
  struct Seconds {
    double prepare = 0, init = 0, nodes = 0, solve = 0, finish = 0, bands = 0, score = 0;
  } seconds = {};
  bool raw = false;          // FitOptions::raw
  bool interrupted = false;  // `stop` has returned true

  const FactorModel& model() const { return file.model; }
};

// Fits a measurement as `trilobe fit` does: chooses form, start and nodes, fits the prior, runs the
// solver, finishes the model and scores it. The same input gives the same bits. Empty callbacks
// stand for the defaults. If stopped before on_begin, the result has no model. Throws Error. Use:
//
//   const FitResult fit = Fit(LoadMeasurement("synth:plastic"), {.num_threads = 4});
//   WriteModel(fit.file, "plastic.json");
FitResult Fit(const Measurement& measurement, const FitOptions& options = {});

// The objectives that Fit uses for models of this spec, without a choice of nodes. Fits the prior,
// which takes time.
FitProblem ProblemFor(const Measurement& measurement, const FitOptions& options,
                      const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FIT_H_
