#ifndef TRILOBE_MODEL_PREPARED_MODEL_H_
#define TRILOBE_MODEL_PREPARED_MODEL_H_

#include <array>
#include <span>
#include <vector>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// Common forms that have compiled kernels of their own: D and G per lobe, F per channel, and no
// more lobes than fit into a vector.
enum class PreparedForm : char {
  kAny,
  kIsotropic,    // D over sqrt(theta_h), unstretched; G a spline
  kAnisotropic,  // D and G also over azimuths
};

// A model of any form, prepared for many evaluations: G and the cosines are cubic pieces, tables
// are interleaved, angles are polynomials of four at once (core/base/lanes.h), and azimuths are
// computed only if a table needs them. The value is that of Evaluate(model, directions) up to
// rounding, but 0 where that throws. Real is double or float. Immutable and thread-safe; no call
// allocates.
//
//   const PreparedModel<float> prepared(model);
//   const auto f = prepared.Value(wi, wo);  // RGB [1/sr]
template <typename Real>
class PreparedModel {
 public:
  using Vector = std::array<Real, 3>;
  using Colour = std::array<Real, kChannels>;

  // Keeps no reference to `model`. Throws Error unless all parameters are finite and >= 0.
  explicit PreparedModel(const FactorModel& model);

  int lobes() const { return lobes_; }
  bool anisotropic() const { return d_axis_.polar() || g_axis_.polar(); }

  // The diffuse term [1/sr].
  const Colour& diffuse() const { return diffuse_; }

  // BRDF [1/sr], without the cosine, for two unit vectors away from the surface; 0 if either is
  // below the surface or NaN.
  Colour Value(const Vector& wi, const Vector& wo) const {
    Colour value;
    Evaluate(1, &wi, &wo, &value);
    return value;
  }

  // For isotropic models, from angles and cosines; faster, as no angles are computed. 0 if a
  // direction is below the surface or an angle is negative or NaN.
  Colour Value(const HalfDiffAngles& angles, const Cosines& cosines) const;

  // The same for many pairs, with identical results. Throws Error if the sizes differ.
  void Values(std::span<const Vector> wi, std::span<const Vector> wo,
              std::span<Colour> values) const;

  // The value of each lobe. Value is diffuse() plus their sum, or 0 if that is negative: a lobe may
  // be negative where the spline of its G undershoots. `values` has lobes() entries.
  void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const;

 private:
  struct alignas(4 * sizeof(Real)) Quad {
    Real lane[4];
  };
  // A factor's tables, interleaved by lane: entry e begins at entries[e * vectors]. With a table
  // per channel, the lane is the channel, and each lobe with its own table has a vector; else each
  // lobe's table has a lane. In tables by bins the first entry is repeated once before and the last
  // twice after, so that reads need no bounds check.
  struct Tables {
    Tables() = default;
    // Leaves room for `more_lanes` after the tables' own.
    Tables(const ModelSpec& spec, Factor factor, int more_lanes);
    int LaneOf(int table) const {
      return per_channel ? table / kChannels * 4 + table % kChannels : table;
    }
    bool per_channel = false;
    int tables = 0, vectors = 0;
    int lobe_stride = 0;  // lanes from one lobe's table to the next one's
    std::vector<Quad> entries;
  };
  // Locates theta among the rings of a polar axis.
  class Rings {
   public:
    struct Place {
      int lower, upper;
      Real t;
    };
    Rings() = default;
    explicit Rings(const Axis& axis);
    [[gnu::always_inline]] inline Place At(Real theta) const;

   private:
    struct Interval {
      Real begin, inverse_width;
      int lower, upper;
    };
    std::vector<Interval> intervals_;
    std::vector<int> first_;  // an interval that begins at or below theta = k / scale_
    Real scale_ = 0;
  };
  void SetTables(const FactorModel& model, Factor factor, Tables* tables) const;
  void SetSpline(const FactorModel& model);
  void Evaluate(size_t size, const Vector* wi, const Vector* wo, Colour* values) const;

  template <typename Number, PreparedForm kForm>
  friend class PairEvaluation;

  int lobes_ = 0;
  Colour diffuse_{};
  Quad diffuse_lanes_{};
  std::vector<Quad> specular_;      // s [lobe]
  std::vector<Stretch> stretches_;  // the distinct ones
  std::vector<int> stretch_of_;     // [D table]
  bool stretched_ = false;
  PreparedForm form_{};
  Axis d_axis_, f_axis_, g_axis_;
  // For theta_h, theta_d, theta_i and theta_o up to 45 degrees: the polynomial that, multiplied by
  // the sine, gives the table coordinate in bins (for bins of sqrt(theta) its square); the
  // coordinate of 90 degrees; and the number of entries before the first bin's centre minus half a
  // bin. For tables without bins, the angle [rad].
  static constexpr int kTerms = sizeof(Real) == sizeof(double) ? 16 : 8;
  std::array<Quad, kTerms> terms_{};
  Quad right_angle_{};
  bool by_root_ = false;
  Quad azimuths_{};             // number of azimuths of D, G and G, if polar
  Tables d_, f_, g_;            // if G is a spline, g_ has no entries
  int cosine_lane_ = 0;         // of g_
  std::vector<Quad> g_pieces_;  // f0, f1, a0, a1 of each vector of g_ [interval][vector]
  Rings d_rings_, g_rings_;
};

extern template class PreparedModel<double>;
extern template class PreparedModel<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_PREPARED_MODEL_H_
