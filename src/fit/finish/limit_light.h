#ifndef TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_
#define TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_

#include <optional>

#include "fit/finish/albedo_limit.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Limit of the light that a model of the data may reflect, isotropic or not (LimitAlbedo,
// LimitAnisotropicAlbedo).
class LightLimit {
 public:
  // `fit`: of the data, which says what scattered samples reflect.
  LightLimit(const Objective& data, const FactorModel& fit);

  const Rgb& everywhere() const { return everywhere_; }

  // Lowers G until the model keeps to the limit; whether anything changed. The model is of the
  // fit's kind, of any lobes and sharing.
  bool Apply(const TableLayout& layout, const StopCheck& stop, FactorModel* model) const;

  // The same of an isotropic model beyond the data, and at angles up to `within` before their end
  // [rad], where few samples read G. Does nothing to an anisotropic one, or where nothing is
  // beyond.
  bool ApplyAtEnd(double within, const TableLayout& layout, const StopCheck& stop,
                  FactorModel* model) const;

 private:
  int num_threads_;
  std::optional<AlbedoLimits> isotropic_;
  Rgb everywhere_;
};

// The largest directional albedo of a model, isotropic or not.
PeakAlbedo PeakLight(const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_LIMIT_LIGHT_H_
