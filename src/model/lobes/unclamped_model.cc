#include "model/lobes/unclamped_model.h"

#include <array>
#include <cmath>

#include "model/lobes/shadowing_pieces.h"

namespace trilobe {

UnclampedModel::UnclampedModel(const FactorModel& model)
    : model_(model),
      grid_{.theta_h = model.spec().d_axis.size, .theta_d = model.spec().f_axis.size},
      spline_(model.spec().g_axis.size),
      cosine_(CosinePieces(spline_)),
      g_(ShadowingPieces(model)) {
  CheckIsotropic(model.spec(), "a function of half and difference angles");
}

Rgb UnclampedModel::operator()(std::span<const Stencil> D, const Stencil& F,
                               const Cosines& cosines) const {
  const CatmullRom::Location i = spline_.Locate(std::acos(cosines.i));
  const CatmullRom::Location o = spline_.Locate(std::acos(cosines.o));
  const auto product = [&](const std::vector<CatmullRom::Piece>& spline) {
    return spline[i.interval](i.t - 0.5) * spline[o.interval](o.t - 0.5);
  };
  const double inverse_cosines = 1 / product(cosine_);
  const ModelSpec& spec = model_.spec();
  double g_products[kMaxLobes * kChannels];  // [G table]
  for (size_t t = 0; t < g_.size(); ++t) g_products[t] = product(g_[t]) * inverse_cosines;
  Rgb rho;
  for (int c = 0; c < kChannels; ++c) {
    rho[c] = model_.d()[c];
    for (int m = 0; m < spec.lobes; ++m) {
      rho[c] += model_.s(m)[c] * D[spec.stretches.index(m)](model_.D(m, c)) * F(model_.F(m, c)) *
                g_products[spec.table(Factor::kG, m, c)];
    }
  }
  return rho;
}

Rgb UnclampedModel::operator()(const HalfDiffAngles& angles, const Cosines& cosines) const {
  std::array<Stencil, kMaxLobes> D;
  const Stretches& stretches = model_.spec().stretches;
  stretches.ForEachThetaH(angles, [&](size_t k, double theta_h) {
    D[k] = LinearStencil(grid_.ThetaHCoordinate(theta_h), grid_.theta_h);
  });
  return (*this)(std::span(D.data(), stretches.distinct().size()),
                 LinearStencil(grid_.ThetaDCoordinate(angles.theta_d), grid_.theta_d), cosines);
}

}  // namespace trilobe
