#ifndef TRILOBE_MODEL_LOBES_LOBE_LIGHT_H_
#define TRILOBE_MODEL_LOBES_LOBE_LIGHT_H_

#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// What the parts of a model reflect of light that comes from everywhere alike, over the directions
// that read no unobserved entry. These figures do not depend on the gauge, but for `through`.
struct LobeLight {
  // Bihemispherical albedo, integral of rho cos theta_i cos theta_o d omega_i d omega_o / pi, of
  // the diffuse term and of each lobe. [lobes]
  Rgb diffuse{};
  std::vector<Rgb> lobes;

  // The light that goes through each entry of a table, a spline's shared out by its weights; 0 for
  // d and s. In the order of FactorModel::parameters(): those of a table of D or F have the sum of
  // the albedos of the lobes and channels that it serves.
  std::vector<double> through;

  // The part of all that the model reflects, mean over the channels, that a lobe does; 0 where the
  // model is black. Throws Error if there is no such lobe.
  double Share(int lobe) const;
  double DiffuseShare() const;
};

// `coverage` (Objective::coverage(), or no more than > 0 for observed and 0 for unobserved entries)
// is in the order of model.parameters(). The same bits for any number of threads.
LobeLight ComputeLobeLight(std::span<const double> coverage, const FactorModel& model,
                           int num_threads = 1);

// How much of the directions with a half vector in each bin of theta_h lies above the surface,
// times the solid angle of the bin: 2 pi sin theta_h dtheta_h v(theta_h), v(0) = 1. What a D
// reflects in the bin is in proportion to it. [bins]
std::vector<double> VisibleSolidAngles(int bins);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_LOBE_LIGHT_H_
