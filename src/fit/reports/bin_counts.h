#ifndef TRILOBE_FIT_REPORTS_BIN_COUNTS_H_
#define TRILOBE_FIT_REPORTS_BIN_COUNTS_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {

// Number of bins of a measurement left out for a reason.
struct LeftOut {
  std::string reason;  // "below the surface"
  std::string key;     // in JSON
  int bins = 0;
};
std::vector<LeftOut> ReasonsOf(const BinCounts& counts);

// "361784 below the surface, 12 lost (negative)", or "none".
std::string LeftOutText(const BinCounts& counts);

// {"total": ..., "valid": ..., "below_surface": ..., ...}.
nlohmann::ordered_json ToJson(const BinCounts& counts);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_BIN_COUNTS_H_
