#ifndef TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_
#define TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trilobe/model/appearance/appearance.h"

namespace trilobe {

// Lines of a table, each ending in a newline: all of them, or those for readers new to the method.
std::string Describe(const AppearanceReport& report);
std::string DescribeBriefly(const AppearanceReport& report);

// "appearance" in report.json (docs/file-formats.md).
nlohmann::ordered_json ToJson(const AppearanceReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_
