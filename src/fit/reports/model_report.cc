#include "fit/reports/model_report.h"

#include <iostream>
#include <nlohmann/json.hpp>

#include "fit/reports/print.h"

namespace trilobe {

std::string DescribeStretches(const ModelSpec& spec) {
  const auto describe = [](const Stretch& stretch) {
    return "along " + Text(stretch.along, 3) + ", across " + Text(stretch.across, 3);
  };
  if (!spec.stretches.several()) return describe(spec.stretches.of(0));
  std::string text;
  for (int m = 0; m < spec.lobes; ++m) {
    text += (m > 0 ? "; lobe " : "lobe ") + std::to_string(m + 1) + " " +
            describe(spec.stretches.of(m));
  }
  return text;
}

std::string Describe(const LobeLight& light) {
  std::string text;
  for (size_t m = 0; m < light.lobes.size(); ++m) {
    text += "lobe " + std::to_string(m + 1) +
            (light.nearly_diffuse[m] ? " (nearly diffuse) " : " ") +
            Text(100 * light.Share(static_cast<int>(m)), 3) + " %, ";
  }
  return text + "diffuse " + Text(100 * light.DiffuseShare(), 3) + " %";
}

nlohmann::ordered_json ToJson(const LobeLight& light) {
  nlohmann::ordered_json lobes = nlohmann::ordered_json::array();
  for (size_t m = 0; m < light.lobes.size(); ++m) {
    lobes.push_back({{"albedo", light.lobes[m]},
                     {"share", light.Share(static_cast<int>(m))},
                     {"nearly_diffuse", static_cast<bool>(light.nearly_diffuse[m])}});
  }
  return {{"diffuse", {{"albedo", light.diffuse}, {"share", light.DiffuseShare()}}},
          {"lobes", lobes}};
}

AlbedoTable TabulateAlbedo(const BrdfFunction& brdf, int num_threads, double max_theta) {
  AlbedoTable table;
  for (int degrees = 0; degrees < 90 && DegreesToRadians(degrees) <= max_theta; ++degrees) {
    table.theta_i.push_back(DegreesToRadians(degrees));
  }
  table.albedo = DirectionalAlbedos(brdf, table.theta_i, num_threads);
  return table;
}

void Print(const AlbedoTable& table, const std::string& title) {
  std::cout << "\n" << title << "\n  theta_i [deg]       red     green      blue\n";
  for (const int degrees : {0, 10, 20, 30, 40, 50, 60, 70, 80, 85, 89}) {
    if (degrees >= static_cast<int>(table.albedo.size())) break;
    const Rgb& albedo = table.albedo[degrees];
    std::cout << AlignRight(std::to_string(degrees), 15) << AlignRight(Text(albedo[0], 3), 10)
              << AlignRight(Text(albedo[1], 3), 10) << AlignRight(Text(albedo[2], 3), 10) << "\n";
  }
  std::cout << AlignRight("passes 1 at", 15);
  for (int c = 0; c < kChannels; ++c) {
    const auto angle = AlbedoPassesOne(table.theta_i, table.albedo, c);
    std::cout << AlignRight(angle ? Text(RadiansToDegrees(*angle), 3) : "never", 10);
  }
  std::cout << "\n";
}

nlohmann::ordered_json ToJson(const AlbedoTable& table) {
  using Json = nlohmann::ordered_json;
  Json json = {{"theta_i_deg", Json::array()}};
  for (const double theta_i : table.theta_i) {
    json["theta_i_deg"].push_back(RadiansToDegrees(theta_i));
  }
  for (int c = 0; c < kChannels; ++c) {
    for (const Rgb& albedo : table.albedo) json[kChannelNames[c]].push_back(albedo[c]);
  }
  for (int c = 0; c < kChannels; ++c) {
    const auto angle = AlbedoPassesOne(table.theta_i, table.albedo, c);
    json["passes_one_deg"][kChannelNames[c]] = angle ? Json(RadiansToDegrees(*angle)) : Json();
  }
  return json;
}

}  // namespace trilobe
