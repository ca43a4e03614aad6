#include "solvers/sums/spline_moments.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "core/base/multiversion.h"

namespace trilobe {
namespace {

// t^k (1 - t)^(3 - k), k = 0..3; `v` is t - 1/2.
struct Terms {
  double e0, e1, e2, e3;
  TRILOBE_ALWAYS_INLINE explicit Terms(double v) {
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

  TRILOBE_ALWAYS_INLINE explicit FirstSums(const SplineMoments& moments) {
    std::memcpy(sums, moments.first, sizeof(sums));
  }
  TRILOBE_ALWAYS_INLINE void Add(double w, const Terms& i, const Terms& o) {
    const Lanes4 w_low = w * Lanes4{i.e0, i.e1, i.e2, i.e3};
    sums[0] += o.e0 * w_low;
    sums[1] += o.e1 * w_low;
    sums[2] += o.e2 * w_low;
    sums[3] += o.e3 * w_low;
  }
  TRILOBE_ALWAYS_INLINE void Store(SplineMoments* moments) const {
    std::memcpy(moments->first, sums, sizeof(sums));
  }
};

// The 7 x 7 sums of products of two cubic terms e_k = t^k (1 - t)^(3 - k): each is one of degree 6,
// and all seven are e_0 e_k and e_k e_3: eight lanes without a shuffle, k = 3 twice.
template <typename Eight>
struct SecondSums {
  Eight sums[SplineMoments::kSecond] = {};

  TRILOBE_ALWAYS_INLINE void Add(double w, const Terms& i, const Terms& o) {
    const Lanes4 e = {i.e0, i.e1, i.e2, i.e3};
    Eight all;
    Join(e * i.e0, e * i.e3, &all);
    const Eight w_near = w * o.e0 * all, w_far = w * o.e3 * all;
    sums[0] += o.e0 * w_near;
    sums[1] += o.e1 * w_near;
    sums[2] += o.e2 * w_near;
    sums[3] += o.e3 * w_near;
    sums[4] += o.e1 * w_far;
    sums[5] += o.e2 * w_far;
    sums[6] += o.e3 * w_far;
  }
  TRILOBE_ALWAYS_INLINE void AddTo(SplineMoments* moments) const {
    for (int l = 0; l < SplineMoments::kSecond; ++l) {
      for (int k = 0; k < SplineMoments::kSecond; ++k) {
        moments->second[l][k] += sums[l][k < 4 ? k : k + 1];
      }
    }
  }
};

// 11 vector multiply-adds a sample: the 4 x 4 and 7 x 7 sums live in registers.
template <typename Eight>
TRILOBE_ALWAYS_INLINE void AddSplineMomentsBy(int count, const double* w1, const double* w2,
                                              const double* t_i, const double* t_o,
                                              SplineMoments* moments) {
  FirstSums first(*moments);
  SecondSums<Eight> second;
  for (int n = 0; n < count; ++n) {
    const Terms i(t_i[n]), o(t_o[n]);
    first.Add(w1[n], i, o);
    second.Add(w2[n], i, o);
  }
  first.Store(moments);
  second.AddTo(moments);
}

// sums[l] += w products[l] over samples, for some l, whose sums stay in registers.
template <int kFirst, int kEnd, typename Eight>
TRILOBE_ALWAYS_INLINE void AddWeighted(int count, const double* w,
                                       const Eight (*products)[SplineMoments::kSecond],
                                       SecondSums<Eight>* target) {
  Eight sums[kEnd - kFirst];
  for (int l = kFirst; l < kEnd; ++l) sums[l - kFirst] = target->sums[l];
  for (int n = 0; n < count; ++n) {
    for (int l = kFirst; l < kEnd; ++l) sums[l - kFirst] += w[n] * products[n][l];
  }
  for (int l = kFirst; l < kEnd; ++l) target->sums[l] = sums[l - kFirst];
}

// The products of the terms are made once for some weights, of a few samples at a time, which stay
// in the cache.
template <typename Eight>
TRILOBE_ALWAYS_INLINE void AddSecondMomentsBy(int count, int num_weights, int stride,
                                              const double* w2, const double* t_i,
                                              const double* t_o, SplineMoments* moments) {
  constexpr int kGroup = 6, kSamples = 32;
  Eight products[kSamples][SplineMoments::kSecond];
  for (int first = 0; first < num_weights; first += kGroup) {
    const int group = std::min(kGroup, num_weights - first);
    SecondSums<Eight> second[kGroup];
    for (int begin = 0; begin < count; begin += kSamples) {
      const int size = std::min(kSamples, count - begin);
      for (int n = 0; n < size; ++n) {
        SecondSums<Eight> product;
        product.Add(1, Terms(t_i[begin + n]), Terms(t_o[begin + n]));
        for (int l = 0; l < SplineMoments::kSecond; ++l) products[n][l] = product.sums[l];
      }
      for (int k = 0; k < group; ++k) {
        const double* const w = w2 + static_cast<size_t>(first + k) * stride + begin;
        AddWeighted<0, 4>(size, w, products, &second[k]);
        AddWeighted<4, SplineMoments::kSecond>(size, w, products, &second[k]);
      }
    }
    for (int k = 0; k < group; ++k) second[k].AddTo(&moments[first + k]);
  }
}

}  // namespace

void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  TRILOBE_FOR_EIGHT(AddSplineMomentsBy, count, w1, w2, t_i, t_o, moments);
}

void AddSecondMoments(int count, int num_weights, int stride, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  TRILOBE_FOR_EIGHT(AddSecondMomentsBy, count, num_weights, stride, w2, t_i, t_o, moments);
}

TRILOBE_MULTIVERSION
void AddFirstMoments(int count, const double* w1, const double* t_i, const double* t_o,
                     SplineMoments* moments) {
  FirstSums first(*moments);
  for (int n = 0; n < count; ++n) first.Add(w1[n], Terms(t_i[n]), Terms(t_o[n]));
  first.Store(moments);
}

}  // namespace trilobe
