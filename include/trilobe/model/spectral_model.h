#ifndef TRILOBE_MODEL_SPECTRAL_MODEL_H_
#define TRILOBE_MODEL_SPECTRAL_MODEL_H_

#include <span>
#include <string>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// A model over wavelengths l ("bands") instead of three channels:
//   rho_l = d_l + sum_m s_l^m D^m(theta_h) F_l(theta_d) G^m(wi) G^m(wo) / (cos theta_i cos
//   theta_o).
// All bands share D and G; each has d, s and, if spec().F.per_channel, F of its own. A value type.
//
//   const SpectralModel model = *ReadModel("spectral.json").spectral;
//   const std::vector<double> rho = Evaluate(model, ToDirections(SphericalAngles{}));  // [bands]
class SpectralModel {
 public:
  static constexpr int kMaxBands = 1024;

  // Sets all parameters to 0. `spec` is as of a FactorModel, with bands in the place of channels.
  // Throws Error for no, more than kMaxBands, or not ascending wavelengths [nm], for some above one
  // that make no colour (SpectralColor), for an invalid spec, and for one whose D or G are not
  // shared.
  SpectralModel(const ModelSpec& spec, std::vector<double> wavelengths);

  const ModelSpec& spec() const { return shared_.spec(); }
  const std::vector<double>& wavelengths() const { return wavelengths_; }  // [nm]
  int bands() const { return static_cast<int>(wavelengths_.size()); }
  // Independent numbers of d, s, D, F and G.
  int num_parameters() const;

  std::span<double> d() { return d_; }  // [bands]
  std::span<const double> d() const { return d_; }
  std::span<double> s(int lobe) { return {&s_[static_cast<size_t>(lobe) * bands()], d_.size()}; }
  std::span<const double> s(int lobe) const {  // [bands]
    return {&s_[static_cast<size_t>(lobe) * bands()], d_.size()};
  }
  // Tables of D and G by their index. [spec().table_size(factor)]
  std::span<double> table(Factor factor, int index) { return shared_.table(factor, index); }
  std::span<const double> table(Factor factor, int index) const {
    return shared_.table(factor, index);
  }
  // A model of which D and G are this one's.
  const FactorModel& shared() const { return shared_; }
  // F of a lobe and band; the same span for all that share it. [spec().table_size(Factor::kF)]
  std::span<double> F(int lobe, int band) { return {&F_[FOffset(lobe, band)], F_size()}; }
  std::span<const double> F(int lobe, int band) const {
    return {&F_[FOffset(lobe, band)], F_size()};
  }

  // The model of three bands in the place of R, G and B: `first` and the two that follow it, the
  // last one repeated where there are no more. What takes a FactorModel takes bands so.
  FactorModel ThreeBands(int first) const;

  // Its colour, exactly: R, G and B are sums over the bands by weights of the CIE 1931 2-degree
  // observer under D65 (SpectralColor), and so are s F, of which each lobe has a table a channel.
  // A single band is grey. Entries that would be below 0, out of the gamut of sRGB, are 0.
  FactorModel ToRgb() const;

 private:
  size_t F_size() const { return static_cast<size_t>(spec().table_size(Factor::kF)); }
  size_t FOffset(int lobe, int band) const {
    const auto [per_lobe, per_channel] = spec().F;
    const int table =
        (per_lobe ? lobe : 0) * (per_channel ? bands() : 1) + (per_channel ? band : 0);
    return table * F_size();
  }

  std::vector<double> wavelengths_;
  FactorModel shared_;  // of which D and G count
  std::vector<double> d_, s_, F_;
};

// Throws Error, naming the first bad parameter, unless all are finite and >= 0.
void CheckParameters(const SpectralModel& model);

// BRDF [1/sr] at each wavelength for a pair of directions; 0 if either is below the surface. Throws
// Error for NaN. [bands]
std::vector<double> Evaluate(const SpectralModel& model, const DirectionPair& directions);

// The same of a sample whose stencils are known, as E compares it with the measurement: it may be
// negative where the spline of G undershoots. rho: [bands].
void UnclampedValues(const SpectralModel& model, const SampleStencils& stencils,
                     std::span<double> rho);

// "31 wavelengths from 400 to 700 nm", "one wavelength, 550 nm".
std::string WavelengthsText(const SpectralModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SPECTRAL_MODEL_H_
