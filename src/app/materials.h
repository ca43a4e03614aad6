#ifndef TRILOBE_APP_MATERIALS_H_
#define TRILOBE_APP_MATERIALS_H_

#include <string>
#include <vector>

namespace trilobe {

// A fitted model that comes with the program, as materials/materials.json describes it.
struct LibraryMaterial {
  std::string name, title, source, licence;
  double psnr_db = 0, mean_delta_e = 0;
  int parameters = 0;
};
const std::vector<LibraryMaterial>& LibraryMaterials();

}  // namespace trilobe

#endif  // TRILOBE_APP_MATERIALS_H_
