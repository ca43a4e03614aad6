#ifndef TRILOBE_MODEL_OBJECTIVE_LOBE_LIGHT_H_
#define TRILOBE_MODEL_OBJECTIVE_LOBE_LIGHT_H_

#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The share of uniform incident light that each part of a model reflects, over the directions that
// read no unobserved entry. Independent of the gauge, except `through`.
struct LobeLight {
  // Bihemispherical albedo, integral of rho cos theta_i cos theta_o d omega_i d omega_o / pi, of
  // the diffuse term and of each lobe. [lobes]
  Rgb diffuse{};
  std::vector<Rgb> lobes;

  // Whether a lobe reflects about alike in all directions, as the diffuse term does: for theta_h
  // and theta up to 60 degrees, D is flat within a factor of 2 and G/cos theta within 1.5, in each
  // channel. A fit may put the diffuse base of a material there. [lobes]
  std::vector<bool> nearly_diffuse;

  // The reflected light by table entry, in the order of FactorModel::parameters(); spline weights
  // divide it among entries, and d and s have 0. The sum over a table of D or F is the sum of the
  // albedos of its lobes and channels.
  std::vector<double> through;

  // A lobe's fraction of all reflected light, averaged over the channels; 0 for a black model.
  // Throws Error if there is no such lobe.
  double Share(int lobe) const;
  double DiffuseShare() const;
};

// `coverage`, in the order of model.parameters(), is Objective::coverage(); only whether a value is
// > 0 (observed) matters. The same bits for any number of threads.
LobeLight ComputeLobeLight(std::span<const double> coverage, const FactorModel& model,
                           int num_threads = 1);

// For each bin of theta_h, its solid angle times the fraction of directions with that half vector
// that are above the surface: 2 pi sin theta_h dtheta_h v(theta_h), v(0) = 1. The light that D
// reflects in the bin is proportional to it. [bins]
std::vector<double> VisibleSolidAngles(int bins);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_LOBE_LIGHT_H_
