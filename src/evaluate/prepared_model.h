#ifndef TRILOBE_EVALUATE_PREPARED_MODEL_H_
#define TRILOBE_EVALUATE_PREPARED_MODEL_H_

#include <array>
#include <vector>

#include "trilobe/brdf/channels.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A model of any form as a function of directions, prepared for many calls: the splines through G
// and the cosines are cubics, tables lie side by side as they are read, and azimuths are taken
// where a table has some. The same value as Evaluate(model, directions), to rounding, but 0 where
// that throws. Real is double or float. Immutable; any number of threads
// may use one object, and no call allocates.
template <typename Real>
class PreparedModel {
 public:
  using Vector = std::array<Real, 3>;
  using Colour = std::array<Real, kChannels>;

  // Copies what it needs. Throws Error for parameters that are not finite and 0 or more.
  explicit PreparedModel(const FactorModel& model);

  int lobes() const { return lobes_; }
  bool anisotropic() const { return d_axis_.polar() || g_axis_.polar(); }

  // The diffuse term [1/sr].
  const Colour& diffuse() const { return diffuse_; }

  // BRDF [1/sr], without a cosine, for two unit vectors away from the surface; 0 where one is below
  // it or not a number.
  Colour Value(const Vector& wi, const Vector& wo) const;

  // The same lobe by lobe: Value is diffuse() and the sum of these, or 0 where that is negative, as
  // a lobe may be where the spline through its G undershoots. `values` has lobes() entries.
  void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const;

 private:
  // A factor's tables, in their numbers' order beside each other: entry e of table t is at
  // [e * count + t].
  struct Tables {
    int count = 0;
    std::vector<Real> entries;
  };
  // Two neighbours of a table and how far from the first to the second.
  struct Place {
    int lower = 0, upper = 0;
    Real t = 0;
  };
  // A spline through G or the cosines on one interval, as CatmullRom::Piece has it.
  struct Piece {
    Real f0, f1, a0, a1;
    Real operator()(Real t) const {
      const Real u = 1 - t;
      return u * f0 + t * f1 + t * u * (u * a0 + t * a1);
    }
  };
  // What one pair of directions reads, a number a table.
  struct Readings {
    std::array<Real, kMaxLobes * kChannels> D, F, G;
  };

  Tables TablesOf(const FactorModel& model, Factor factor) const;
  void SetSpline(const FactorModel& model);

  // A pair of directions above the surface.
  struct Pair {
    const Vector& wi;
    const Vector& wo;
    Vector half;  // of unit length
    Real sin2_h, cos_d;
    Real theta_h = 0, theta_d = 0, theta_i = 0, theta_o = 0;
  };

  static Place Linear(Real coordinate, int bins);
  static Place PlaceInTheta(const Axis& axis, Real theta);
  static Place PlaceInPhi(const Axis& axis, const Vector& direction, Real sin_theta);
  static void ReadPolar(const Tables& tables, const Axis& axis, const Vector& direction, Real theta,
                        Real sin_theta, Real* values);
  static void ReadAt(const Tables& tables, const Place& at, Real* values);

  // False where the value is 0 whatever the tables say.
  bool Read(const Vector& wi, const Vector& wo, Readings* readings) const;
  void ReadD(const Pair& pair, Real* values) const;
  void ReadG(const Pair& pair, Real* values) const;

  int lobes_ = 0;
  Colour diffuse_{};
  std::vector<Colour> specular_;           // s [lobe]
  std::vector<std::array<int, 3>> table_;  // of D, F and G [lobe * kChannels + channel]
  std::vector<Stretch> stretches_;         // the distinct ones
  std::vector<int> stretch_of_;            // [D table]
  bool stretched_ = false;
  Axis d_axis_, f_axis_, g_axis_;
  Tables d_, f_, g_;                       // g_ where G is bilinear
  std::vector<Piece> cosines_, g_pieces_;  // [interval], [interval * g_.count + table]
};

extern template class PreparedModel<double>;
extern template class PreparedModel<float>;

}  // namespace trilobe

#endif  // TRILOBE_EVALUATE_PREPARED_MODEL_H_
