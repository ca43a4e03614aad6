#include "app/materials.h"

#include <nlohmann/json.hpp>

#include "base/nearest_name.h"
#include "trilobe/base/error.h"
#include "trilobe/formats/source.h"

namespace trilobe {
namespace {

std::vector<LibraryMaterial> MadeMaterials() {
  std::vector<LibraryMaterial> materials;
  for (const WebFile& file : MaterialFiles()) {
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

bool IsMaterial(std::string_view path) { return path.starts_with(kMaterialPrefix); }

ModelFile LoadModel(const std::string& path) {
  if (IsSynthetic(path)) {
    throw Error(path +
                ": this is a measurement; a model is a model.json that `trilobe fit` "
                "wrote, or material:NAME");
  }
  if (!IsMaterial(path)) return ReadModel(path);
  const std::string name = path.substr(kMaterialPrefix.size());
  std::vector<std::string_view> known;
  for (const LibraryMaterial& material : LibraryMaterials()) known.push_back(material.name);
  for (const WebFile& file : MaterialFiles()) {
    if (file.name == name + ".json" && name != "materials") {
      return ParseModel(file.text, path);
    }
  }
  if (known.empty()) throw Error(path + ": the program was built without materials");
  const std::string_view nearest = NearestName(name, known);
  const bool meant = 3 * EditDistance(name, nearest) <= name.size();
  throw Error(path + ": there is no material of this name; " +
              (meant
                   ? "did you mean '" + std::string(kMaterialPrefix) + std::string(nearest) + "'? "
                   : "") +
              "`trilobe materials` lists all");
}

}  // namespace trilobe
