#include <algorithm>
#include <iostream>
#include <string>

#include "app/command.h"
#include "app/materials.h"
#include "fit/reports/print.h"

namespace trilobe {
namespace {

int RunMaterials(std::span<const std::string> /*arguments*/) {
  size_t width = 0;
  for (const LibraryMaterial& material : LibraryMaterials()) {
    width = std::max(width, material.name.size());
  }
  for (const LibraryMaterial& material : LibraryMaterials()) {
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
