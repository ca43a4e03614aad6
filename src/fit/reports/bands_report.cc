#include "fit/reports/bands_report.h"

#include <nlohmann/json.hpp>

#include "fit/reports/print.h"

namespace trilobe {
namespace {

std::string Percent(double share) { return Text(100 * share, 3) + " %"; }

}  // namespace

std::string Describe(const BandsFit& bands, const std::optional<SeenError>& seen) {
  const int count = bands.model.bands();
  int worst = 0;
  double sum = 0;
  for (int l = 0; l < count; ++l) {
    sum += bands.Relative(l);
    if (bands.Relative(l) > bands.Relative(worst)) worst = l;
  }
  std::string text = WavelengthsText(bands.model) + ", by " +
                     std::to_string(bands.model.num_parameters()) + " parameters: E is " +
                     Percent(sum / count) + " of a black model's";
  if (count == 1) return text;
  text += " in the mean, at most " + Percent(bands.Relative(worst)) + ", at " +
          Text(bands.model.wavelengths()[worst]) + " nm";
  if (seen) text += "; colours of samples are off by Delta E " + Text(seen->mean_delta_e, 2);
  return text;
}

nlohmann::ordered_json ToJson(const BandsFit& bands, const std::optional<SeenError>& seen) {
  using Json = nlohmann::ordered_json;
  Json relative = Json::array();
  for (int l = 0; l < bands.model.bands(); ++l) relative.push_back(bands.Relative(l));
  return {{"wavelengths", bands.model.wavelengths()},
          {"parameters", bands.model.num_parameters()},
          {"objective", bands.objective},
          {"relative_objective", relative},
          {"mean_delta_e", seen && bands.model.bands() > 1 ? Json(seen->mean_delta_e) : Json()}};
}

}  // namespace trilobe
