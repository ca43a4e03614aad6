#ifndef TRILOBE_APP_MATERIALS_H_
#define TRILOBE_APP_MATERIALS_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/results/model_file.h"
#include "view/web_files.h"

namespace trilobe {

// The files of materials/, as they were when the program was built (cmake/TrilobeEmbed.cmake).
std::span<const WebFile> MaterialFiles();

// A fitted model that comes with the program (materials/materials.json).
struct LibraryMaterial {
  std::string name, title, source, licence;
  double psnr_db = 0, mean_delta_e = 0;
  int parameters = 0;
};
const std::vector<LibraryMaterial>& LibraryMaterials();

// "material:NAME" stands for the model of one.
inline constexpr std::string_view kMaterialPrefix = "material:";
bool IsMaterial(std::string_view path);

// A model file, or the model of material:NAME. Throws Error for a name that there is none of, with
// one that is like it, and for a synthetic measurement.
ModelFile LoadModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_APP_MATERIALS_H_
