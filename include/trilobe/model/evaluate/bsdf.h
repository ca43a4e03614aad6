#ifndef TRILOBE_MODEL_EVALUATE_BSDF_H_
#define TRILOBE_MODEL_EVALUATE_BSDF_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/model/evaluate/half_vector_table.h"
#include "trilobe/model/evaluate/prepared_model.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The theta up to which models are tabulated [rad], of wi as of wo: of models whose cosines are
// splined, as the paper's, G / cos theta is constant beyond. What is made of a model for renderers
// (Bsdf, files) takes what lies beyond as it is there.
inline constexpr double kGrazingTheta = DegreesToRadians(89.5);

// A fitted material as a renderer holds it: value, sampling, albedo, for models of every form. Made
// once from a model, immutable, safe to use from any number of threads; no call allocates.
//
//   const trilobe::Bsdf<float> bsdf(trilobe::ReadModel("model.json").model);
//
// Directions are unit vectors away from the surface, z along the normal, x where an anisotropic
// material's azimuths begin. Values are f [1/sr], without a cosine, and 0 where a direction is
// below the surface or not a number. Reciprocal. Real is double or float.
//
// Order of arguments, everywhere: wi, then wo. wi is the direction that is known, and wo the one
// that is drawn; so have it Mitsuba, and the RGL files and their loader, whose tables depend on
// theta_i. A path tracer that comes from the eye passes the direction to the eye as wi.
//
// Sampling. A mixture of two: a cosine for the diffuse term, and half vectors of all lobes together
// from a table for each of some directions wi, made when the object is (HalfVectorTable). The table
// has what the lobes reflect, f cos theta_o, in the mean over the channels, over two numbers:
//   y = sin^2 theta_h, by which equal steps are equal projected solid angles of h (paper eq. 8
//   assumes equal bins of theta_h, which MERL's are not), and
//   s, the azimuth of h from that of wi, in parts of the range phi_max in which wo is above the
//   surface: cos phi_max = -cot theta_i cot 2 theta_h.
// So nothing that is drawn lies below the horizon, whatever theta_i; and G, F and the stretch of a
// lobe, which reads its D elsewhere, are in the table as well as D is. Which of the two is drawn is
// chosen by what they reflect at this theta_i, so that weights stay near the albedo.
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

  // A direction wo for a given wi, by two numbers in [0, 1] (what is outside counts as its end):
  // `weight` is f cos theta_o / pdf, and pdf the density by solid angle [1/sr]. Where wi is below
  // the surface and, rarely, by rounding, where wo is, pdf and weight are 0: skip these.
  struct Sample {
    Vector wo{};
    Real pdf = 0;
    Colour weight{};
  };
  Sample SampleWo(const Vector& wi, const std::array<Real, 2>& u) const;

  // The density with which SampleWo draws wo for wi [1/sr]; not symmetric.
  Real Pdf(const Vector& wi, const Vector& wo) const;

  // What half vectors are drawn by.
  const HalfVectorTable<Real>& half_vectors() const { return half_vectors_; }

  // The same for many pairs or directions at once, the same numbers. Throw Error unless there are
  // as many of each.
  void Values(std::span<const Vector> wi, std::span<const Vector> wo,
              std::span<Colour> values) const {
    model_.Values(wi, wo, values);
  }
  void SamplesOfWo(std::span<const Vector> wi, std::span<const std::array<Real, 2>> u,
                   std::span<Sample> samples) const;
  void Pdfs(std::span<const Vector> wi, std::span<const Vector> wo, std::span<Real> pdfs) const;

 private:
  // A direction wi, what is drawn for it, and how often the cosine is.
  struct Incident {
    Real sin, cos_phi, sin_phi;
    typename HalfVectorTable<Real>::Condition at;
    Real cosine_part;
  };
  struct Nodes;

  void MakeTables(const Nodes& nodes);
  Incident Prepare(const Vector& wi) const;
  Real LobesPdf(const Vector& wi, const Incident& incident, const Vector& wo) const;
  Real PdfOf(const Vector& wi, const Incident& incident, const Vector& wo) const;
  void Propose(const Vector& wi, const Incident& incident, const std::array<Real, 2>& u,
               Sample* proposed) const;
  static void Weigh(const Colour& value, Sample* sample);

  PreparedModel<Real> model_;
  HalfVectorTable<Real> half_vectors_;
  Real diffuse_albedo_ = 0;     // mean over the channels
  std::vector<Colour> albedo_;  // of the lobes [node of wi]
};

extern template class Bsdf<double>;
extern template class Bsdf<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_BSDF_H_
