#ifndef TRILOBE_SOLVERS_SUMS_SPLINE_MOMENTS_H_
#define TRILOBE_SOLVERS_SUMS_SPLINE_MOMENTS_H_

namespace trilobe {

// Weighted moments of samples that share a pair of knot intervals (see ShadowingSums), in the terms
// of Bernstein polynomials of the place t in each interval,
//   first:  sum w1 t_o^l (1 - t_o)^(3 - l) t_i^k (1 - t_i)^(3 - k),   l, k = 0..3,
//   second: sum w2 t_o^l (1 - t_o)^(6 - l) t_i^k (1 - t_i)^(6 - k),   l, k = 0..6.
// Bernstein terms avoid the cancellation of powers of t at the ends of an interval, where weights
// of nodes vanish. There the rounding errors of a sample with a huge w2 would exceed the
// contributions of all others to that node.
struct SplineMoments {
  static constexpr int kFirst = 4;         // degree 3: one cubic weight a side
  static constexpr int kSecond = 7;        // degree 6: products of two
  static constexpr int kSecondStride = 8;  // padded to whole vectors

  double first[kFirst][kFirst] = {};           // [l][k]
  double second[kSecond][kSecondStride] = {};  // [l][k]
};

// Adds `count` samples to both moments; t_i and t_o are t - 1/2. Each sum adds in the order of the
// samples, so the result does not depend on the width of the machine's vectors.
void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments);

// The first moments alone.
void AddFirstMoments(int count, const double* w1, const double* t_i, const double* t_o,
                     SplineMoments* moments);

// The second moments alone, of the same samples with several weights, each `stride` behind the one
// before. moments: [num_weights]
void AddSecondMoments(int count, int num_weights, int stride, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SPLINE_MOMENTS_H_
