#include "model/appearance/color.h"

#include <algorithm>
#include <cmath>

namespace trilobe {

double Luminance(const Rgb& linear) {
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
}

double EncodeSrgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

double LinearizeSrgb(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

Lab ToLab(const Rgb& linear) {
  // Rows over the tristimulus values of white, which so are 1 for it (IEC 61966-2-1).
  constexpr double kX[] = {0.4124, 0.3576, 0.1805}, kZ[] = {0.0193, 0.1192, 0.9505};
  const double x = (kX[0] * linear[0] + kX[1] * linear[1] + kX[2] * linear[2]) / 0.9505;
  const double y = Luminance(linear);
  const double z = (kZ[0] * linear[0] + kZ[1] * linear[1] + kZ[2] * linear[2]) / 1.089;
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

double LabDifference(const Lab& a, const Lab& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace trilobe
