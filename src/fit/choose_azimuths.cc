#include "fit/choose_azimuths.h"

#include <optional>
#include <utility>

#include "fit/azimuths.h"
#include "trilobe/fit/fit.h"

namespace trilobe {

Measurement WithAzimuthsChosen(Measurement measurement, const FitOptions& options) {
  if (!ChoosesAzimuths(measurement, options)) return measurement;
  const AzimuthChoice choice = ChooseAzimuths(
      measurement, options,
      [](const Measurement& data, const FitOptions& by) -> std::optional<FactorModel> {
        FitResult fit = Fit(data, by);
        if (fit.interrupted) return {};
        return std::move(fit.file.model);
      });
  measurement.anisotropic = measurement.azimuths_matter = choice.matter;
  measurement.notes.push_back((choice.matter ? "anisotropic: " : "isotropic: ") + choice.why);
  return measurement;
}

}  // namespace trilobe
