#ifndef TRILOBE_FIT_FIT_H_
#define TRILOBE_FIT_FIT_H_

#include <optional>
#include <vector>

#include "trilobe/fit/azimuth_choice.h"
#include "trilobe/fit/finish/node_choice.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/fit/finish_fit.h"
#include "trilobe/fit/fit_bands.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/fit/held_out_error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/repeat_noise.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

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
  std::optional<AzimuthChoice> azimuths = {};  // for samples whose azimuths are given
  std::optional<NodeChoice> nodes = {};        // where finer ones were tried
  // Samples of the prior that joined the data, and the weight of each.
  struct Prior {
    double weight = 0;
    int samples = 0;
  };
  std::optional<Prior> prior = {};
  // Changes to the solver's model (FinishedFit).
  struct Finished {
    std::vector<FinishingStep> steps = {};
    std::vector<Candidate> candidates = {};
    int chosen = -1;
    int held_out = 0;           // samples that judged the candidates; 0: pictures did
    int too_few_to_choose = 0;  // samples that choose_form needs, if there were fewer; else 0
    std::optional<FinishedFit::Matched> matched = {};
    std::optional<FinishedFit::Glow> glow = {};  // FinishedFit::glow
  } finished = {};
  int stored_parameters = 0;
  // Score of the stored model on the data alone; summary.final_objective is that of the solver's
  // model.
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
  std::optional<RepeatNoise> repeats = {};
  std::optional<HeldOutError> held_out = {};  // unless the samples are too few
  std::optional<BandsFit> bands = {};         // FitOptions::bands, unless stopped before
  std::optional<SeenError> bands_seen = {};   // their colours, as `appearance` or samples_seen
  // The largest jump of the directional albedo from one entry of G to the next (RippleOf).
  struct Ripple {
    double share = 0, theta_i = 0;  // [rad]
  } ripple = {};
  struct Seconds {
    double prepare = 0, init = 0, nodes = 0, solve = 0, finish = 0, bands = 0, score = 0;
    double held_out = 0;
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
