#ifndef TRILOBE_FIT_REPORTS_BIN_COUNTS_H_
#define TRILOBE_FIT_REPORTS_BIN_COUNTS_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {

// Why bins of a measurement are left out, and how many: all reasons, the same everywhere.
struct LeftOut {
  std::string reason;  // "below the surface"
  std::string key;     // of the same in JSON
  int bins = 0;
};
std::vector<LeftOut> ReasonsOf(const BinCounts& counts);

// "361784 below the surface, 12 lost (negative)": those that there are, or "none".
std::string LeftOutText(const BinCounts& counts);

// {"total": ..., "valid": ..., "below_surface": ..., ...}.
nlohmann::ordered_json ToJson(const BinCounts& counts);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_BIN_COUNTS_H_
