#ifndef TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_
#define TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trilobe/model/appearance/appearance.h"

namespace trilobe {

// Some lines of a table, each with its newline: all, or what needs no knowledge of the method.
std::string Describe(const AppearanceReport& report);
std::string DescribeBriefly(const AppearanceReport& report);

// "appearance" in report.json (docs/file-formats.md).
nlohmann::ordered_json ToJson(const AppearanceReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_APPEARANCE_REPORT_H_
