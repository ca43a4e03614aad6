#ifndef TRILOBE_MODEL_OBJECTIVE_OBJECTIVE_H_
#define TRILOBE_MODEL_OBJECTIVE_OBJECTIVE_H_

#include <memory>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/folded_grid.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/spline_cells.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe {

// E(model) = sum_j sum_C w_jC (rho_C(j) - rho*_jC)^2 over all samples and channels (paper eq. 2,
// docs/objective.md), prepared for a spec and a weighting. Immutable; safe to share between
// threads.
class Objective {
 public:
  // Throws Error if there is no sample, or one that is none (CheckSamples), if the largest value is
  // below 1e-50/sr, but not 0, or above 1e50/sr, if the samples know no azimuths and the spec is
  // anisotropic; if a weight is no number >= 0 or so extreme that E would leave the range of a
  // double, or if num_threads is below 1.
  Objective(BrdfSamples samples, const ModelSpec& spec, const Weighting& weighting,
            int num_threads = 1);

  // The same samples for models of another spec. Where axes and stretch are the same, all that was
  // prepared is shared, and this costs next to nothing. Throws Error as above.
  Objective(const Objective& other, const ModelSpec& spec);

  // What a fit lowers that has a prior: `with_prior` are the samples of `data` and others, which
  // say what a model is to be between these (WithPrior). Weights keep the level of the data.
  Objective(const Objective& data, BrdfSamples with_prior);

  // The objective of what was measured, by which models are judged: with a prior the one of its
  // data, else this.
  const Objective& data() const { return data_ == nullptr ? *this : *data_; }
  bool has_prior() const { return data_ != nullptr; }

  const BrdfSamples& samples() const;
  const ModelSpec& spec() const { return spec_; }
  const Weighting& weighting() const;
  int num_threads() const { return num_threads_; }

  // E of a model with this spec: the one scorer, that every trace and table quotes. The same bits
  // for any number of threads. Throws Error for a model of another spec.
  double Value(const FactorModel& model) const;

  // sum w rho*^2: E of the black model, the scale against which E is small or large.
  double MeasuredEnergy() const;

  // The part of E that no model changes: samples that read alike, which the two orders of a pair of
  // directions do, differ by it. What a measurement lacks of reciprocity is the most of it.
  double IrreducibleEnergy() const;

  // Total weight of the samples that read each parameter (the sum of w |stencil weight|), in the
  // order of FactorModel::parameters(). 0 marks an unobserved bin: not a parameter at all
  // (docs/stored-model.md).
  const std::vector<double>& coverage() const { return coverage_; }

  // One sample with its stencils. Throws Error if there is no such sample.
  WeightedSample Sample(int j) const;

  // All of them. Made at the first call (280 bytes a sample).
  const std::vector<WeightedSample>& weighted_samples() const;

  // The samples folded by symmetry, or null when they are not on a grid, or read between the bins
  // of the spec's tables: D of a spec that stretches it, and tables of other bins than the grid's.
  const FoldedGrid* folded() const;

  // The same for samples that are not; null for those that are.
  const FoldedSamples* folded_samples() const;

  // The folded samples by knot intervals of G. Made at the first call (64 bytes a sample). Throws
  // Error where folded() is null.
  const SplineCells& spline_cells() const;

 private:
  struct Prepared;  // what depends on no more of the spec than its axes and its stretch

  std::shared_ptr<const Prepared> prepared_;
  ModelSpec spec_;
  int num_threads_;
  std::vector<double> coverage_;
  std::shared_ptr<const Objective> data_;  // null without a prior
};

// The objective's samples for the next pass of a fit by a loss that grows linearly with the error
// beyond `delta`, by iteratively reweighted least squares: a sample whose error e is larger counts
// delta / e times as often (Huber 1964). e is the root mean square over the channels of the error
// as the weighting sees it, which is a relative error under weights relative to the value, in units
// of the level where the weighting has one. E of the samples that come back, up to a constant, lies
// above that loss and touches it at `model` (Hunter and Lange 2004), so that what lowers E lowers
// the loss. Throws Error unless delta > 0 and the model has the objective's spec.
BrdfSamples Reweighted(const Objective& objective, const FactorModel& model, double delta);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_OBJECTIVE_H_
