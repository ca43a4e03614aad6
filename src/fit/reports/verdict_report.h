#ifndef TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_
#define TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "model/appearance/verdict.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {

// The verdict at the beginning of a report.
struct ReportedVerdict {
  SeenError seen;
  bool of_sphere = true;  // false: of samples (CompareSamples)
  Verdict verdict;
  FitFacts facts;
  std::vector<Advice> advice;
};

// Evidence for a verdict on a model with `parameters`; 0 if it was not fitted to these samples.
Basis BasisOf(const BrdfSamples& samples, int parameters);

// Judges the sphere, or else the samples; one of the two must be given.
ReportedVerdict MakeVerdict(const std::optional<AppearanceReport>& appearance,
                            const std::optional<SeenError>& samples, const Basis& basis,
                            const FitFacts& facts);

// A line for the verdict and one for each advice, each ending in a newline.
std::string Describe(const ReportedVerdict& reported);

// Fraction of E due to differences between exchanged directions in the data, 0 to 1.
double IrreducibleShare(const ScoreReport& score);

// Text such as "5.6 %", with what it is the mean of.
std::string RelativeErrorText(double mean_relative_error);

// "verdict" in report.json and of `score --json` (docs/file-formats.md).
nlohmann::ordered_json ToJson(const ReportedVerdict& reported);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_VERDICT_REPORT_H_
