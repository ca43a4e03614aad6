#ifndef TRILOBE_IO_FORMATS_TEXT_GIVEN_ANGLES_H_
#define TRILOBE_IO_FORMATS_TEXT_GIVEN_ANGLES_H_

#include <optional>
#include <string_view>

namespace trilobe {

// Theta_i and phi_i [rad] that text gives to the rows below it.
struct AnglesInText {
  std::optional<double> theta_i, phi_i;
  explicit operator bool() const { return theta_i || phi_i; }
};

// Those of a line: "Incidence angle: 30 deg", "# theta_i = 30, phi_i = 90", "AOI;30". Each number
// stands behind a name, and its unit behind it; other quantities may stand beside them behind "=".
AnglesInText AnglesInLine(std::string_view line);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_GIVEN_ANGLES_H_
