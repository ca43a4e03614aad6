#ifndef TRILOBE_FIT_EXPORT_USD_MATERIAL_H_
#define TRILOBE_FIT_EXPORT_USD_MATERIAL_H_

#include <string>

#include "fit/export/open_pbr.h"

namespace trilobe {

// A USD layer in text, with a UsdPreviewSurface (Pixar's specification, version 2.6) on a sphere.
// Of an OpenPbr it takes base_color, base_metalness, specular_roughness and specular_ior, whose
// shading is that of GltfBrdf.
std::string FormatUsd(const OpenPbr& material, const MaterialNotes& notes);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_USD_MATERIAL_H_
