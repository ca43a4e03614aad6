#ifndef TRILOBE_FIT_FINISH_FACTORED_ALBEDOS_H_
#define TRILOBE_FIT_FINISH_FACTORED_ALBEDOS_H_

#include <cstddef>
#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// Directional albedos of isotropic models that have D in common. With the rule of
// DirectionalAlbedo, of weights w, a lobe of s, F and G reflects of the light from theta_i
//   s G(theta_i) sum_k sum_l F_k G_l T_kl,
//   T_kl = sum over wo of w D(theta_h) [F_k](theta_d) [G_l](theta_o) / (cos theta_i cos theta_o),
// where [F_k] and [G_l] are the weights of entries in lookups. T is summed once; each model takes a
// thousandth of an evaluation for each wo.
class FactoredAlbedos {
 public:
  // For models with the spec and the D of this one, at angles [rad]. The same bits for any number
  // of threads.
  FactoredAlbedos(const FactorModel& model, std::span<const double> theta_i, int num_threads);

  // Those at the angles from number `first` on: but for rounding, AlbedosOf.
  std::vector<Rgb> operator()(const FactorModel& model, size_t first = 0) const;

 private:
  struct AtAngle {
    double weight = 0;      // of all wo: of the diffuse term
    Stencil G_i;            // at theta_i
    std::vector<double> T;  // [lobes, channels that D has, f_axis.size, g_axis.size]
  };

  AtAngle SumAt(const FactorModel& model, double theta_i) const;

  int num_threads_, channels_of_d_;
  std::vector<AtAngle> at_;  // [theta_i.size()]
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_FACTORED_ALBEDOS_H_
