#ifndef TRILOBE_MODEL_MEASUREMENT_ANISOTROPIC_MATERIALS_H_
#define TRILOBE_MODEL_MEASUREMENT_ANISOTROPIC_MATERIALS_H_

#include <array>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/synth_material.h"

namespace trilobe {

// One of the two orthogonal families of threads of a woven cloth, as in Table II of Sadeghi,
// Bisker, De Deken and Jensen, "A Practical Microcylinder Appearance Model for Cloth Rendering",
// 2013. Angles in degrees.
struct Thread {
  double eta = 1.5;                     // index of refraction
  Rgb color{};                          // A, of light scattered inside
  double k_d = 0;                       // share of that which is scattered to all sides alike
  double gamma_s = 10, gamma_v = 20;    // widths of surface reflection and volume scattering
  double area = 0.5;                    // share of the cloth that this family covers
  std::vector<double> tangent_offsets;  // out of the cloth's plane, where the thread's curve bends
  std::vector<double> lengths;          // [one fewer]: of the parts between; relative
};

// A cloth: threads along x (the warp) and along y.
using Cloth = std::array<Thread, 2>;

// The microcylinder model. With t a tangent of a thread, n its normal in the plane of t and the
// cloth's normal, theta the angle of a direction out of the plane normal to t, phi and psi its
// angles from n in the planes normal to t and of t and n, and h and d for half sum and difference
// (phi_d and psi_d for the whole one):
//   f = (F(theta_d, phi_d) cos(phi_d / 2) g(gamma_s, theta_h)
//        + T_i T_r ((1 - k_d) g(gamma_v, theta_h) + k_d) A / (cos theta_i + cos theta_r))
//       / cos^2 theta_d,
//   rho = 1 / (Q(r) cos) Sum_threads area Sum_t length f M(phi_i, phi_r) M(psi_i, psi_r) cos
//   theta_i,
// g a normalised Gaussian, F the Fresnel reflectance at half the angle between the directions in
// the thread's frame, T the transmittances at their angles from n, cos that of the incident
// direction with the cloth's normal. Shadowing and masking, and the apparent length of a tangent,
// are cosines, max(cos, 0), which are multiplied where the directions are far apart and of which
// the smaller counts where they are near:
//   M(a, b) = (1 - u(a - b)) cos a cos b + u(a - b) min(cos a, cos b), u a Gaussian of height 1
//   with a standard deviation of 20 degrees.
// Q(r) = Sum area length max(cos psi_r, 0) + (1 - Sum area) (r . cloth's normal).
class MicrocylinderBrdf {
 public:
  explicit MicrocylinderBrdf(const Cloth& cloth);

  // The published model. It is not reciprocal, since Q depends on one direction, and near the
  // horizon it reflects more light than it receives. [1/sr]; both directions above the surface.
  Rgb Published(const DirectionPair& pair) const;

  // The geometric mean of that for both orders of the directions: reciprocal, and reflects no more
  // than it receives.
  Rgb operator()(const DirectionPair& pair) const;

 private:
  struct Tangent {
    Direction t{}, n{}, b{};  // b = n x t
    double weight = 0;        // area x length
    int thread = 0;
  };
  // For a pair and its exchanged one.
  struct BothOrders {
    Rgb rho{}, exchanged{};
  };
  BothOrders Evaluate(const DirectionPair& pair) const;

  Cloth cloth_;
  std::vector<Tangent> tangents_;
  double gap_ = 0;  // share of the cloth that no thread covers
};

// The anisotropic materials of SynthMaterials(): woven cloths, metals and coats with a grain along
// x.
std::vector<SynthMaterial> AnisotropicMaterials();

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ANISOTROPIC_MATERIALS_H_
