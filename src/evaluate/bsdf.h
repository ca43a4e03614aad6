#ifndef TRILOBE_EVALUATE_BSDF_H_
#define TRILOBE_EVALUATE_BSDF_H_

#include <array>
#include <cstddef>
#include <vector>

#include "trilobe/brdf/channels.h"
#include "trilobe/evaluate/half_vector_table.h"
#include "trilobe/evaluate/prepared_model.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A fitted material as a renderer holds it: value, sampling, albedo, for models of every form. Made
// once from a model, immutable, safe to use from any number of threads; no call allocates.
//
//   const trilobe::Bsdf<float> bsdf(trilobe::ReadModel("model.json").model);
//
// Directions are unit vectors away from the surface, z along the normal, x where an anisotropic
// material's azimuths begin. Values are f [1/sr], without a cosine, and 0 where a direction is
// below the surface or not a number. Reciprocal. Real is double or float.
//
// Sampling. A mixture of two: a cosine for the diffuse term, and half vectors of all lobes together
// from a table for each of some directions wo, made when the object is (HalfVectorTable). The table
// has what the lobes reflect, f cos theta_i, in the mean over the channels, over two numbers:
//   y = sin^2 theta_h, by which equal steps are equal projected solid angles of h (paper eq. 8
//   assumes equal bins of theta_h, which MERL's are not), and
//   s, the azimuth of h from that of wo, in parts of the range phi_max in which wi is above the
//   surface: cos phi_max = -cot theta_o cot 2 theta_h.
// So nothing that is drawn lies below the horizon, whatever theta_o; and G, F and the stretch of a
// lobe, which reads its D elsewhere, are in the table as well as D is. Which of the two is drawn is
// chosen by what they reflect at this theta_o, so that weights stay near the albedo.
template <typename Real>
class Bsdf {
 public:
  using Vector = std::array<Real, 3>;
  using Colour = std::array<Real, kChannels>;

  // Throws Error for parameters that are not finite and 0 or more, or whose products overflow.
  explicit Bsdf(const FactorModel& model);

  int lobes() const { return model_.lobes(); }
  bool anisotropic() const { return model_.anisotropic(); }

  Colour Value(const Vector& wi, const Vector& wo) const { return model_.Value(wi, wo); }

  // The diffuse term, and each lobe's part of the value, of which that is the sum (or 0 where that
  // is negative). `values` has lobes() entries.
  const Colour& diffuse() const { return model_.diffuse(); }
  void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const {
    model_.LobeValues(wi, wo, values);
  }

  // Directional albedo: the share of the light from w that is reflected, the integral of
  // f cos theta over the hemisphere. From the tables of the sampling: of smooth tables, within 3 %
  // of itself up to 75 degrees from the normal, 6 % up to 85.
  Colour Albedo(const Vector& w) const;

  // A direction wi for a given wo, by two numbers in [0, 1] (what is outside counts as its end):
  // `weight` is f cos theta_i / pdf, and pdf the density by solid angle [1/sr]. Where wo is below
  // the surface and, rarely, by rounding, where wi is, pdf and weight are 0: skip these. wo comes
  // first here and in Pdf, which is not symmetric.
  struct Sample {
    Vector wi{};
    Real pdf = 0;
    Colour weight{};
  };
  Sample SampleWi(const Vector& wo, const std::array<Real, 2>& u) const;

  // The density with which SampleWi draws wi [1/sr].
  Real Pdf(const Vector& wo, const Vector& wi) const;

 private:
  // A direction wo, what is drawn for it, and how often the cosine is.
  struct Outgoing {
    Real sin, cos_phi, sin_phi;
    typename HalfVectorTable<Real>::Condition at;
    Real cosine_part;
  };
  struct Nodes;

  void MakeTables(const Nodes& nodes);
  Outgoing Prepare(const Vector& wo) const;
  Real LobesPdf(const Vector& wo, const Outgoing& outgoing, const Vector& wi) const;

  PreparedModel<Real> model_;
  HalfVectorTable<Real> half_vectors_;
  Real diffuse_albedo_ = 0;     // mean over the channels
  std::vector<Colour> albedo_;  // of the lobes [node of wo]
};

extern template class Bsdf<double>;
extern template class Bsdf<float>;

}  // namespace trilobe

#endif  // TRILOBE_EVALUATE_BSDF_H_
