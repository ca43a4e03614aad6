#ifndef TRILOBE_MODEL_STRETCH_H_
#define TRILOBE_MODEL_STRETCH_H_

#include <cmath>
#include <cstddef>
#include <vector>

#include "trilobe/core/geometry/directions.h"

namespace trilobe {

// How a highlight changes its shape with theta_d, for isotropic models. D is read not at theta_h
// but at
//   theta_h sqrt((cos phi_d cos^along theta_d)^2 + (sin phi_d cos^across theta_d)^2),
// 90 degrees at most: phi_d is 0 where the half vector leans within the plane of wi and wo. So a
// highlight is by cos^-along theta_d wider along that plane than at normal incidence, and by
// cos^-across theta_d across it. With 0 and 0 D is a distribution of normals, as in the paper (eq.
// 3); a lobe of fixed width about the mirror direction would have 0 and 1. Exchanging wi and wo
// changes nothing.
struct Stretch {
  // A pair of directions, prepared for all stretches.
  struct Place {
    Place(double theta_d, double phi_d) : Place(Cosines{std::cos(theta_d), std::cos(phi_d)}) {}
    struct Cosines {
      double theta_d, phi_d;
    };
    explicit Place(const Cosines& cosines);
    double log_cosine;  // of theta_d; at grazing angles of a little less
    double cos2_phi;
  };

  double along = 0;
  double across = 0;

  bool any() const { return along != 0 || across != 0; }

  // By what theta_h is multiplied, above 0.
  double Factor(const Place& place) const;
  // Where D is read; theta_h itself, to the bit, without a stretch. [rad]
  double ThetaH(double theta_h, const Place& place) const;

  bool operator==(const Stretch&) const = default;
};

inline constexpr double kMaxStretch = 2;

// Throws Error unless both exponents are from -kMaxStretch to kMaxStretch.
void CheckStretch(const Stretch& stretch);

// Those of a model's lobes: the same for all, or one each. Lobes that are stretched alike read
// their D alike, by one stencil a pair of directions; `distinct` has that many.
class Stretches {
 public:
  Stretches() : Stretches(Stretch{}) {}
  Stretches(const Stretch& of_all);  // NOLINT(google-explicit-constructor): one is all of them
  // One a lobe, or one for all.
  explicit Stretches(const std::vector<Stretch>& of_lobes);

  bool any() const { return several() || distinct_[0].any(); }
  bool several() const { return distinct_.size() > 1; }
  const Stretch& of(int lobe) const { return distinct_[index(lobe)]; }

  // Each once, in the order of the lobes.
  const std::vector<Stretch>& distinct() const { return distinct_; }
  // Which of these a lobe has.
  int index(int lobe) const { return several() ? index_[lobe] : 0; }

  // read_at(k, theta_h [rad]) for each of them: where the k-th reads D.
  template <typename ReadAt>
  void ForEachThetaH(const HalfDiffAngles& angles, const ReadAt& read_at) const {
    if (!any()) return read_at(size_t{0}, angles.theta_h);
    const Stretch::Place place(angles.theta_d, angles.phi_d);
    for (size_t k = 0; k < distinct_.size(); ++k) {
      read_at(k, distinct_[k].ThetaH(angles.theta_h, place));
    }
  }

  // Those of other lobes: the k-th is that of lobes[k] here.
  Stretches Select(const std::vector<int>& lobes) const;

  // Throws Error unless all are in range, and, if they are several, as many as there are lobes.
  void Check(int lobes) const;

  bool operator==(const Stretches&) const = default;

 private:
  std::vector<Stretch> distinct_;
  std::vector<int> index_;  // [lobes]; empty where all are alike
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_STRETCH_H_
