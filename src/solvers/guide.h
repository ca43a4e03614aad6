#ifndef TRILOBE_SOLVERS_GUIDE_H_
#define TRILOBE_SOLVERS_GUIDE_H_

#include "trilobe/base/stop_check.h"
#include "trilobe/brdf/brdf_samples.h"
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

// The objective's samples and the guide's, one for six of them, with the objective's number of
// threads; deterministic. Where that is less than three for each of the objective's parameters,
// there are six for each, which together count as much, and the guide is fitted with a smaller one.
// Throws Error for samples without directions, and for another weight.
BrdfSamples WithGuide(const Objective& data, const GuideOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_GUIDE_H_
