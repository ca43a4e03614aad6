#ifndef TRILOBE_FIT_FINISH_REFLECTANCE_H_
#define TRILOBE_FIT_FINISH_REFLECTANCE_H_

#include <memory>
#include <optional>

#include "solvers/joint/log_stepper.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Mean of rho over the samples, weighted by cos theta_i cos theta_o and their solid angle [1/sr],
// by channel (MeanReflectance), from some 65,000 evenly spread samples. If all directions were
// measured, it is the bihemispherical reflectance (Nicodemus et al. 1977) over pi.
struct Reflectance {
  Rgb measured{}, fitted{};

  // |fitted - measured| / |measured| over the channels: the colour error under a uniform sky. 0 if
  // nothing is reflected.
  double Error() const;
  // Whether the error exceeds 1 %; less is not visible.
  bool IsOff() const { return Error() > 0.01; }
};
Reflectance ReflectanceOf(const Objective& objective, const FactorModel& model);

class SampledLight;

// The term price |fitted - target|^2 / |target|^2, which keeps the reflectance while steps minimise
// something else.
class ReflectancePrice : public AddedTerm {
 public:
  // The target is the reflectance of `model`.
  ReflectancePrice(const Objective& objective, const FactorModel& model, double price);
  ~ReflectancePrice() override;

  double operator()(const FactorModel& model) const override;
  // Adds value and derivatives, the second ones by Gauss-Newton.
  void AddTo(const FactorModel& model, QuadraticModel* at) const override;

 private:
  const std::unique_ptr<const SampledLight> light_;
  Rgb target_{};
  const double price_;
};

// Corrects the reflectance of a fit. A relative E hardly depends on the light of a narrow
// highlight: a fit that cannot follow it ends near the geometric mean, and the surface is too dark.
// Damped Gauss-Newton steps in the parameters that `layout` stores minimise
//   E + price E0 |fitted - measured|^2 / |measured|^2,
// with E0 the E of the fit; for a price of 30, an error of 1 % costs 0.3 % of E. Returns nothing if
// the reflectance is not off or no step lowers this. E0 and the reflectance are of `objective`, E
// is of `minimised`: the same objective, or one with additional samples that hold the model.
// Scattered samples count equally, since their solid angles are unknown. `stop` ends the steps. The
// same bits for any number of threads. Throws Error for a model, layout or objective of another
// spec.
struct MatchedModel {
  FactorModel model;
  double error_before, error_after;  // Reflectance::Error of the fit and of `model`
};
std::optional<MatchedModel> MatchReflectance(const Objective& objective, const Objective& minimised,
                                             const FactorModel& model, const TableLayout& layout,
                                             double price, const StopCheck& stop = {});

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_REFLECTANCE_H_
