#ifndef TRILOBE_MODEL_VALUE_OF_H_
#define TRILOBE_MODEL_VALUE_OF_H_

#include <array>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/model_spec.h"

// The formula of the model,
//   rho_C = d_C + sum_m s_C^m D^m F_C G^m(wi) G^m(wo) / (cos theta_i cos theta_o)   (paper eq. 3),
// for any number type, such as double and ceres::Jet, and any sharing and lookup of tables.
namespace trilobe {

// The value of a lobe in a channel, where G is G(wi) G(wo) / (cos theta_i cos theta_o), multiplied
// from left to right. It is linear in each factor: the derivative by a factor is the product with 1
// in its place.
template <typename S, typename TableOfD, typename TableOfF, typename Shadow>
auto LobeValue(const S& s, const TableOfD& D, const TableOfF& F, const Shadow& G) {
  return s * D * F * G;
}

// G as three factors, which multiply a product one after the other.
struct Shadowing {
  double i = 0, o = 0;  // G(wi), G(wo)
  double inverse_cosines = 0;

  friend double operator*(double x, const Shadowing& G) {
    return x * G.i * G.o * G.inverse_cosines;
  }
};

// The values of a sample in all channels. `reads` provides s(m, c), D(m, c), F(m, c) and G(m, c) of
// lobe m and channel c, for LobeValue. Tables shared by channels are read once.
template <typename T, typename Reads>
std::array<T, kChannels> ValueOf(const ModelSpec& spec, const std::array<T, kChannels>& d,
                                 const Reads& reads) {
  std::array<T, kChannels> rho = d;
  for (int m = 0; m < spec.lobes; ++m) {
    auto D = reads.D(m, 0);
    auto F = reads.F(m, 0);
    auto G = reads.G(m, 0);
    for (int c = 0; c < kChannels; ++c) {
      if (c > 0 && spec.D.per_channel) D = reads.D(m, c);
      if (c > 0 && spec.F.per_channel) F = reads.F(m, c);
      if (c > 0 && spec.G.per_channel) G = reads.G(m, c);
      rho[c] += LobeValue(reads.s(m, c), D, F, G);
    }
  }
  return rho;
}

// The same for one channel.
template <typename T, typename Reads>
T ValueOf(const ModelSpec& spec, const T& d, const Reads& reads, int channel) {
  T rho = d;
  for (int m = 0; m < spec.lobes; ++m) {
    rho += LobeValue(reads.s(m, channel), reads.D(m, channel), reads.F(m, channel),
                     reads.G(m, channel));
  }
  return rho;
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_VALUE_OF_H_
