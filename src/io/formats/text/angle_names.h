#ifndef TRILOBE_IO_FORMATS_TEXT_ANGLE_NAMES_H_
#define TRILOBE_IO_FORMATS_TEXT_ANGLE_NAMES_H_

#include <optional>
#include <string>
#include <string_view>

#include "io/formats/text/column_role.h"

namespace trilobe {

// What the name of an angle says, "Sun elevation" or "relative azimuth".
struct AngleName {
  ColumnRole role;
  bool from_horizon = false;   // 90 degrees minus theta
  bool is_difference = false;  // of two azimuths
  bool is_word = false;        // "detector" alone, which may be of something else, too
};

// `plain`: the plain name, without its unit. None for what names no angle.
std::optional<AngleName> AngleNamed(std::string_view plain);

// Whether a name has a word for an azimuth, "Stage azimuth 2", whatever else it says.
bool HasAzimuthWord(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_ANGLE_NAMES_H_
