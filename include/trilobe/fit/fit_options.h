#ifndef TRILOBE_FIT_FIT_OPTIONS_H_
#define TRILOBE_FIT_FIT_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/form.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

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
  // FinishOptions::limit_albedo. Who reads single places of a material needs no physics elsewhere.
  bool limit_albedo = true;
  // Returns the solver's model unchanged except for canonical form, which changes no value. Sets
  // smoothness to 0 and match_reflectance to false. An error with robust or choose_form.
  bool raw = false;
  // For a measurement with spectra: also fits d, s and F of each wavelength, with D and G of the
  // model (FitBands). An error for a measurement without spectra, if D or G differ by channel, and
  // with choose_form, which may choose such a form.
  bool bands = false;
  bool compare = true;  // computes the result's appearance, samples_seen, left_out, reach and light
  AppearanceOptions appearance = {};  // num_threads is replaced
  // Also fits the samples without a fifth of their blocks of directions, drawn by this seed, and
  // compares that fit with what was held out (FitResult::held_out).
  std::optional<uint64_t> held_out = {};
  uint64_t seed = 1;
  int num_threads = 1;

  // The fitting thread calls all callbacks but `stop` and `on_start`.
  // Called after the input has been checked, before the first step.
  std::function<void()> on_begin = [] {};
  // Called as something begins that takes a while: "comparing with the measurement".
  std::function<void(const std::string&)> on_stage = [](const std::string&) {};
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

}  // namespace trilobe

#endif  // TRILOBE_FIT_FIT_OPTIONS_H_
