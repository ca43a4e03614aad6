#ifndef TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_
#define TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_

#include <optional>
#include <vector>

#include "fit/finish/albedo_limit.h"
#include "fit/finish/light_bounds.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// How much light a model of the data may reflect: 1, or what was measured where that is more
// (AlbedoLimitsOf, LimitByShown), at each half degree of theta and each 5 degrees of azimuth. One
// promise for any model: isotropic or not, of tables, samples or forms, and for scenes, but for
// pruned models of those that read some directions alone.
class LightLimit {
 public:
  // `fit`: of the data, which says what scattered samples reflect.
  LightLimit(const Objective& data, const FactorModel& fit);

  const Rgb& everywhere() const { return everywhere_; }

  // Lowers G until the model keeps to the limit; whether anything changed. The model is of the
  // fit's kind, of any lobes and sharing. Quick; E may rise much.
  bool Lower(const TableLayout& layout, const StopCheck& stop, FactorModel* model) const;

  // The same for angles at which it exceeds the limit alone.
  bool LowerWhereExceeded(const TableLayout& layout, const StopCheck& stop,
                          FactorModel* model) const;

  // Changes as little as it takes for the model to keep to the limit; whether anything changed.
  // First G is lowered: of all angles or, where E of `data` would rise by more than 5 % and by more
  // than a thousandth of a black model's, of the last degrees of the data and beyond. Where that is
  // not enough or dear (5 % and 1e-5 of that energy, of an anisotropic model 1e-4), the model is
  // refitted under the limit (RefitWithinBounds), so that what no sample reads gives way, and of
  // what they read no more than it takes. An isotropic model that glows beyond the data, where more
  // light comes back than goes on from within (AlbedoLimits::beyond), is refitted as well, and that
  // is kept where it is not dear.
  bool Keep(const Objective& data, const TableLayout& layout, const StopCheck& stop,
            FactorModel* model) const;

  // Angles at which it exceeds the limit.
  std::vector<LightBound> Exceeded(const FactorModel& model) const;

 private:
  bool LowerCoarsely(const TableLayout& layout, const StopCheck& stop, FactorModel* model) const;
  bool LowerAtEnd(double within, const TableLayout& layout, const StopCheck& stop,
                  FactorModel* model) const;
  bool GlowsBeyond(const FactorModel& model) const;
  FactorModel LoweredWhereCheap(const Objective& data, const TableLayout& layout,
                                const StopCheck& stop, const FactorModel& before) const;
  FactorModel Refitted(const Objective& data, const TableLayout& layout, const StopCheck& stop,
                       const FactorModel& before) const;

  int num_threads_;
  std::optional<AlbedoLimits> isotropic_;
  Rgb everywhere_;
};

// Gives an anisotropic model whose G ends at 75 degrees rings towards the horizon, with the same
// values, where it exceeds the limit beyond: there are no entries yet that could be lower. Whether
// it did so. The objective follows.
bool ReachHorizonToLimit(const LightLimit& limit, Objective* objective, FactorModel* model);

// The largest directional albedo of a model, isotropic or not.
PeakAlbedo PeakLight(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_
