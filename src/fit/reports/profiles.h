#ifndef TRILOBE_FIT_REPORTS_PROFILES_H_
#define TRILOBE_FIT_REPORTS_PROFILES_H_

#include <span>
#include <string>
#include <vector>

#include "fit/reports/study.h"

namespace trilobe {

// Profiles compare methods over problems: the share of runs that have come within kAsGood of the
// lowest E of their problem, over the time that this took. A run that failed, or that never came so
// near, counts as one that takes forever. Intervals are Wilson's, of as many independent trials as
// there are problems, since the starts of one problem are not independent.
struct Profile {
  // The share up to the next point.
  struct Point {
    double x = 0, share = 0;
    Interval interval = {};
  };
  std::string method;
  std::vector<Point> points;  // x ascends
};

// The least number of problems for which there are profiles.
inline constexpr size_t kFewestProblems = 3;

// Performance profiles (Dolan and More 2002): x is the time over the least that any method took
// from the same start of the same problem, from 1 on. Needs CompareRuns.
std::vector<Profile> PerformanceProfiles(std::span<const StudyRun> runs);

// Data profiles (More and Wild 2009), x in seconds: all methods pay for each other's evaluations
// alike only in time.
std::vector<Profile> DataProfiles(std::span<const StudyRun> runs);

// Both as CSV; the header alone for fewer problems than kFewestProblems.
std::string ProfilesCsv(std::span<const StudyRun> runs);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_PROFILES_H_
