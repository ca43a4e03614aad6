#include "fit/reports/light_report.h"

#include <nlohmann/json.hpp>

#include "fit/reports/print.h"

namespace trilobe {

std::string Describe(const LobeLight& light) {
  std::string text;
  for (size_t m = 0; m < light.lobes.size(); ++m) {
    text += "lobe " + std::to_string(m + 1) + " " +
            Text(100 * light.Share(static_cast<int>(m)), 3) + " %, ";
  }
  return text + "diffuse " + Text(100 * light.DiffuseShare(), 3) + " %";
}

nlohmann::ordered_json ToJson(const LobeLight& light) {
  nlohmann::ordered_json lobes = nlohmann::ordered_json::array();
  for (size_t m = 0; m < light.lobes.size(); ++m) {
    lobes.push_back({{"albedo", light.lobes[m]}, {"share", light.Share(static_cast<int>(m))}});
  }
  return {{"diffuse", {{"albedo", light.diffuse}, {"share", light.DiffuseShare()}}},
          {"lobes", lobes}};
}

}  // namespace trilobe
