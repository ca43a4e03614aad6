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
// docs/objective.md), prepared for one spec and weighting. Immutable and thread-safe: what is
// computed at the first call is kept, and shared by copies.
//
//   const Objective objective(ValidSamples(table), model.spec(), FindWeighting("compressive"));
//   const double E = objective.Value(model), relative = E / objective.MeasuredEnergy();
class Objective {
 public:
  // Throws Error for no or invalid samples (CheckSamples), a nonzero largest value outside [1e-50,
  // 1e50]/sr, an anisotropic spec and samples without azimuths, weights that are negative, not
  // finite or so extreme that E leaves the range of double, and num_threads < 1.
  Objective(BrdfSamples samples, const ModelSpec& spec, const Weighting& weighting,
            int num_threads = 1);

  // The same for samples that are shared, and not copied.
  Objective(std::shared_ptr<const BrdfSamples> samples, const ModelSpec& spec,
            const Weighting& weighting, int num_threads = 1);

  // The same samples for another spec. Cheap if axes and stretch are equal, as all preparations are
  // shared. Throws Error as above.
  Objective(const Objective& other, const ModelSpec& spec);

  // The objective of a fit with a prior: `with_prior` are the samples of `data` and additional ones
  // that constrain the model between them (WithPrior). Weights keep the level of the data.
  Objective(const Objective& data, BrdfSamples with_prior);

  // The samples of another objective, which are scattered, and others with them, which constrain
  // the model between them and count `weight` each; data() is that of the other one. It takes less
  // memory than the constructor above: the samples of the other are shared, and are folded together
  // with these alone (ReleaseFold). Throws Error as above.
  Objective(Objective objective, BrdfSamples added, double weight);

  // The same samples, those of a prior as if they were measured, for another number of threads.
  // Shares all preparations.
  Objective Alone(int num_threads) const;

  // The objective of the measured samples alone, by which models are judged; *this without a prior.
  const Objective& data() const { return data_ == nullptr ? *this : *data_; }
  bool has_prior() const { return data_ != nullptr; }

  // All samples; of an objective that others were added to, a copy of them is made and kept.
  const BrdfSamples& samples() const;
  int num_samples() const;
  bool on_grid() const;
  // Samples that were added, or null.
  const BrdfSamples* added() const;
  const ModelSpec& spec() const { return spec_; }
  const Weighting& weighting() const;
  int num_threads() const { return num_threads_; }

  // E of a model; all traces and tables quote this value. The same bits for any number of threads.
  // Throws Error for a model of another spec.
  double Value(const FactorModel& model) const;

  // sum w rho*^2: E of the black model, to which E is compared.
  double MeasuredEnergy() const;

  // The part of E that no model can reduce: differences between samples with the same model value,
  // such as the two orders of a direction pair. Mostly the measurement's deviation from
  // reciprocity.
  double IrreducibleEnergy() const;

  // Total weight sum w |stencil weight| of the samples that read each parameter, in the order of
  // FactorModel::parameters(). 0 marks an unobserved entry, which is not fitted
  // (docs/stored-model.md).
  const std::vector<double>& coverage() const { return coverage_; }

  // One sample with its stencils. Throws Error if there is no such sample.
  WeightedSample Sample(int j) const;

  // Same as the functions of these names on all samples, without copying these; numbers ascend.
  BrdfSamples Selected(std::vector<int> numbers) const;
  BrdfSamples Thinned(int stride) const;
  BrdfSamples EvenlySpread(int count) const;

  // The same objective with a copy of the samples, for those whose samples are about to end.
  Objective WithOwnSamples() const;

  // Forgets the folded samples of this objective and of all that share them, if they are scattered,
  // which frees their memory as soon as nobody uses them. They are made again where they are asked
  // for.
  void ReleaseFold() const;

  // All samples with stencils. Computed at the first call (280 bytes per sample).
  const std::vector<WeightedSample>& weighted_samples() const;

  // The samples folded by symmetry. Null if they are scattered or fall between table bins: with a
  // stretched D, or with tables of other bins than the grid's.
  const FoldedGrid* folded() const;

  // The same for all other samples; null if folded() is not. Hold it while you use it.
  std::shared_ptr<const FoldedSamples> folded_samples() const;

  // The folded samples by knot intervals of G. Computed at the first call (64 bytes per sample).
  // Throws Error if folded() is null.
  const SplineCells& spline_cells() const;

 private:
  struct Prepared;  // depends on the spec's axes and stretch only

  std::shared_ptr<const Prepared> prepared_;
  ModelSpec spec_;
  int num_threads_;
  std::vector<double> coverage_;
  std::shared_ptr<const Objective> data_;  // null without a prior
};

// Samples for the next pass of iteratively reweighted least squares, for a loss that grows linearly
// with the error e beyond `delta`: samples with e > delta have their multiplicity multiplied by
// delta / e (Huber 1964). e is the error as the weighting measures it, root mean square over the
// channels: relative for weights relative to the value, in units of the level if the weighting uses
// it. Up to a constant, E of the result is an upper bound of the loss that touches it at `model`,
// so lowering E lowers the loss (Hunter and Lange 2004). Throws Error unless delta > 0 and the
// specs are equal.
BrdfSamples Reweighted(const Objective& objective, const FactorModel& model, double delta);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_OBJECTIVE_H_
