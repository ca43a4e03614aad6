#ifndef TRILOBE_MODEL_APPEARANCE_HARDLY_SEEN_H_
#define TRILOBE_MODEL_APPEARANCE_HARDLY_SEEN_H_

#include <vector>

#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// The share of the light of a sphere, lit evenly from all around, that HardlySeen leaves out.
inline constexpr double kHardlySeen = 0.003;

// The bins of theta_h and theta_d that an eye hardly sees: those of the least light for their solid
// angle, mean rho cos theta_i cos theta_o, that together have at most kHardlySeen of the light of
// all. Black there, a material still cannot be told apart from itself. rho is the luminance of the
// measurement or of the fit, whichever is more. Bins without a valid phi_d are not among them. The
// grids must be the same. web/measured.js has the same for the page. [theta_h * theta_d]
std::vector<bool> HardlySeen(const BrdfTable& measured, const BrdfTable& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_HARDLY_SEEN_H_
