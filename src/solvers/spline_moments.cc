#include "trilobe/solvers/spline_moments.h"

#include <cstring>

#include "trilobe/base/multiversion.h"

namespace trilobe {

TRILOBE_MULTIVERSION
void AddSplineMoments(int count, const double* w1, const double* w2, const double* t_i,
                      const double* t_o, SplineMoments* moments) {
  // 11 vector multiply-adds a sample: the 4 x 4 and 7 x 7 sums live in registers.
  Lanes4 first[SplineMoments::kFirst];
  Lanes8 second[SplineMoments::kSecond];
  std::memcpy(first, moments->first, sizeof(first));
  std::memcpy(second, moments->second, sizeof(second));
  for (int n = 0; n < count; ++n) {
    const double t = t_i[n], t2 = t * t, t3 = t2 * t;
    const Lanes4 low = {1, t, t2, t3};
    const Lanes8 all = {1, t, t2, t3, t2 * t2, t2 * t3, t3 * t3, 0};
    double scale = w1[n];
    for (Lanes4& sum : first) {
      sum += scale * low;
      scale *= t_o[n];
    }
    scale = w2[n];
    for (Lanes8& sum : second) {
      sum += scale * all;
      scale *= t_o[n];
    }
  }
  std::memcpy(moments->first, first, sizeof(first));
  std::memcpy(moments->second, second, sizeof(second));
}

}  // namespace trilobe
