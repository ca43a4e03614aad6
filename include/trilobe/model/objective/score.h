#ifndef TRILOBE_MODEL_OBJECTIVE_SCORE_H_
#define TRILOBE_MODEL_OBJECTIVE_SCORE_H_

#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// A sample and channel with a large error.
struct WorstSample {
  int sample = 0;         // index in Objective::samples()
  int channel = 0;        // 0 red, 1 green, 2 blue
  HalfDiffAngles angles;  // [rad]
  double measured = 0;    // rho* [1/sr]
  double fitted = 0;      // rho [1/sr]
  double error = 0;       // w (rho - rho*)^2, its part of E
};

// Quality of a model as a reproduction of a measurement. Sums run over the valid samples and all
// channels; only E and the selection of the worst samples use weights.
struct ScoreReport {
  int valid_samples = 0;

  // E by Objective::Value, and relative to E of a black model (Objective::MeasuredEnergy); the
  // latter is 0 for a black measurement.
  double objective = 0;
  double relative_objective = 0;
  // Objective::IrreducibleEnergy; 0 where two tables are compared.
  double irreducible_objective = 0;

  // Root mean square of rho - rho* [1/sr], over all channels and per channel.
  double rmse = 0;
  Rgb rmse_channel{};

  // 20 log10(psnr_peak / rmse) [dB]. The peak is the largest measured value [1/sr], so for the same
  // error a brighter highlight gives a higher PSNR. +infinity for an exact fit, -infinity for a
  // black measurement.
  double psnr_db = 0;
  double psnr_peak = 0;

  // Mean of |rho - rho*| / (rho* + 1e-3). The 1e-3/sr, 0.3 % of a white diffuser's 1/pi and about
  // the noise floor of a goniometer, keeps dark samples from dominating.
  double mean_relative_error = 0;

  // Mean of |log((1 + rho cos theta_i) / (1 + rho* cos theta_i))|, rho clamped at 0: a perceptual
  // metric (Low et al. 2012).
  double mean_log_error = 0;

  double max_absolute_error = 0;  // [1/sr]

  // The at most 10 samples and channels with the largest part of E, worst first.
  std::vector<WorstSample> worst;
};

// Compares a model with the objective's samples; their specs must agree. The same bits for any
// number of threads. Throws Error if the model's values overflow.
ScoreReport ScoreModel(const Objective& objective, const FactorModel& model);

// ScoreReport::mean_log_error for any samples. The same bits for any number of threads.
double MeanLogError(const BrdfSamples& samples, const FactorModel& model, int num_threads = 1);

// ScoreModel for values at each sample, [samples().size()]. Throws Error if their number differs.
ScoreReport ScoreValues(const Objective& objective, const std::vector<Rgb>& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SCORE_H_
