#ifndef TRILOBE_MODEL_OBJECTIVE_SCORE_H_
#define TRILOBE_MODEL_OBJECTIVE_SCORE_H_

#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// One channel of one sample, where a model is far off.
struct WorstSample {
  int sample = 0;         // its number in Objective::samples()
  int channel = 0;        // 0 red, 1 green, 2 blue
  HalfDiffAngles angles;  // [rad]
  double measured = 0;    // rho* [1/sr]
  double fitted = 0;      // rho [1/sr]
  double error = 0;       // w (rho - rho*)^2, its share of E
};

// How well a model reproduces a measurement. All sums run over the valid samples and the three
// channels; only E and the choice of the worst samples know of weights.
struct ScoreReport {
  int valid_samples = 0;

  // E by Objective::Value, and E over that of a black model (Objective::MeasuredEnergy); the latter
  // is 0 where the measurement itself is black.
  double objective = 0;
  double relative_objective = 0;
  double irreducible_objective =
      0;  // Objective::IrreducibleEnergy; 0 where two tables are compared

  // Root of the mean of (rho - rho*)^2 [1/sr], over all channels and for each.
  double rmse = 0;
  Rgb rmse_channel{};

  // 20 log10(psnr_peak / rmse) [dB]; the peak is the largest measured value [1/sr], so a material
  // with a brighter highlight scores higher for the same error. +infinity for an exact fit and
  // -infinity for a black measurement.
  double psnr_db = 0;
  double psnr_peak = 0;

  // Mean of |rho - rho*| / (rho* + 1e-3). The 1e-3 per steradian, a third of a percent of a white
  // diffuser's 1/pi and about the noise floor of a goniometer, keeps black samples from ruling it.
  double mean_relative_error = 0;

  // Mean of |log((1 + rho cos theta_i) / (1 + rho* cos theta_i))|, rho clamped at 0: an error as
  // seen by an eye that adapts (the metric of Low et al. 2012).
  double mean_log_error = 0;

  double max_absolute_error = 0;  // [1/sr]

  // Samples and channels with the largest share of E, worst first. At most 10.
  std::vector<WorstSample> worst;
};

// Compares a model, whose spec is the objective's, with the objective's samples. The same bits for
// any number of threads. Throws Error if the model's values overflow.
ScoreReport ScoreModel(const Objective& objective, const FactorModel& model);

// ScoreReport::mean_log_error alone, of any samples that a model can be compared with. The same
// bits for any number of threads.
double MeanLogError(const BrdfSamples& samples, const FactorModel& model, int num_threads = 1);

// ScoreModel for anything that has a value at each sample. [samples().size()] Throws Error for
// another number of values.
ScoreReport ScoreValues(const Objective& objective, const std::vector<Rgb>& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_SCORE_H_
