#ifndef TRILOBE_FIT_EXPORT_GLTF_MATERIAL_H_
#define TRILOBE_FIT_EXPORT_GLTF_MATERIAL_H_

#include <string>

#include "fit/export/open_pbr.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// The metallic-roughness material of glTF 2.0 (Khronos 2021, appendix B), which three.js,
// Babylon.js and engines render, with KHR_materials_ior, _specular, _clearcoat and _anisotropy. Of
// an OpenPbr it takes base_color, base_metalness, specular_color, specular_roughness, specular_ior,
// coat_weight, coat_roughness and turn; specular_roughness_anisotropy is anisotropyStrength. There
// is one GGX lobe of alpha = roughness^2, with the height-correlated Smith term and Schlick's F,
// whose F0 is the base colour of a metal; light that is scattered more than once is lost.
class GltfBrdf {
 public:
  explicit GltfBrdf(const OpenPbr& parameters);

  // BRDF of two directions [1/sr], wo towards the eye; 0 if either is below the surface. With a
  // clear coat it is not reciprocal, as in those renderers.
  Rgb operator()(const DirectionPair& pair) const;

 private:
  OpenPbr parameters_;
  double alpha_t_ = 0.1, alpha_b_ = 0.1, alpha_coat_ = 0.1;
  double f0_ = 0.04;
  double cos_turn_ = 1, sin_turn_ = 0;
};

// A glTF 2.0 document with the material on a sphere.
std::string FormatGltf(const OpenPbr& material, const MaterialNotes& notes);

// "metallic 1, roughness 0.387, base colour 0.95, 0.64, 0.54" and what else there is.
std::string EngineText(const OpenPbr& material);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_GLTF_MATERIAL_H_
