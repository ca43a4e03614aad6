#ifndef TRILOBE_MODEL_ALBEDO_TABLE_H_
#define TRILOBE_MODEL_ALBEDO_TABLE_H_

#include <array>
#include <cstddef>
#include <mutex>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

// Directional albedos of a model, interpolated linearly between directions: a node each quarter of
// a degree of theta, since G of a fit may differ from one of its entries, a degree apart, to the
// next; of an anisotropic model some 50 nodes, denser towards grazing, and azimuths a few degrees
// apart. The albedo has kinks where G has them, so that all nodes of its tables are among these.
// The first call of At makes the table. Thread-safe.
template <typename Real>
class AlbedoTable {
 public:
  using Colour = std::array<Real, kChannels>;

  explicit AlbedoTable(const ModelSpec& spec);

  // The albedo of the model of this spec, for a direction [rad] above the surface.
  Colour At(const PreparedModel<Real>& model, Real theta, Real phi);

 private:
  using Albedo = std::array<double, kChannels>;
  using Vector = std::array<Real, 3>;

  void MakeRing(const PreparedModel<Real>& model, size_t ring);
  Albedo Integrate(const PreparedModel<Real>& model, double theta, double phi) const;
  const Albedo& Node(int ring, int azimuth) const {
    return values_[ring * azimuths_ + azimuth % azimuths_];
  }

  const bool anisotropic_;
  const int azimuths_;
  const std::vector<double> theta_;  // of the rings [rad], from 0 to kGrazingTheta
  const std::vector<double> y_;      // nodes of sin^2 theta_h
  std::once_flag made_;
  std::vector<Albedo> values_;  // [ring][azimuth]
};

extern template class AlbedoTable<double>;
extern template class AlbedoTable<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_ALBEDO_TABLE_H_
