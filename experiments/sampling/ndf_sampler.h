#ifndef TRILOBE_EXPERIMENTS_SAMPLING_NDF_SAMPLER_H_
#define TRILOBE_EXPERIMENTS_SAMPLING_NDF_SAMPLER_H_

#include <array>
#include <vector>

#include "trilobe/model/bsdf.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

// The sampling of the paper (Peng, Zheng, Lv, section 2.5, eq. 8), as what Bsdf's is compared with:
// a lobe is chosen, by the light that it reflects in all, or the diffuse term, which is drawn by a
// cosine; then a half vector by the lobe's distribution of normals, c D(theta_h) cos theta_h, from
// a tabulated inverse over
//   cos theta_h d omega_h = dy d phi_h / 2,  y = sin^2 theta_h,
// between whose nodes D is taken as linear. It knows neither G nor F nor the horizon, below which
// part of the directions lies; and of a stretched lobe D itself is drawn.
class NdfSampler {
 public:
  using Sample = Bsdf<double>::Sample;

  // The bins of theta_h over which D is tabulated.
  enum class Bins {
    kOfModel,    // the widths of D's bins: for MERL 0.01 to 2 degrees
    kOneDegree,  // eq. 8 as printed, whose sum takes 90 bins for equally wide
  };

  // Throws Error for parameters that are not finite and 0 or more, and of an anisotropic model for
  // kOneDegree, as eq. 8 is of isotropic ones.
  explicit NdfSampler(const FactorModel& model, Bins bins = Bins::kOfModel);

  // Same as those of Bsdf, but where wo is below the surface, pdf and weight are 0: a renderer gets
  // nothing for its ray, and the density over directions above it integrates to less than 1.
  Sample SampleWo(const Direction& wi, const std::array<double, 2>& u) const;
  double Pdf(const Direction& wi, const Direction& wo) const;

 private:
  // One lobe's D over y and phi_h, bilinear between nodes, periodic in phi_h.
  struct Table {
    double part = 0;                // how often the lobe is drawn
    std::vector<double> values;     // [y][phi]
    std::vector<double> row;        // [y] their mean over phi
    std::vector<double> cumulated;  // [y] the integral of that up to y
  };
  struct HalfVector {
    double y, phi;
  };
  Table MakeTable(const FactorModel& model, int lobe) const;
  double ReflectedBy(int lobe) const;
  HalfVector Draw(const Table& table, double u_y, double u_phi) const;
  // The density of a half vector by solid angle [1/sr].
  double Density(const Table& table, const Direction& h) const;

  PreparedModel<double> model_;
  std::vector<double> y_;
  int num_phi_ = 1;
  double cosine_part_ = 0;
  std::vector<Table> tables_;  // [lobe]
};

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_SAMPLING_NDF_SAMPLER_H_
