#ifndef TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_
#define TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "model/appearance/verdict.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {

// What a report says first.
struct ReportedVerdict {
  SeenError seen;
  bool of_sphere = true;  // or of samples (CompareSamples)
  Verdict verdict;
  FitFacts facts;
  std::vector<Advice> advice;
};

// Of the sphere, where there is one, or else of samples; one of the two is there.
ReportedVerdict MakeVerdict(const std::optional<AppearanceReport>& appearance,
                            const std::optional<SeenError>& samples, const FitFacts& facts);

// A line for the verdict and one for each advice, each with its newline.
std::string Describe(const ReportedVerdict& reported);

// Of E, what exchanged directions differ by in the data; 0 to 1.
double IrreducibleShare(const ScoreReport& score);

// "5.6 %", and what it is a mean of.
std::string RelativeErrorText(double mean_relative_error);

// "verdict" in report.json and of `score --json` (docs/file-formats.md).
nlohmann::ordered_json ToJson(const ReportedVerdict& reported);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_
