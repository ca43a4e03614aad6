#include "fit/reports/bin_counts.h"

#include <nlohmann/json.hpp>

namespace trilobe {

std::vector<LeftOut> ReasonsOf(const BinCounts& counts) {
  return {{"below the surface", "below_surface", counts.below_surface},
          {"NaN or infinite", "non_finite", counts.non_finite},
          {"lost (negative)", "negative", counts.negative},
          {"without a value", "missing", counts.missing},
          {"extrapolated by authors", "extrapolated", counts.extrapolated},
          {"beyond the last theta_i", "beyond_nodes", counts.beyond_nodes},
          {"beyond --max_angle", "beyond_max_angle", counts.beyond_max_angle},
          {"below --min_theta_d", "below_min_theta_d", counts.below_min_theta_d}};
}

std::string LeftOutText(const BinCounts& counts) {
  std::string text;
  for (const LeftOut& left_out : ReasonsOf(counts)) {
    if (left_out.bins == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(left_out.bins) + " " + left_out.reason;
  }
  return text.empty() ? "none" : text;
}

nlohmann::ordered_json ToJson(const BinCounts& counts) {
  nlohmann::ordered_json json = {{"total", counts.total}, {"valid", counts.valid}};
  for (const LeftOut& left_out : ReasonsOf(counts)) json[left_out.key] = left_out.bins;
  return json;
}

}  // namespace trilobe
