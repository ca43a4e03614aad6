#include "model/objective/unclamped_model.h"

#include <array>
#include <cmath>

#include "model/objective/shadowing_pieces.h"
#include "trilobe/model/value_of.h"

namespace trilobe {
namespace {

// D and F by stencils, G by its product for each table.
struct Reads {
  const FactorModel& model;
  std::span<const Stencil> stencil_of_D;  // [stretch]
  const Stencil& stencil_of_F;
  const double* products_of_G;

  double s(int m, int c) const { return model.s(m)[c]; }
  double D(int m, int c) const {
    return stencil_of_D[model.spec().stretches.index(m)](model.D(m, c));
  }
  double F(int m, int c) const { return stencil_of_F(model.F(m, c)); }
  double G(int m, int c) const { return products_of_G[model.spec().table(Factor::kG, m, c)]; }
};

}  // namespace

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
  double G[kMaxLobes * kChannels];  // [G table]
  for (size_t t = 0; t < g_.size(); ++t) G[t] = product(g_[t]) * inverse_cosines;
  const std::span<const double> d = model_.d();
  return ValueOf(model_.spec(), Rgb{d[0], d[1], d[2]}, Reads{model_, D, F, G});
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
