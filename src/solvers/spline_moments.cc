#include "trilobe/solvers/spline_moments.h"

#include <cstring>

#include "trilobe/base/multiversion.h"

namespace trilobe {
namespace {

// t^k (1 - t)^(3 - k), k = 0..3; `v` is t - 1/2.
struct Terms {
  double e0, e1, e2, e3;
  explicit Terms(double v) {
    const double t = 0.5 + v, u = 0.5 - v;
    e0 = u * u * u;
    e1 = u * u * t;
    e2 = u * (t * t);
    e3 = t * t * t;
  }
};

}  // namespace

TRILOBE_MULTIVERSION
void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  // 11 vector multiply-adds a sample: the 4 x 4 and 7 x 7 sums live in registers. A product of two
  // cubic terms e_k = t^k (1 - t)^(3 - k) is one of degree 6, and all seven are e_0 e_k and e_k
  // e_3: eight lanes without a shuffle, k = 3 twice.
  Lanes4 first[SplineMoments::kFirst];
  Lanes8 second[SplineMoments::kSecond] = {};
  std::memcpy(first, moments->first, sizeof(first));
  for (int n = 0; n < count; ++n) {
    const Terms i(t_i[n]), o(t_o[n]);
    const Lanes4 low = {i.e0, i.e1, i.e2, i.e3};
    const Lanes4 w_low = w1[n] * low;
    first[0] += o.e0 * w_low;
    first[1] += o.e1 * w_low;
    first[2] += o.e2 * w_low;
    first[3] += o.e3 * w_low;
    const Lanes8 all = Lanes8{i.e0, i.e1, i.e2, i.e3, i.e0, i.e1, i.e2, i.e3} *
                       Lanes8{i.e0, i.e0, i.e0, i.e0, i.e3, i.e3, i.e3, i.e3};
    const Lanes8 w_near = w2[n] * o.e0 * all, w_far = w2[n] * o.e3 * all;
    second[0] += o.e0 * w_near;
    second[1] += o.e1 * w_near;
    second[2] += o.e2 * w_near;
    second[3] += o.e3 * w_near;
    second[4] += o.e1 * w_far;
    second[5] += o.e2 * w_far;
    second[6] += o.e3 * w_far;
  }
  std::memcpy(moments->first, first, sizeof(first));
  for (int l = 0; l < SplineMoments::kSecond; ++l) {
    for (int k = 0; k < SplineMoments::kSecond; ++k) {
      moments->second[l][k] += second[l][k < 4 ? k : k + 1];
    }
  }
}

}  // namespace trilobe
