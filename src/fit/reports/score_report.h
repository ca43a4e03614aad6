#ifndef TRILOBE_FIT_REPORTS_SCORE_REPORT_H_
#define TRILOBE_FIT_REPORTS_SCORE_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "fit/reports/verdict_report.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {

// A comparison by `trilobe score`.
struct Scored {
  std::string model;  // path
  ScoreReport score;
  std::optional<AppearanceReport> appearance = {};
  ReportedVerdict verdict = {};
};

// JSON of `score --json`; `objective` has the samples.
nlohmann::ordered_json ToJson(const Scored& scored, const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_SCORE_REPORT_H_
