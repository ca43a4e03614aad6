#ifndef TRILOBE_FIT_EXPORT_OPEN_PBR_H_
#define TRILOBE_FIT_EXPORT_OPEN_PBR_H_

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// An opaque material in parameters of OpenPBR 1.1 (Academy Software Foundation 2024), with their
// names. Other parameters have their defaults, except that coat_darkening is 0.
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
  double turn = 0;  // angle of geometry_tangent, the rougher direction, from x towards y [rad]
};

// Directions in the frame of geometry_tangent, turned by OpenPbr::turn, and their half vector.
struct TangentFrame {
  DirectionPair at;
  Direction half{};
};
TangentFrame ToTangentFrame(const DirectionPair& pair, double cos_turn, double sin_turn);

// specular_roughness seen through the coat; a rough coat increases it.
double RoughnessThroughCoat(const OpenPbr& parameters);

// Its BRDF as in MaterialX's shader code. Each layer is dimmed by the albedo of the layers above it
// in the view direction. The layers are a dielectric GGX coat over a base, which base_metalness
// mixes from a metal (GGX with Schlick's F and an F82 tint) and a dielectric GGX over the
// energy-preserving Oren-Nayar term (EON, Portsmouth et al. 2025). GGX terms are scaled up for
// multiple scattering (Turquin 2019).
class OpenPbrBrdf {
 public:
  explicit OpenPbrBrdf(const OpenPbr& parameters);

  // BRDF of two directions [1/sr]; 0 if either is below the surface. With layers it is not
  // reciprocal, as in those renderers.
  Rgb operator()(const DirectionPair& pair) const;

 private:
  // A GGX distribution and tables of its albedo over the cosine.
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

// A parameter with the digits that files have.
inline double Rounded(double x) { return std::round(x * 1e4) / 1e4; }

// Texts for readers of a file.
struct MaterialNotes {
  std::string name = {};   // of the material; characters other than letters and digits become _
  std::string made = {};   // its source and program
  std::string error = {};  // its visible error
  std::string lost = {};   // what it lacks of the model
};

// A MaterialX 1.39 document with an open_pbr_surface.
std::string FormatMaterialX(const OpenPbr& material, const MaterialNotes& notes);

// JSON with the "inputs" of Blender's node Principled BSDF (4.0 and later), by their names there.
std::string FormatPrincipled(const OpenPbr& material, const MaterialNotes& notes);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_OPEN_PBR_H_
