#ifndef TRILOBE_FIT_OPEN_PBR_MATERIAL_FILES_H_
#define TRILOBE_FIT_OPEN_PBR_MATERIAL_FILES_H_

#include <string>

#include "fit/open_pbr/open_pbr.h"

namespace trilobe {

// What a file says about itself: for people, any text.
struct MaterialNotes {
  std::string name;   // of the material; other than letters and digits become _
  std::string made;   // what it was made of, by which program
  std::string error;  // how far off it looks
  std::string lost;   // against the model
};

// A document of MaterialX 1.39 with an open_pbr_surface.
std::string FormatMaterialX(const OpenPbr& material, const MaterialNotes& notes);

// What Blender's node Principled BSDF (4.0 and later) takes, as JSON: "inputs" by their names
// there.
std::string FormatPrincipled(const OpenPbr& material, const MaterialNotes& notes);

}  // namespace trilobe

#endif  // TRILOBE_FIT_OPEN_PBR_MATERIAL_FILES_H_
