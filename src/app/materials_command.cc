#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/command.h"
#include "fit/reports/print.h"
#include "model/material_files.h"

namespace trilobe {
namespace {

// A fitted model that comes with the program, as materials/materials.json describes it.
struct LibraryMaterial {
  std::string name, title, source, licence;
  double psnr_db = 0, mean_delta_e = 0;
  int parameters = 0;
};

std::vector<LibraryMaterial> ReadLibraryMaterials() {
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

int RunMaterials(std::span<const std::string> /*arguments*/) {
  const std::vector<LibraryMaterial> materials = ReadLibraryMaterials();
  size_t width = 0;
  for (const LibraryMaterial& material : materials) {
    width = std::max(width, material.name.size());
  }
  for (const LibraryMaterial& material : materials) {
    PrintLine("  " + material.name + std::string(width + 2 - material.name.size(), ' ') +
              material.title + "; " + std::to_string(material.parameters) + " parameters, sphere " +
              Text(material.psnr_db, 3) + " dB, Delta E " + Text(material.mean_delta_e, 2) + "; " +
              material.licence);
  }
  return 0;
}

}  // namespace

Command MaterialsCommand() {
  return {
      .name = "materials",
      .summary = "list the fitted models that come with the program",
      .arguments = "",
      .min_arguments = 0,
      .max_arguments = 0,
      .details =
          "Each is a model of a measured material, which stands as material:NAME wherever a "
          "command takes a MODEL:\n`trilobe view material:NAME --out=x.html`. What it is a fit of, "
          "and under what licence, is in its line.",
      .flags = {},
      .run = RunMaterials};
}

}  // namespace trilobe
