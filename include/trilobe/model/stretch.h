#ifndef TRILOBE_MODEL_STRETCH_H_
#define TRILOBE_MODEL_STRETCH_H_

#include <cmath>
#include <cstddef>
#include <vector>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// How highlights of isotropic models change shape with theta_d. D is evaluated not at theta_h but
// at
//   theta_h sqrt((cos phi_d cos^along theta_d)^2 + (sin phi_d cos^across theta_d)^2),
// at most 90 degrees; phi_d is 0 if the half vector leans within the plane of wi and wo. Relative
// to normal incidence, a highlight is wider by cos^-along theta_d in that plane and by cos^-across
// theta_d across it. Exponents 0 and 0 make D a distribution of normals, as in the paper (eq. 3); 0
// and 1 would make a lobe of fixed width about the mirror direction. The stretch is reciprocal.
struct Stretch {
  // A pair of directions, prepared for any stretch.
  struct Place {
    Place(double theta_d, double phi_d) : Place(Cosines{std::cos(theta_d), std::cos(phi_d)}) {}
    struct Cosines {
      double theta_d, phi_d;
    };
    explicit Place(const Cosines& cosines);
    double log_cosine;  // of theta_d, limited near 90 degrees
    double cos2_phi;
  };

  double along = 0;
  double across = 0;

  bool any() const { return along != 0 || across != 0; }

  // The positive factor of theta_h.
  double Factor(const Place& place) const;
  // The theta_h at which D is evaluated [rad]; exactly theta_h without a stretch.
  double ThetaH(double theta_h, const Place& place) const;

  bool operator==(const Stretch&) const = default;
};

inline constexpr double kMaxStretch = 2;

// Throws Error unless both exponents are from -kMaxStretch to kMaxStretch.
void CheckStretch(const Stretch& stretch);

// The stretches of a model's lobes, all equal or one per lobe. Equal ones share one stencil of D
// per direction pair, so they are stored once, in `distinct`.
class Stretches {
 public:
  Stretches() : Stretches(Stretch{}) {}
  Stretches(const Stretch& of_all);  // NOLINT(google-explicit-constructor): one is all of them
  // One per lobe, or one for all.
  explicit Stretches(const std::vector<Stretch>& of_lobes);

  bool any() const { return several() || distinct_[0].any(); }
  bool several() const { return distinct_.size() > 1; }
  const Stretch& of(int lobe) const { return distinct_[index(lobe)]; }

  // The distinct stretches, in the order of the lobes.
  const std::vector<Stretch>& distinct() const { return distinct_; }
  // Index of a lobe's stretch in distinct().
  int index(int lobe) const { return several() ? index_[lobe] : 0; }

  // Calls read_at(k, theta_h [rad]) for each distinct stretch k with the theta_h where it reads D.
  template <typename ReadAt>
  void ForEachThetaH(const HalfDiffAngles& angles, const ReadAt& read_at) const {
    if (!any()) return read_at(size_t{0}, angles.theta_h);
    const Stretch::Place place(angles.theta_d, angles.phi_d);
    for (size_t k = 0; k < distinct_.size(); ++k) {
      read_at(k, distinct_[k].ThetaH(angles.theta_h, place));
    }
  }

  // The stretches of lobes[0], lobes[1], ... of this one.
  Stretches Select(const std::vector<int>& lobes) const;

  // Throws Error unless all are in range and there is one for all lobes or one per lobe.
  void Check(int lobes) const;

  bool operator==(const Stretches&) const = default;

 private:
  std::vector<Stretch> distinct_;
  std::vector<int> index_;  // [lobes]; empty if all are equal
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_STRETCH_H_
