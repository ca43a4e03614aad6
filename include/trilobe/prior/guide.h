#ifndef TRILOBE_PRIOR_GUIDE_H_
#define TRILOBE_PRIOR_GUIDE_H_

#include <optional>

#include "trilobe/base/stop_check.h"
#include "trilobe/brdf/brdf_samples.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

// What a fit goes by between the directions of a sparse measurement.
//
// UTIA's directions are 15 degrees apart, and highlights narrower. There the data determine the
// product of D, F and G^2 at their own directions only: factors that trade a hundredfold between
// neighbouring nodes fit them as well as smooth ones do, and shine wrongly in between. The guide is
// a model of too few numbers for that, one lobe on few nodes, fitted first; samples of it between
// the measured ones then join the data, and any solver fits both. So it is with few scattered
// samples of an isotropic material. Without azimuths a sample says more about each parameter, and
// it is enough that the guide decides between what fits the samples equally well: its weight is
// small.
struct GuideOptions {
  double weight = 1;  // > 0: what a sample of the guide counts, where there is one for six measured
  // The data know no azimuths, and so the guide knows none; what it says counts 0.003 of that.
  bool isotropic = false;
  StopCheck stop = {};  // ends the fit of the guide early
};

class Guide {
 public:
  // Fits it, with the objective's number of threads; deterministic. Throws Error for samples
  // without directions, and for a weight that is not above 0.
  Guide(const Objective& data, const GuideOptions& options);

  const FactorModel& model() const { return model_; }

  // The data's samples and the guide's, for fits of the spec of `data`: see WithGuide.
  BrdfSamples With(const Objective& data) const;

  // Between the samples a fit of such an objective may reach many times the largest value that was
  // measured: an entry that the data read only where another factor is next to 0 may be anything,
  // and noise makes it large. The same objective with what the guide says at directions where
  // `fit` is above twice the largest, each of which counts `times` as much as one of the guide's
  // samples among many data. Nothing where there is no such direction among 50,000.
  std::optional<Objective> WhereLarge(const Objective& guided, const FactorModel& fit,
                                      double times) const;

 private:
  double weight_;
  FactorModel model_;
};

// The objective's samples and the guide's, one for six of them, with the objective's number of
// threads; deterministic. Where that is less than three for each of the objective's parameters,
// there are six for each, which together count as much, and the guide is fitted with a smaller one.
// Throws Error for samples without directions, and for another weight.
BrdfSamples WithGuide(const Objective& data, const GuideOptions& options);

// Goes on from a fit of `guided` that runs wild between the samples, above four times the largest
// value that was measured, with what Guide::WhereLarge adds, ever more of it, which *guided then
// has, too: a few steps a round, and as many rounds as it takes, up to four. Returns E of the data
// before and after; nothing, and changes nothing, where the fit is not wild.
struct TamedFit {
  double E_before = 0, E_after = 0;
};
std::optional<TamedFit> TameBetweenSamples(const Guide& guide, const StopCheck& stop,
                                           Objective* guided, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_PRIOR_GUIDE_H_
