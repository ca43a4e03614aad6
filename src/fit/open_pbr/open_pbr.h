#ifndef TRILOBE_FIT_OPEN_PBR_OPEN_PBR_H_
#define TRILOBE_FIT_OPEN_PBR_OPEN_PBR_H_

#include <array>
#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {

// An opaque material as renderers with fixed closures have it: parameters of OpenPBR 1.1 (Academy
// Software Foundation 2024), each by its name there. Those that are not here keep their defaults,
// but for coat_darkening, which is 0.
struct OpenPbr {
  Rgb base_color = {0.8, 0.8, 0.8};
  double base_diffuse_roughness = 0;
  double base_metalness = 0;
  Rgb specular_color = {1, 1, 1};
  double specular_roughness = 0.3;
  double specular_roughness_anisotropy = 0;
  double specular_ior = 1.5;
  double coat_weight = 0;
  double coat_roughness = 0;
  double coat_ior = 1.6;
  double turn = 0;  // of geometry_tangent, along which it is rougher, from x towards y [rad]
};

// specular_roughness as it is seen through the coat, a rough one of which roughens what lies below.
double RoughnessThroughCoat(const OpenPbr& parameters);

// Its BRDF as MaterialX's code for shaders has it, layer over layer, each dimmed by what the ones
// above it reflect of the light towards the eye: coat, a GGX of a dielectric; metal, a GGX with
// Schlick's F and a tint at 82 degrees (F82), mixed by base_metalness with a GGX of a dielectric
// over Oren and Nayar's diffuse term that keeps its energy (EON, Portsmouth et al. 2025). GGX are
// scaled up by what scatters more than once (Turquin 2019).
class OpenPbrBrdf {
 public:
  explicit OpenPbrBrdf(const OpenPbr& parameters);

  // [1/sr] of two directions; 0 where either is below the surface. Not reciprocal where there are
  // layers, as those renderers are not.
  Rgb operator()(const DirectionPair& pair) const;

 private:
  // A GGX distribution, and what it reflects of light from some cosines on.
  struct Ggx {
    double alpha_x = 0.1, alpha_y = 0.1, ior = 1.5;
    std::vector<double> whole, dielectric;  // albedos for F = 1 and for this IOR, [kCosines]

    void SetTables();
    double Value(const DirectionPair& pair, const Direction& half) const;  // D G / (4 cos cos)
  };
  static double At(const std::vector<double>& table, double cosine);

  OpenPbr parameters_;
  Ggx specular_, coat_;
  double cos_turn_ = 1, sin_turn_ = 0;
};

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

#endif  // TRILOBE_FIT_OPEN_PBR_OPEN_PBR_H_
