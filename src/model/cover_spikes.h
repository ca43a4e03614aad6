#ifndef TRILOBE_MODEL_COVER_SPIKES_H_
#define TRILOBE_MODEL_COVER_SPIKES_H_

#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {

// Minimum probability of the cosine in sampling, as a fraction of the lobes' light, so that
// directions missed by the table's nodes are still sampled.
inline constexpr double kCosineShare = 0.01;

// Raises a table of half vectors where the model has spikes between its nodes, as little as is
// needed, so that no sample has a large weight up to 85 degrees. F and G of a fit may differ by
// decades from one entry, a degree apart, to the next, and near grazing a stretched highlight is a
// narrow ridge along theta_o = theta_i; a table that is fine enough for these would be large. For
// isotropic models.
//
// `values` [theta_i][y][s]: the densities over y and s that the lobes reflect, averaged over the
// channels. `diffuse`: the albedo of the diffuse term. Returns whether all is covered; otherwise
// too much light would be added, and the table needs more nodes of s.
bool CoverSpikes(const FactorModel& model, double diffuse, const HalfVectorNodes& nodes,
                 std::vector<float>* values);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_COVER_SPIKES_H_
