#include "fit/reports/appearance_report.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "fit/reports/print.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// The mean log error, or a dash where there is no point.
std::string LogError(const PointErrors& errors) {
  return errors.points > 0 ? Text(errors.log, 3) : "-";
}

Json ToJson(const PointErrors& errors) {
  if (errors.points == 0) return nullptr;
  return {{"mean_log_error", errors.log}, {"mean_relative_error", errors.relative}};
}

}  // namespace

std::string Describe(const AppearanceReport& report) {
  const SphereError& sphere = report.sphere;
  std::string text = "appearance   sphere in " + Printable(report.environment) + ": PSNR " +
                     Text(sphere.psnr_db) + " dB (peak 1, mean luminance " + Text(kMeanLuminance) +
                     ", sRGB curve, clipped), CIELAB difference " + Text(sphere.mean_delta_e, 3) +
                     " mean, " + Text(sphere.delta_e_95, 3) + " at 95 %, mean colour off by " +
                     Text(100 * sphere.mean_color_error, 2) + " %\n" +
                     "             albedo off by " + Text(report.albedo.mean, 2) + " mean, " +
                     Text(report.albedo.max, 2) + " at most; mean log error " +
                     LogError(report.at_centers) + " at " +
                     (report.at_nodes ? "nodes" : "bin centres") + ", " +
                     LogError(report.between_centers) + " between them\n";
  if (report.from_formula) {
    text += "             from the material's own formula, which was measured: PSNR " +
            Text(report.from_formula->fitted.psnr_db) + " dB; of the measurement, interpolated, " +
            Text(report.from_formula->measured.psnr_db) + " dB\n";
  }
  if (report.beyond) {
    const BeyondData& beyond = *report.beyond;
    text += "             beyond the data (" + Text(100 * beyond.share, 2) +
            " % of the bins above the surface) rho cos is at most " + Text(beyond.largest, 3) +
            " /sr, within at most " + Text(beyond.largest_within, 3) + "; the whole sphere PSNR " +
            Text(beyond.psnr_db) + " dB\n";
  }
  return text;
}

std::string DescribeBriefly(const AppearanceReport& report) {
  std::string text =
      "colour       mean colour off by " + Text(100 * report.sphere.mean_color_error, 2) +
      " %, the share of light that is reflected (albedo) by " + Text(report.albedo.mean, 2) + "\n";
  if (report.beyond) {
    text += "not measured " + Text(100 * report.beyond->share, 2) +
            " % of the directions; what the model shows there is a guess\n";
  }
  return text;
}

Json ToJson(const AppearanceReport& report) {
  const SphereError& sphere = report.sphere;
  Json albedo = Json::array();
  for (size_t k = 0; k < report.albedo.theta_i.size(); ++k) {
    Json angles = {{"theta_i_deg", RadiansToDegrees(report.albedo.theta_i[k])}};
    if (report.at_nodes) angles["phi_i_deg"] = RadiansToDegrees(report.albedo.phi_i[k]);
    angles.update({{"measured", report.albedo.measured[k]}, {"fitted", report.albedo.fitted[k]}});
    albedo.push_back(std::move(angles));
  }
  Json from_formula;
  if (report.from_formula) {
    const auto sphere_error = [](const SphereError& error) -> Json {
      return {{"psnr_db", error.psnr_db}, {"mean_delta_e", error.mean_delta_e}};
    };
    from_formula = {{"fitted", sphere_error(report.from_formula->fitted)},
                    {"measured", sphere_error(report.from_formula->measured)},
                    {"whole", sphere_error(report.from_formula->whole)}};
  }
  Json beyond;
  if (report.beyond) {
    beyond = {{"share", report.beyond->share},
              {"largest", report.beyond->largest},
              {"largest_within", report.beyond->largest_within},
              {"psnr_db", report.beyond->psnr_db}};
  }
  return {
      {"environment", report.environment},
      {"lights", report.lights},
      {"size", report.size},
      {"mean_luminance", kMeanLuminance},
      {"psnr_db", sphere.psnr_db},
      {"psnr_peak", 1},
      {"exposure", sphere.exposure},
      {"mean_delta_e", sphere.mean_delta_e},
      {"delta_e_95", sphere.delta_e_95},
      {"mean_color_error", sphere.mean_color_error},
      {"albedo",
       {{"mean_error", report.albedo.mean}, {"max_error", report.albedo.max}, {"values", albedo}}},
      {"at_centers", ToJson(report.at_centers)},
      {"between_centers", ToJson(report.between_centers)},
      {"from_formula", from_formula},
      {"beyond", beyond}};
}

}  // namespace trilobe
