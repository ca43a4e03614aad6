#include "fit/reports/score_report.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "fit/reports/appearance_report.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/merl_grid.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// Place of a sample's bin along each axis.
struct BinPosition {
  int h, d, p;
};
BinPosition PositionOf(const MerlGrid& grid, int bin) {
  return {bin / (grid.theta_d * grid.phi_d), bin / grid.phi_d % grid.theta_d, bin % grid.phi_d};
}

}  // namespace

nlohmann::ordered_json ToJson(const Scored& scored, const Objective& objective) {
  const BrdfSamples& samples = objective.samples();
  const ScoreReport& report = scored.score;
  const std::optional<AppearanceReport>& appearance = scored.appearance;
  Json json = {{"verdict", ToJson(scored.verdict)},
               {"model", scored.model},
               {"source", samples.source},
               {"weighting", objective.weighting().name},
               {"valid_samples", report.valid_samples},
               {"objective", report.objective},
               {"relative_objective", report.relative_objective},
               {"irreducible_objective", report.irreducible_objective},
               {"psnr_db", report.psnr_db},
               {"psnr_peak", report.psnr_peak},
               {"rmse", report.rmse},
               {"rmse_red", report.rmse_channel[0]},
               {"rmse_green", report.rmse_channel[1]},
               {"rmse_blue", report.rmse_channel[2]},
               {"mean_relative_error", report.mean_relative_error},
               {"mean_log_error", report.mean_log_error},
               {"max_absolute_error", report.max_absolute_error},
               {"appearance", appearance ? ToJson(*appearance) : Json()},
               {"worst_bins", Json::array()}};
  for (const WorstSample& worst : report.worst) {
    Json place = Json::object();  // of a bin
    if (samples.on_grid()) {
      const auto [h, d, p] = PositionOf(samples.grid, samples.bins[worst.sample]);
      place = {{"h", h}, {"d", d}, {"p", p}};
    }
    place.update({{"theta_h_deg", RadiansToDegrees(worst.angles.theta_h)},
                  {"theta_d_deg", RadiansToDegrees(worst.angles.theta_d)},
                  {"phi_d_deg", RadiansToDegrees(worst.angles.phi_d)}});
    if (!samples.directions.empty()) {
      const SphericalAngles& at = samples.directions[worst.sample];
      place.update({{"theta_i_deg", RadiansToDegrees(at.theta_i)},
                    {"phi_i_deg", RadiansToDegrees(at.phi_i)},
                    {"theta_o_deg", RadiansToDegrees(at.theta_o)},
                    {"phi_o_deg", RadiansToDegrees(at.phi_o)}});
    }
    place.update({{"channel", kChannelNames[worst.channel]},
                  {"measured", worst.measured},
                  {"fitted", worst.fitted},
                  {"weighted_squared_error", worst.error}});
    json["worst_bins"].push_back(std::move(place));
  }
  return json;
}

}  // namespace trilobe
