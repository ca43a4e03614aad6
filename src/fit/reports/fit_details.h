#ifndef TRILOBE_FIT_REPORTS_FIT_DETAILS_H_
#define TRILOBE_FIT_REPORTS_FIT_DETAILS_H_

#include <nlohmann/json_fwd.hpp>

#include "fit/reports/fit_report.h"

namespace trilobe {

// Prints the report without verdict and times on standard output.
void PrintDetails(const FitReport& report);

// report.json (docs/file-formats.md).
nlohmann::ordered_json ToJson(const FitReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_FIT_DETAILS_H_
