#ifndef TRILOBE_FIT_REPORTS_LIGHT_REPORT_H_
#define TRILOBE_FIT_REPORTS_LIGHT_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trilobe/model/lobes/lobe_light.h"

namespace trilobe {

// "lobe 1 62 %, lobe 2 20 %, diffuse 18 %".
std::string Describe(const LobeLight& light);

// "light" in report.json and of `info --json`: albedo and share of the diffuse term and of each
// lobe.
nlohmann::ordered_json ToJson(const LobeLight& light);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_LIGHT_REPORT_H_
