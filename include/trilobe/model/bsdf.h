#ifndef TRILOBE_MODEL_BSDF_H_
#define TRILOBE_MODEL_BSDF_H_

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/half_vector_table.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

template <typename Real>
class AlbedoTable;
template <typename Real>
class SamplingTable;

// A fitted material for a renderer: evaluation, sampling and albedo of models of every form.
// Immutable and thread-safe. The first call that draws or asks for a density, and the first of
// Albedo, make their tables in up to some seconds; no other allocates. Real is double or float.
//
//   const trilobe::Bsdf<float> bsdf(trilobe::ReadModel("model.json").model);
//   const auto f = bsdf.Value(wi, wo);           // RGB [1/sr], without the cosine
//   const auto next = bsdf.SampleWo(wi, {u, v});
//   if (next.pdf > 0) throughput *= next.weight;
//
// Directions are unit vectors away from the surface; z is the normal, x the origin of azimuths.
// Values are 0 if a direction is below the surface or NaN. Value is reciprocal.
//
// Arguments are always wi, then wo. wi is given and wo is sampled, as in Mitsuba and in RGL files,
// whose tables depend on theta_i. A path tracer that starts at the eye passes the direction to the
// eye as wi.
//
// Sampling mixes two densities: a cosine for the diffuse term, and for all lobes together a table
// of half vectors for each of several wi (HalfVectorTable). It tabulates f cos theta_o of the
// lobes, averaged over the channels, over two variables:
//   y = sin^2 theta_h: equal steps are equal projected solid angles of h (paper eq. 8 assumes
//   equal bins of theta_h, which MERL's are not), and
//   s, the azimuth of h from that of wi as a fraction of phi_max, up to which wo is above the
//   surface: cos phi_max = -cot theta_i cot 2 theta_h.
// So no sample is below the horizon, and the table includes D, F, G and the stretch. The mixture
// weights are the albedos of the two parts at theta_i, so sample weights stay near the albedo.
template <typename Real>
class Bsdf {
 public:
  using Vector = std::array<Real, 3>;
  using Colour = std::array<Real, kChannels>;

  // Throws Error unless all parameters are finite and >= 0 and their products do not overflow.
  explicit Bsdf(const FactorModel& model);

  int lobes() const { return model_.lobes(); }
  bool anisotropic() const { return model_.anisotropic(); }

  Colour Value(const Vector& wi, const Vector& wo) const { return model_.Value(wi, wo); }

  // The diffuse term, and the value of each lobe. Value is their sum, or 0 if that is negative.
  // `values` has lobes() entries.
  const Colour& diffuse() const { return model_.diffuse(); }
  void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const {
    model_.LobeValues(wi, wo, values);
  }

  // Directional albedo: the reflected share of the light from w, the integral of f cos theta over
  // the hemisphere. It is interpolated in a table, which the first call makes in up to a second.
  // The relative error is at most 1.5 % up to 75 degrees from the normal and 3 % up to 85.
  Colour Albedo(const Vector& w) const;

  // Samples wo for a given wi from two numbers in [0, 1] (clamped). `weight` is f cos theta_o /
  // pdf, `pdf` the density per solid angle [1/sr]. Both are 0, and the sample must be skipped, if
  // wi or, rarely, by rounding, wo is below the surface.
  struct Sample {
    Vector wo{};
    Real pdf = 0;
    Colour weight{};
  };
  Sample SampleWo(const Vector& wi, const std::array<Real, 2>& u) const;

  // The density with which SampleWo draws wo for wi [1/sr]; not symmetric.
  Real Pdf(const Vector& wi, const Vector& wo) const;

  // The distribution of half vectors, by which SampleWo draws.
  const HalfVectorTable<Real>& half_vectors() const;

  // The same for many pairs or directions, with identical results. Throw Error if the sizes differ.
  void Values(std::span<const Vector> wi, std::span<const Vector> wo,
              std::span<Colour> values) const {
    model_.Values(wi, wo, values);
  }
  void SamplesOfWo(std::span<const Vector> wi, std::span<const std::array<Real, 2>> u,
                   std::span<Sample> samples) const;
  void Pdfs(std::span<const Vector> wi, std::span<const Vector> wo, std::span<Real> pdfs) const;

 private:
  // A direction wi, its half-vector distribution, and the probability of the cosine.
  struct Incident {
    Real sin, cos_phi, sin_phi;
    typename HalfVectorTable<Real>::Condition at;
    Real cosine_part;
  };

  Incident Prepare(const Vector& wi) const;
  Real LobesPdf(const Vector& wi, const Incident& incident, const Vector& wo) const;
  Real PdfOf(const Vector& wi, const Incident& incident, const Vector& wo) const;
  void Propose(const Vector& wi, const Incident& incident, const std::array<Real, 2>& u,
               Sample* proposed) const;
  static void Weigh(const Colour& value, Sample* sample);

  PreparedModel<Real> model_;
  std::shared_ptr<SamplingTable<Real>> half_vectors_;
  std::shared_ptr<AlbedoTable<Real>> albedos_;
};

extern template class Bsdf<double>;
extern template class Bsdf<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_BSDF_H_
