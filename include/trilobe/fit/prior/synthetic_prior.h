#ifndef TRILOBE_FIT_PRIOR_SYNTHETIC_PRIOR_H_
#define TRILOBE_FIT_PRIOR_SYNTHETIC_PRIOR_H_

#include <optional>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// What a fit goes by between the directions of a sparse measurement.
//
// UTIA's directions are 15 degrees apart, and highlights narrower. There the data determine the
// product of D, F and G^2 at their own directions only: factors that trade a hundredfold between
// neighbouring nodes fit them as well as smooth ones do, and shine wrongly in between. The prior is
// a model of too few numbers for that, one lobe on few nodes, or two where one leaves most of E,
// fitted first; samples of it between the measured ones then join the data, and any solver fits
// both. So it is with few scattered samples of an isotropic material. Without azimuths a sample
// says more about each parameter, and it is enough that the prior decides between what fits the
// samples equally well: its weight is small.
struct SyntheticPriorOptions {
  double weight = 1;  // > 0: what a sample of the prior counts, where there is one for six measured
  // The data know no azimuths, and so the prior knows none; what it says counts 0.003 of that.
  bool isotropic = false;
  // At whose nodes the samples stand, if they do. What the prior says between them is then moved by
  // the residual at them, interpolated, where that helps: with highlights that are wider than the
  // grid's steps (docs/anisotropic.md).
  std::optional<HemisphereGrid> grid = {};
  StopCheck stop = {};  // ends the fit of the prior early
};

class SyntheticPrior {
 public:
  // Fits it, with the objective's number of threads; deterministic. Throws Error for samples
  // without directions, and for a weight that is not above 0.
  SyntheticPrior(const Objective& data, const SyntheticPriorOptions& options);

  const FactorModel& model() const { return model_; }

  // The data's samples and the prior's, for fits of the spec of `data`: see WithPrior.
  BrdfSamples JoinTo(const Objective& data) const;

  // Between the samples a fit of such an objective may reach many times the largest value that was
  // measured: an entry that the data read only where another factor is next to 0 may be anything,
  // and noise makes it large. The same objective with what the prior says at directions where
  // `fit` is above twice the largest, each of which counts `times` as much as one of the prior's
  // samples among many data. Nothing where there is no such direction among 50,000.
  std::optional<Objective> AddWhereLarge(const Objective& with_prior, const FactorModel& fit,
                                         double times) const;

 private:
  double weight_;
  FactorModel model_;
  std::optional<NodeBrdf> residual_ = {};  // data less model, if that can be interpolated
};

// The objective's samples and the prior's, one for six of them, with the objective's number of
// threads; deterministic. Where that is less than three for each of the objective's parameters,
// there are six for each, which together count as much, and the prior is fitted with a smaller one.
// Throws Error for samples without directions, and for another weight.
BrdfSamples WithPrior(const Objective& data, const SyntheticPriorOptions& options);

// Goes on from a fit of `with_prior` that overshoots between the samples, above four times the
// largest value that was measured, with what SyntheticPrior::AddWhereLarge adds, ever more of it,
// which *with_prior then has, too: a few steps a round, and as many rounds as it takes, up to four.
// Returns E of the data before and after; nothing, and changes nothing, where the fit does not
// overshoot.
struct CorrectedOvershoot {
  double E_before = 0, E_after = 0;
};
std::optional<CorrectedOvershoot> CorrectOvershoot(const SyntheticPrior& prior,
                                                   const StopCheck& stop, Objective* with_prior,
                                                   FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_SYNTHETIC_PRIOR_H_
