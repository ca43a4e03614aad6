#ifndef TRILOBE_APP_STUDY_JOBS_H_
#define TRILOBE_APP_STUDY_JOBS_H_

#include <span>
#include <string>
#include <vector>

#include "app/fit_page.h"
#include "app/fit_run.h"
#include "fit/reports/study.h"

namespace trilobe {

// Files of a study, beside the folders of its problems.
inline constexpr const char* kRunsName = "runs.csv";
inline constexpr const char* kMethodsName = "methods.csv";
inline constexpr const char* kTracesName = "traces.csv";
inline constexpr const char* kProfilesName = "profiles.csv";
inline constexpr const char* kStudyPageName = "index.html";
inline constexpr const char* kStudyRecordName = "study.json";
inline constexpr const char* kFilesOfStudy[] = {kStudyPageName,
                                                kRunsName,
                                                kMethodsName,
                                                kTracesName,
                                                kProfilesName,
                                                kStudyRecordName,
                                                "performance_profile.svg",
                                                "performance_profile.pdf",
                                                "data_profile.svg",
                                                "data_profile.pdf"};

// One run of a study, before it is made: its names, its fit, and its outcome.
struct StudyJob {
  StudyRun run;
  std::string folder_of_problem;
  FitOutcome outcome;
  FitSettings settings;
};

// The flags of `trilobe fit` that a study may be given or may vary, those that only some solvers
// read among them.
std::vector<std::string> StudyFlags();

// Runs that are made at once: as many as --threads says, and one at a time, as times ask for, where
// it says nothing.
int RunsAtOnce();

// The limit that ends a run which does not converge, in words.
std::string LimitsText();

// Each source by each of --solvers, with each choice of values of --set, from each of --runs
// starts. Throws Error for flags that make no sense.
std::vector<StudyJob> StudyJobsFromFlags(std::span<const std::string> arguments);

}  // namespace trilobe

#endif  // TRILOBE_APP_STUDY_JOBS_H_
