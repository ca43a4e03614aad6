#include "fit/finish/limit_light.h"

#include "fit/finish/anisotropic_albedo.h"
#include "trilobe/model/axis.h"

namespace trilobe {

LightLimit::LightLimit(const Objective& data, const FactorModel& fit)
    : num_threads_(data.num_threads()) {
  if (fit.spec().anisotropic()) {
    everywhere_ = AnisotropicAlbedoLimit(data, fit);
  } else {
    isotropic_ = AlbedoLimitsOf(data, fit);
    everywhere_ = isotropic_->everywhere;
  }
}

bool LightLimit::Apply(const TableLayout& layout, const StopCheck& stop, FactorModel* model) const {
  return isotropic_ ? LimitAlbedo(*isotropic_, kAllAngles, layout, num_threads_, stop, model)
                    : LimitAnisotropicAlbedo(everywhere_, layout, num_threads_, stop, model);
}

bool LightLimit::ApplyAtEnd(double within, const TableLayout& layout, const StopCheck& stop,
                            FactorModel* model) const {
  const Axis& g_axis = model->spec().g_axis;
  if (!isotropic_ || !(isotropic_->beyond_theta < g_axis.Theta(g_axis.size - 1))) return false;
  return LimitAlbedo(*isotropic_, isotropic_->beyond_theta - within, layout, num_threads_, stop,
                     model);
}

PeakAlbedo PeakLight(const FactorModel& model, int num_threads) {
  return model.spec().anisotropic() ? PeakAnisotropicAlbedo(model, num_threads)
                                    : PeakAlbedoOf(model, num_threads);
}

}  // namespace trilobe
