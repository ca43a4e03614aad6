#ifndef TRILOBE_MODEL_EVALUATE_PREPARED_MODEL_H_
#define TRILOBE_MODEL_EVALUATE_PREPARED_MODEL_H_

#include <array>
#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/math/catmull_rom.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The forms that most models have, with D and G by the lobe and F by the channel, of no more lobes
// than a vector has room for, are compiled by themselves: what depends on the form is decided then.
enum class PreparedForm : char {
  kAny,
  kIsotropic,    // D over the root of theta_h, unstretched; G a spline
  kAnisotropic,  // D and G over azimuths, too
};

// A model of any form as a function of directions, prepared for many calls: the splines through G
// and the cosines are cubics, tables lie side by side as they are read, and azimuths are taken
// where a table has some. Angles are polynomials, four at once (core/math/lanes.h). The
// same value as Evaluate(model, directions), to rounding, but 0 where that throws. Real is double
// or float. Immutable; any number of threads may use one object, and no call allocates.
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
  Colour Value(const Vector& wi, const Vector& wo) const {
    Colour value;
    Evaluate(1, &wi, &wo, &value);
    return value;
  }

  // Of an isotropic model, by the angles of two directions, which are sooner read than found, and
  // by their cosines. 0 where the surface hides one, or an angle is below 0 or not a number.
  Colour Value(const HalfDiffAngles& angles, const Cosines& cosines) const;

  // Of many pairs, the same numbers. Throws Error unless there are as many of each.
  void Values(std::span<const Vector> wi, std::span<const Vector> wo,
              std::span<Colour> values) const;

  // The same lobe by lobe: Value is diffuse() and the sum of these, or 0 where that is negative, as
  // a lobe may be where the spline through its G undershoots. `values` has lobes() entries.
  void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const;

 private:
  struct alignas(4 * sizeof(Real)) Quad {
    Real lane[4];
  };
  // A factor's tables, lane by lane: entry e is entries[e * vectors ... ]. A table for each channel
  // has the lane of the channel, in a vector for each lobe that has its own; else each lobe's table
  // has a lane. Before the first entry of
  // a table by bins it stands once more, and after the last twice, so that no place is beyond.
  struct Tables {
    Tables() = default;
    // With room for so many lanes after the tables' own.
    Tables(const ModelSpec& spec, Factor factor, int more_lanes);
    int LaneOf(int table) const {
      return per_channel ? table / kChannels * 4 + table % kChannels : table;
    }
    bool per_channel = false;
    int tables = 0, vectors = 0;
    int lobe_stride = 0;  // lanes from one lobe's table to the next one's
    std::vector<Quad> entries;
  };
  // Where theta lies among the rings of a polar axis.
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
    std::vector<int> first_;  // an interval that does not begin above theta = k / scale_
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
  // Of theta_h, theta_d, theta_i and theta_o up to 45 degrees: the polynomial whose product with
  // the sine is where tables are read, in bins (of bins of the root of theta, the square of that);
  // what that is at 90 degrees; and half a bin less than how many entries are before the first
  // bin's centre. Where a table is not read by bins, an angle [rad].
  static constexpr int kTerms = sizeof(Real) == sizeof(double) ? 16 : 8;
  std::array<Quad, kTerms> terms_{};
  Quad right_angle_{};
  bool by_root_ = false;
  Quad azimuths_{};             // how many D, G and G have, where these are polar
  Tables d_, f_, g_;            // of a spline g_ has no entries
  int cosine_lane_ = 0;         // of g_
  std::vector<Quad> g_pieces_;  // f0, f1, a0, a1 of each vector of g_ [interval][vector]
  Rings d_rings_, g_rings_;
};

extern template class PreparedModel<double>;
extern template class PreparedModel<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_PREPARED_MODEL_H_
