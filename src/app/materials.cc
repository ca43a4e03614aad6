#include "app/materials.h"

#include <nlohmann/json.hpp>

#include "model/materials/material_files.h"

namespace trilobe {
namespace {

std::vector<LibraryMaterial> MadeMaterials() {
  std::vector<LibraryMaterial> materials;
  for (const EmbeddedFile& file : MaterialFiles()) {
    if (file.name != "materials.json") continue;
    for (const nlohmann::json& entry : nlohmann::json::parse(file.text)) {
      materials.push_back({.name = entry.at("name"),
                           .title = entry.at("title"),
                           .source = entry.at("source"),
                           .licence = entry.at("licence"),
                           .psnr_db = entry.at("psnr_db"),
                           .mean_delta_e = entry.at("mean_delta_e"),
                           .parameters = entry.at("parameters")});
    }
  }
  return materials;
}

}  // namespace

const std::vector<LibraryMaterial>& LibraryMaterials() {
  static const std::vector<LibraryMaterial> materials = MadeMaterials();
  return materials;
}

}  // namespace trilobe
