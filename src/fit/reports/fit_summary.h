#ifndef TRILOBE_FIT_REPORTS_FIT_SUMMARY_H_
#define TRILOBE_FIT_REPORTS_FIT_SUMMARY_H_

#include "fit/reports/fit_report.h"

namespace trilobe {

// The verdict, then a few lines that need no knowledge of the method, on standard output.
void PrintSummary(const FitReport& report);

// Where the time went, in parts that sum to the total.
void PrintSeconds(const FitReport& report);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_FIT_SUMMARY_H_
