#include "fit/finish/factored_albedos.h"

#include <Eigen/Core>
#include <cmath>

#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

using VectorMap = Eigen::Map<const Eigen::VectorXd>;
// F by rows, so that the entries of G that a lookup reads are neighbours.
using TableMap =
    Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

VectorMap MapOf(std::span<const double> table) {
  return {table.data(), static_cast<Eigen::Index>(table.size())};
}

}  // namespace

FactoredAlbedos::FactoredAlbedos(const FactorModel& model, std::span<const double> theta_i,
                                 int num_threads)
    : num_threads_(num_threads),
      channels_of_d_(model.spec().D.per_channel ? kChannels : 1),
      at_(theta_i.size()) {
  ParallelFor(static_cast<int>(theta_i.size()), num_threads,
              [&](int k) { at_[k] = SumAt(model, theta_i[k]); });
}

FactoredAlbedos::AtAngle FactoredAlbedos::SumAt(const FactorModel& model, double theta_i) const {
  const ModelSpec& spec = model.spec();
  const size_t row = spec.g_axis.size, table = row * spec.f_axis.size;
  AtAngle sums{.G_i = spec.g_axis.At(theta_i, 0),
               .T = std::vector<double>(table * spec.lobes * channels_of_d_, 0.0)};
  // An isotropic model reflects as much to one side of the plane of incidence as to the other.
  constexpr double kScale = 2 * 2 * kPi / kAlbedoAzimuths;
  VisitReflected(
      theta_i, kAlbedoAzimuths,
      [&](const DirectionPair& pair, double weight) {
        weight *= kScale;
        sums.weight += weight;
        // The half and difference angles of a pair are those of the pair exchanged, too, so these
        // do not tell which stencil of G is at theta_o.
        const SampleStencils at = ScatteredStencils(spec, ToHalfDiff(pair));
        const Stencil G_o = spec.g_axis.At(std::acos(pair.wo[2]), 0);
        const ModelReads reads{model, at};
        for (int m = 0; m < spec.lobes; ++m) {
          for (int c = 0; c < channels_of_d_; ++c) {
            const double D = weight * at.inverse_cosines * reads.D(m, c);
            double* const T = &sums.T[table * (m * channels_of_d_ + c)];
            for (int k = 0; k < at.F.size; ++k) {
              for (int l = 0; l < G_o.size; ++l) {
                T[row * at.F.index[k] + G_o.index[l]] += D * at.F.weight[k] * G_o.weight[l];
              }
            }
          }
        }
      },
      Side::kOne);
  return sums;
}

std::vector<Rgb> FactoredAlbedos::operator()(const FactorModel& model, size_t first) const {
  const ModelSpec& spec = model.spec();
  const int of_f = spec.f_axis.size, of_g = spec.g_axis.size;
  std::vector<Rgb> albedos(at_.size() - first);
  ParallelFor(static_cast<int>(albedos.size()), num_threads_, [&](int i) {
    const AtAngle& at = at_[first + i];
    for (int c = 0; c < kChannels; ++c) {
      double albedo = at.weight * model.d()[c];
      for (int m = 0; m < spec.lobes; ++m) {
        const int table = m * channels_of_d_ + (channels_of_d_ > 1 ? c : 0);
        const TableMap T(&at.T[static_cast<size_t>(of_f) * of_g * table], of_f, of_g);
        albedo += model.s(m)[c] * at.G_i(model.G(m, c)) *
                  MapOf(model.F(m, c)).dot(T * MapOf(model.G(m, c)));
      }
      albedos[i][c] = albedo;
    }
  });
  return albedos;
}

}  // namespace trilobe
