#ifndef TRILOBE_APP_STRETCH_REPORT_H_
#define TRILOBE_APP_STRETCH_REPORT_H_

#include <nlohmann/json.hpp>

#include "trilobe/model/stretch.h"

namespace trilobe {

// As reports and `info` have it.
inline nlohmann::ordered_json ToJson(const Stretch& stretch) {
  return {{"along", stretch.along}, {"across", stretch.across}};
}

}  // namespace trilobe

#endif  // TRILOBE_APP_STRETCH_REPORT_H_
