#ifndef TRILOBE_MODEL_LOBES_GAUGE_H_
#define TRILOBE_MODEL_LOBES_GAUGE_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Scale can move between s, D, F and G without changing any BRDF value, and lobes can change
// places. The canonical form, in which models are stored, fixes both by what a lobe reflects of
// light that comes from everywhere alike (LobeLight), so that entries that hardly any light goes
// through have no say (docs/stored-model.md):
// - each D integrates to 1 over the solid angle of half vectors, weighted by how much of the
//   directions there is above the surface (VisibleSolidAngles); over the projected solid angle
//   where the model is anisotropic;
// - each F and each G has the scale by which the lobes and channels that read it reflect, in their
//   sum, 4 s; all tables of F that read a G together have the geometric mean 1, weighted by the
//   light that goes through their entries;
// - a table that is 0 everywhere becomes a constant, and s of its lobes 0. Where no light goes
//   through an F or G, its geometric mean over all entries that are not 0 is 1;
// - the lobe that reflects most comes first; but lobes that are stretched differently stay in their
//   places.
// Entries that no data touch are filled first, as ContinueBeyondData says. `coverage` is
// Objective::coverage(), in the order of model->parameters(), of which no more counts than whether
// it is above 0; these functions throw Error if it has another size. A model in canonical form
// stays the same to the bit. The same bits for any number of threads.
enum class LobeOrder { kByLight, kAsTheyAre };
void Canonicalize(std::span<const double> coverage, FactorModel* model,
                  LobeOrder order = LobeOrder::kByLight, int num_threads = 1);

// The scale alone: lobes keep their places, and entries that no data touch what they say.
void SetCanonicalScale(std::span<const double> coverage, FactorModel* model, int num_threads = 1);

// A scale for work inside a fit, which compares models of one run: cheaper, as F and G have the
// mean 1 weighted by coverage, and D by the projected solid angle; lobes keep their places.
void NormalizeScale(std::span<const double> coverage, FactorModel* model);

// Integral of D over the projected hemisphere, D constant in each bin, or in the cell of each node.
double ProjectedIntegral(const Axis& axis, std::span<const double> D);

// Makes the parameters of `to` that no data touch those of `from`, a model of the same spec.
void CopyUnobservedParameters(std::span<const double> coverage, const FactorModel& from,
                              FactorModel* target);

// True for the table entries that no data touch, in the order of parameters().
std::vector<bool> UnobservedParameters(std::span<const double> coverage);

// A coverage that says no more than that: 0 for the unobserved, 1 for the others.
std::vector<double> ObservedEntries(const std::vector<bool>& unobserved);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_GAUGE_H_
