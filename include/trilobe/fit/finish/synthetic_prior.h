#ifndef TRILOBE_FIT_FINISH_SYNTHETIC_PRIOR_H_
#define TRILOBE_FIT_FINISH_SYNTHETIC_PRIOR_H_

#include <optional>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Prior for directions between the samples of a sparse measurement.
//
// UTIA's directions are 15 degrees apart; highlights are narrower. The data then determine the
// product of D, F and G^2 only at the measured directions: factors that differ a hundredfold
// between neighbouring nodes fit as well as smooth ones, and are wrong in between. The prior is a
// model with too few parameters for that: one lobe on few nodes, or two if the second leaves less
// than 0.4 of E. It is fitted first. Its samples between the measured ones join the data, and any
// solver fits both. For isotropic data its weight is small: it decides only between fits of about
// equal E.
struct SyntheticPriorOptions {
  double weight = 1;  // > 0: weight of a sample of the prior, with one for six measured samples
  // For data without azimuths: the prior is isotropic and its weight is multiplied by 0.003.
  bool isotropic = false;
  // Grid of the samples, if there is one. The interpolated residual at its nodes is added to the
  // prior if that helps: for highlights wider than the steps of the grid (docs/forms.md).
  std::optional<HemisphereGrid> grid = {};
  StopCheck stop = {};  // ends the fit of the prior early
};

class SyntheticPrior {
 public:
  // Fits the prior with the objective's threads; deterministic. Throws Error for samples without
  // directions, and for a weight that is not finite and above 0.
  SyntheticPrior(const Objective& data, const SyntheticPriorOptions& options);

  const FactorModel& model() const { return model_; }

  // Samples of the data and of the prior, for models of the spec of `data` (see WithPrior); and
  // the objective of these, for which the fold of `data` is released.
  BrdfSamples JoinTo(const Objective& data) const;
  Objective Join(const Objective& data) const;

  // A fit may exceed the largest measured value many times between the samples, where the data
  // hardly determine an entry and noise makes it large. Adds samples of the prior to *with_prior at
  // directions where `fit` exceeds twice the largest measured value. Each has `times` the weight of
  // a sample of the prior. Returns false if none of 50,000 directions exceeds it.
  bool AddWhereLarge(const FactorModel& fit, double times, Objective* with_prior) const;

 private:
  double weight_;
  FactorModel model_;
  std::optional<NodeBrdf> residual_ = {};  // data - model, if it can be interpolated
};

// Joins samples of a prior to those of the objective, one for six. If these are fewer than three
// per parameter of the objective, there are six per parameter, with the same total weight. A prior
// with too few samples is itself fitted with a smaller prior. Uses the objective's threads;
// deterministic. Throws Error for samples without directions and for an invalid weight.
BrdfSamples WithPrior(const Objective& data, const SyntheticPriorOptions& options);

// Corrects a fit that overshoots: one that exceeds four times the largest measured value between
// the samples or, isotropic, reflects more light than it receives. Up to four rounds add samples to
// *with_prior (SyntheticPrior::AddWhereLarge) with growing weight, and refit the model by a few
// steps each; then up to four do where it is still too bright. Returns E of the data before and
// after. Returns nothing, and changes nothing, if the fit does not overshoot.
struct CorrectedOvershoot {
  double E_before = 0, E_after = 0;
};
std::optional<CorrectedOvershoot> CorrectOvershoot(const SyntheticPrior& prior,
                                                   const StopCheck& stop, Objective* with_prior,
                                                   FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_SYNTHETIC_PRIOR_H_
