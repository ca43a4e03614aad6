#include "fit/prior_of.h"

#include "model/appearance/picture_data.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/form.h"

namespace trilobe {

double PriorWeight(const Measurement& measurement, const FitOptions& options) {
  if (measurement.table) {
    if (options.prior) {
      throw ErrorIn(ErrorKind::kUnsupported, measurement.source,
                    "--prior is for scattered samples, and a " + measurement.kind + " is a table")
          .About("prior");
    }
    return 0;
  }
  return options.prior.value_or(options.form.kind == FormOptions::Kind::kAnisotropic ? 0 : 1);
}

std::optional<SyntheticPrior> PriorOf(const Measurement& measurement, const FitOptions& options,
                                      const Objective& data) {
  const double weight = PriorWeight(measurement, options);
  if (!(weight > 0)) return std::nullopt;
  SyntheticPriorOptions prior{
      .weight = weight, .isotropic = !measurement.anisotropic, .stop = options.stop};
  // A model that cannot follow the data had better follow the prior as it is.
  if (data.spec().anisotropic()) prior.grid = GridOf(measurement);
  return SyntheticPrior(data, prior);
}

Objective JoinPrior(const Objective& data, const std::optional<SyntheticPrior>& prior) {
  return prior ? prior->Join(data) : data;
}

}  // namespace trilobe
