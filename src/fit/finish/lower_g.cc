#include "fit/finish/lower_g.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "trilobe/core/math/angles.h"

namespace trilobe {

double FactorOfG(const Rgb& albedo, const Rgb& limit, std::span<const double> d) {
  constexpr double kTolerance = 1e-3;  // of DirectionalAlbedo
  double factor = 1;
  for (int c = 0; c < kChannels; ++c) {
    const double diffuse = kPi * d[c];
    if (!(albedo[c] > (1 + kTolerance) * limit[c]) || !(limit[c] > diffuse)) continue;
    factor = std::min(factor, std::sqrt((limit[c] - diffuse) / (albedo[c] - diffuse)));
  }
  return factor;
}

bool LowerWhileExceeding(size_t begin, size_t end, int passes, const StopCheck& stop,
                         const FactorsAt& factors_at, const LowerBy& lower_by) {
  std::vector<size_t> exceeding(end - begin);
  std::iota(exceeding.begin(), exceeding.end(), begin);
  bool changed = false;
  for (int pass = 0; pass < passes && !stop(); ++pass) {
    const std::vector<double> asked = factors_at(exceeding);
    std::vector<double> factors(end, 1.0);
    std::vector<size_t> left;
    for (size_t j = 0; j < exceeding.size(); ++j) {
      if (!(asked[j] < 1)) continue;
      factors[exceeding[j]] = asked[j];
      left.push_back(exceeding[j]);
    }
    if (left.empty()) break;
    lower_by(factors);
    exceeding = std::move(left);
    changed = true;
  }
  return changed;
}

}  // namespace trilobe
