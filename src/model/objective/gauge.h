#ifndef TRILOBE_MODEL_OBJECTIVE_GAUGE_H_
#define TRILOBE_MODEL_OBJECTIVE_GAUGE_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Scale can move between s, D, F and G, and lobes can be reordered, without changing any BRDF
// value. The canonical form, in which models are stored, fixes both by the light that lobes reflect
// under uniform illumination (LobeLight), so entries with little light have no influence
// (docs/file-formats.md):
// - Each D integrates to 1 over the solid angle of half vectors, weighted by the fraction of
//   directions above the surface (VisibleSolidAngles); in anisotropic models, over the projected
//   solid angle.
// - Each F and each G is scaled so that the lobes and channels that read it reflect, summed, 4 s.
//   The tables of F that are read with the same G have the joint geometric mean 1, weighted by
//   light.
// - A table of zeros becomes constant, and s of its lobes 0. An F or G without light has geometric
//   mean 1 over its nonzero entries.
// - Lobes are in descending order of reflected light; lobes with different stretches keep their
//   places.
// Unobserved entries are filled first (ContinueBeyondData). `coverage` is Objective::coverage(), in
// the order of model->parameters(); only whether it is > 0 matters. These functions throw Error if
// its size differs. A model in canonical form is unchanged to the bit. The same bits for any number
// of threads.
enum class LobeOrder { kByLight, kAsTheyAre };
void Canonicalize(std::span<const double> coverage, FactorModel* model,
                  LobeOrder order = LobeOrder::kByLight, int num_threads = 1);

// The scale only: lobes keep their places, and unobserved entries are not filled.
void SetCanonicalScale(std::span<const double> coverage, FactorModel* model, int num_threads = 1);

// A cheaper scale for use inside a fit: F and G have mean 1 weighted by coverage, and D integrates
// to 1 over the projected solid angle. Lobes keep their places.
void NormalizeScale(std::span<const double> coverage, FactorModel* model);

// Projected solid angle of each entry of a table. [axis.size]
std::vector<double> ProjectedAngles(const Axis& axis);

// Integral of D over the projected hemisphere; D is constant in each bin or node's cell.
double ProjectedIntegral(const Axis& axis, std::span<const double> D);

// Copies the unobserved parameters of `from`, a model of the same spec, to `target`.
void CopyUnobservedParameters(std::span<const double> coverage, const FactorModel& from,
                              FactorModel* target);

// True for unobserved table entries, in the order of parameters().
std::vector<bool> UnobservedParameters(std::span<const double> coverage);

// A coverage of 0 for unobserved and 1 for observed entries.
std::vector<double> ObservedEntries(const std::vector<bool>& unobserved);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_GAUGE_H_
