#ifndef TRILOBE_SOLVERS_SPLINE_MOMENTS_H_
#define TRILOBE_SOLVERS_SPLINE_MOMENTS_H_

namespace trilobe {

// Weighted moments of samples that share a pair of knot intervals (see ShadowingSums). Powers are
// of t - 1/2, the place within an interval.
struct SplineMoments {
  static constexpr int kFirst = 4;         // powers 0..3: one cubic weight a side
  static constexpr int kSecond = 7;        // powers 0..6: products of two
  static constexpr int kSecondStride = 8;  // padded to whole vectors

  double first[kFirst][kFirst] = {};           // [power of t_o][power of t_i]: sum w1 t_o^l t_i^k
  double second[kSecond][kSecondStride] = {};  // [power of t_o][power of t_i]: sum w2 t_o^l t_i^k
};

// Adds `count` samples. Each lane of each sum adds in the order of the samples, so the result does
// not depend on the width of the machine's vectors.
void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SPLINE_MOMENTS_H_
