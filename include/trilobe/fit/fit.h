#ifndef TRILOBE_FIT_FIT_H_
#define TRILOBE_FIT_FIT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
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

// How a measurement is fitted; the defaults are those of `trilobe fit`.
struct FitOptions {
  FormOptions form = {};
  std::string init = InitialModels().front().name;
  // In their place: a model to start from, whose form the fit then has.
  std::optional<FactorModel> start_model = {};
  // Which of the measured samples count, and how; all as they are without it. What is left is no
  // picture any more, so that no reflectance is matched and no appearance compared.
  std::function<BrdfSamples(BrdfSamples)> select = nullptr;
  std::string solver = Solvers().front().name;
  // Of the solver, for the form that it is to fit; on_iteration and stop are replaced. Asked when
  // it begins.
  std::function<SolverOptions(const ModelSpec&)> solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions();
  };
  Weighting weighting = Weightings().front();
  // Of scattered samples, SyntheticPriorOptions::weight, or 0 for no prior; where it is not given,
  // 1, and with kAnisotropic 0.
  std::optional<double> prior = {};
  double smoothness = 0.005;  // FinishOptions, as the next
  double robust = 0;
  // --model=auto: the form that looks best, within so many parameters; by default 822 of a table,
  // and of scattered samples as many as that of `form` has. Beside a picture of tables and of
  // samples at the nodes of a grid; of others by samples that are held out, if there are enough.
  bool choose_form = false;
  std::optional<int> max_parameters = {};
  bool match_reflectance = true;  // FinishOptions
  // The result is the model that the solver found: nothing is done to it afterwards, so that
  // solvers can be compared. Only its scale moves between tables (canonical form), which changes no
  // value. Not with robust, choose_form, nor a smoothness that is asked for.
  bool raw = false;
  bool compare = true;  // makes `appearance`, `left_out`, `reach` and `light` of the result, too
  AppearanceOptions appearance = {};  // num_threads is replaced
  uint64_t seed = 1;
  int num_threads = 1;

  // All of what follows but `stop` is called from the thread that fits.
  // When the input has proved right, and before the first step.
  std::function<void()> on_begin = [] {};
  // After each iteration: of whatever is fitted on the way, and of the solver's own; where it fits
  // several forms, those of the first.
  std::function<void(const IterationRecord&)> on_progress = [](const IterationRecord&) {};
  std::function<void(const IterationRecord&, const FactorModel&)> on_iteration =
      [](const IterationRecord&, const FactorModel&) {};
  // There is a model: as the solver left it, when nobody has asked to stop, and once more when it
  // is finished. Of the result the file is made, and `summary`.
  std::function<void(const FitResult&)> on_model = [](const FitResult&) {};
  // Asked after each step, from several threads: true to end with the best so far.
  StopCheck stop = {};
};

// A measurement, as it is fitted.
struct FitProblem {
  Objective data;  // by which models are judged
  // What the solver lowers: with scattered samples, those of a prior besides (WithPrior).
  std::optional<Objective> with_prior = {};

  const Objective& solved() const { return with_prior ? *with_prior : data; }
};

struct FitResult {
  Objective objective;  // of the data, for models of the file's spec
  // The model in canonical form, its layout, and how it came about; program, date and run are left
  // to whoever writes it.
  ModelFile file = {};
  SolverSummary summary = {};
  std::optional<NodeChoice> nodes = {};  // of those of D and G, where it was asked for
  // Samples that joined the data for the solver.
  struct Prior {
    double weight = 0;
    int samples = 0;
  };
  std::optional<Prior> prior = {};
  // What came after the solver (FinishedFit).
  struct Finished {
    std::vector<FinishingStep> steps = {};
    std::vector<ModelCandidate> candidates = {};
    int chosen = -1;
    int held_out = 0;           // samples that they were judged by; 0: by pictures
    int too_few_to_choose = 0;  // where a form was to be chosen, the samples that this takes
    std::optional<FinishedFit::Matched> matched = {};
  } finished = {};
  int stored_parameters = 0;
  // E of the stored model, on the data alone; summary.final_objective is that of the solver's.
  ScoreReport score = {};
  std::optional<AppearanceReport> appearance = {};  // none of samples on no grid
  std::optional<SeenError> samples_seen = {};       // of these
  // Of an isotropic model of anisotropic data: the share of the energy that the mean over all turns
  // of the sample leaves out (AnisotropyOf).
  std::optional<double> left_out = {};
  std::optional<Reach> reach = {};  // of scattered samples
  LobeLight light = {};
  struct Seconds {
    double prepare = 0, init = 0, nodes = 0, solve = 0, finish = 0, score = 0;
  } seconds = {};
  bool raw = false;          // FitOptions::raw
  bool interrupted = false;  // by `stop`, at any time

  const FactorModel& model() const { return file.model; }
};

// From a measurement to the model that `trilobe fit` writes, and all that it reports: the form, the
// start, the choice of nodes, the prior, the solver, what comes after it, and the score. The same
// bits for the same options; functions that are empty are as those by default. Stopped before
// on_begin it returns no model. Throws Error.
FitResult Fit(const Measurement& measurement, const FitOptions& options = {});

// What Fit fits, where no nodes are to be chosen; for whoever goes on from its model, whose spec
// this is. The prior is fitted here, which takes time.
FitProblem ProblemFor(const Measurement& measurement, const FitOptions& options,
                      const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FIT_H_
