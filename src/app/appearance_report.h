#ifndef TRILOBE_APP_APPEARANCE_REPORT_H_
#define TRILOBE_APP_APPEARANCE_REPORT_H_

#include <gflags/gflags_declare.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "trilobe/appearance/appearance.h"

// What lights the spheres of fit, score and plot.
DECLARE_string(probe);

namespace trilobe {

// The light of --probe, or the built-in one, and --threads. Reads the probe at the first call.
AppearanceOptions AppearanceOptionsFromFlags();

// Some lines of a table, each with its newline: all, or what needs no knowledge of the method.
std::string Describe(const AppearanceReport& report);
std::string DescribeBriefly(const AppearanceReport& report);

// "appearance" in report.json (docs/file-formats.md).
nlohmann::ordered_json ToJson(const AppearanceReport& report);

}  // namespace trilobe

#endif  // TRILOBE_APP_APPEARANCE_REPORT_H_
