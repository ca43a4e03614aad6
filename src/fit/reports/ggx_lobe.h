#ifndef TRILOBE_FIT_REPORTS_GGX_LOBE_H_
#define TRILOBE_FIT_REPORTS_GGX_LOBE_H_

#include <optional>
#include <string>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The GGX lobe (Walter et al. 2007) that is most like a lobe of a model.
struct GgxLobe {
  // Of its distribution along a direction `turn` [rad] from x, and across it; of an isotropic model
  // both are equal. Roughness in engines is the square root.
  double alpha_x = 1, alpha_y = 1, turn = 0;
  // F at normal incidence with which it reflects as much light from the normal, by Schlick's F and
  // the height-correlated Smith term. Above 1 where no such lobe does.
  Rgb f0{};
  // The share of the lobe's facets, D cos theta_h, that stand elsewhere in GGX: 0 to 1.
  double elsewhere = 0;
};

// Finds it by Ceres: the least integral of (sqrt D - sqrt GGX)^2 cos theta_h, both of one facet
// area, with D the mean of the channels as it is at theta_d = 0. Nothing for a lobe without facets
// or strength; F0 is 0 where it reflects nothing along the normal.
std::optional<GgxLobe> NearestGgx(const FactorModel& model, int lobe);

// "alpha 0.15 (roughness 0.387), F0 0.95, 0.64, 0.54; 3.1 % of its facets stand elsewhere".
std::string GgxText(const GgxLobe& lobe);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_GGX_LOBE_H_
