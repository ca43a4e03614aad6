#ifndef TRILOBE_APP_STUDY_RECORD_H_
#define TRILOBE_APP_STUDY_RECORD_H_

#include <span>
#include <string>

#include "app/study_jobs.h"

// study.json: of which runs the tables of a folder are. By it one study does not write over
// another.

namespace trilobe {

// Throws Error if `out` holds results of another study, which this one would replace: a run of
// other settings, or tables of runs that this one has not. More runs, solvers or values of the same
// flags are the same study.
void CheckSameStudy(const std::string& out, std::span<const StudyJob> jobs);

// The text of study.json. `command`: by which the study is made again.
std::string StudyRecord(std::span<const StudyJob> jobs, const std::string& command);

}  // namespace trilobe

#endif  // TRILOBE_APP_STUDY_RECORD_H_
