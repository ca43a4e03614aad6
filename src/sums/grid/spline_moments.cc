#include "sums/grid/spline_moments.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "base/multiversion.h"

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

// The 4 x 4 sums of products of two cubic terms, one a side.
struct FirstSums {
  Lanes4 sums[SplineMoments::kFirst];

  explicit FirstSums(const SplineMoments& moments) {
    std::memcpy(sums, moments.first, sizeof(sums));
  }
  void Add(double w, const Terms& i, const Terms& o) {
    const Lanes4 w_low = w * Lanes4{i.e0, i.e1, i.e2, i.e3};
    sums[0] += o.e0 * w_low;
    sums[1] += o.e1 * w_low;
    sums[2] += o.e2 * w_low;
    sums[3] += o.e3 * w_low;
  }
  void Store(SplineMoments* moments) const { std::memcpy(moments->first, sums, sizeof(sums)); }
};

// The 7 x 7 sums of products of two cubic terms e_k = t^k (1 - t)^(3 - k): each is one of degree 6,
// and all seven are e_0 e_k and e_k e_3: eight lanes without a shuffle, k = 3 twice.
struct SecondSums {
  Lanes8 sums[SplineMoments::kSecond] = {};

  void Add(double w, const Terms& i, const Terms& o) {
    const Lanes8 all = Lanes8{i.e0, i.e1, i.e2, i.e3, i.e0, i.e1, i.e2, i.e3} *
                       Lanes8{i.e0, i.e0, i.e0, i.e0, i.e3, i.e3, i.e3, i.e3};
    const Lanes8 w_near = w * o.e0 * all, w_far = w * o.e3 * all;
    sums[0] += o.e0 * w_near;
    sums[1] += o.e1 * w_near;
    sums[2] += o.e2 * w_near;
    sums[3] += o.e3 * w_near;
    sums[4] += o.e1 * w_far;
    sums[5] += o.e2 * w_far;
    sums[6] += o.e3 * w_far;
  }
  void AddTo(SplineMoments* moments) const {
    for (int l = 0; l < SplineMoments::kSecond; ++l) {
      for (int k = 0; k < SplineMoments::kSecond; ++k) {
        moments->second[l][k] += sums[l][k < 4 ? k : k + 1];
      }
    }
  }
};

}  // namespace

// 11 vector multiply-adds a sample: the 4 x 4 and 7 x 7 sums live in registers.
TRILOBE_MULTIVERSION
void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  FirstSums first(*moments);
  SecondSums second;
  for (int n = 0; n < count; ++n) {
    const Terms i(t_i[n]), o(t_o[n]);
    first.Add(w1[n], i, o);
    second.Add(w2[n], i, o);
  }
  first.Store(moments);
  second.AddTo(moments);
}

TRILOBE_MULTIVERSION
void AddFirstMoments(int count, const double* w1, const double* t_i, const double* t_o,
                     SplineMoments* moments) {
  FirstSums first(*moments);
  for (int n = 0; n < count; ++n) first.Add(w1[n], Terms(t_i[n]), Terms(t_o[n]));
  first.Store(moments);
}

// The products of the terms are made once for all weights, a group of which has its sums in the
// cache.
TRILOBE_MULTIVERSION
void AddSecondMoments(int count, int num_weights, int stride, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  constexpr int kGroup = 6;
  for (int first = 0; first < num_weights; first += kGroup) {
    const int group = std::min(kGroup, num_weights - first);
    SecondSums second[kGroup];
    for (int n = 0; n < count; ++n) {
      SecondSums products;
      products.Add(1, Terms(t_i[n]), Terms(t_o[n]));
      for (int k = 0; k < group; ++k) {
        const double w = w2[static_cast<size_t>(first + k) * stride + n];
        for (int l = 0; l < SplineMoments::kSecond; ++l) {
          second[k].sums[l] += w * products.sums[l];
        }
      }
    }
    for (int k = 0; k < group; ++k) second[k].AddTo(&moments[first + k]);
  }
}

}  // namespace trilobe
