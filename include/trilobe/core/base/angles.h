#ifndef TRILOBE_CORE_BASE_ANGLES_H_
#define TRILOBE_CORE_BASE_ANGLES_H_

#include <numbers>

namespace trilobe {

inline constexpr double kPi = std::numbers::pi;

inline constexpr double DegreesToRadians(double degrees) { return degrees * (kPi / 180); }
inline constexpr double RadiansToDegrees(double radians) { return radians * (180 / kPi); }

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_ANGLES_H_
