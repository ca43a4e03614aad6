#ifndef TRILOBE_FIT_FINISH_REFLECTANCE_H_
#define TRILOBE_FIT_FINISH_REFLECTANCE_H_

#include <memory>
#include <optional>

#include "solvers/smooth/log_stepper.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// How much light the measured directions send into each other, under light from all of them: the
// mean of rho over samples, weighted by cos theta_i cos theta_o and their solid angle [1/sr], as
// MeanReflectance has it, by channel. Some 65,000 samples, evenly spread, stand for all. The
// bihemispherical reflectance (Nicodemus et al. 1977) over pi, where all directions were measured.
struct Reflectance {
  Rgb measured{}, fitted{};

  // |fitted - measured| / |measured| over the channels, as one sees by how much the colour of a
  // surface is off under a grey sky; 0 where nothing is reflected.
  double Error() const;
  // By more than 1 %; less is not seen.
  bool IsOff() const { return Error() > 0.01; }
};
Reflectance ReflectanceOf(const Objective& objective, const FactorModel& model);

class SampledLight;

// price |fitted - target|^2 / |target|^2, to be minimised beside E, so that steps that care for
// something else keep the light.
class ReflectancePrice : public AddedTerm {
 public:
  // The target: what `model` reflects.
  ReflectancePrice(const Objective& objective, const FactorModel& model, double price);
  ~ReflectancePrice() override;

  double operator()(const FactorModel& model) const override;
  // Gauss-Newton.
  void AddTo(const FactorModel& model, QuadraticModel* at) const override;

 private:
  const std::unique_ptr<const SampledLight> light_;
  Rgb target_{};
  const double price_;
};

// E of values relative to what was measured hardly sees the light of a narrow highlight: a fit that
// cannot follow it ends near the geometric mean of what it should be, and the whole surface is
// too dark. This moves a fit, where its Reflectance is off, towards the minimum of
//   E + price E0 |fitted - measured|^2 / |measured|^2,
// E0 being E of the fit: with a price of 30 an error of 1 % costs 0.3 % of E. By damped
// Gauss-Newton steps in the parameters that `layout` stores, all of them moving a little, each
// where E minds it least. Nothing if it is not off, or if none of the steps lowers that. E0 and
// what is reflected are those of `objective`, E that of `minimised`: the same, or one with samples
// besides that say where the model is to stay. Solid angles of scattered samples are not known; all
// count alike. `stop` is asked before each step. The same bits for any number of threads. Throws
// Error for a model, a layout or an objective of another spec.
struct MatchedModel {
  FactorModel model;
  double error_before, error_after;  // Reflectance::Error of the fit, and of this
};
std::optional<MatchedModel> MatchReflectance(const Objective& objective, const Objective& minimised,
                                             const FactorModel& model, const TableLayout& layout,
                                             double price, const StopCheck& stop = {});

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_REFLECTANCE_H_
