#ifndef TRILOBE_APP_FIT_JOBS_H_
#define TRILOBE_APP_FIT_JOBS_H_

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/fit_page.h"
#include "app/fit_run.h"
#include "app/result_folder.h"

// Fits that one command runs side by side, each on a thread of its own, into a folder each.

namespace trilobe {

// The measurements of a command, folders replaced by what is in them. Each becomes a folder of its
// own, so names must differ. Throws Error.
std::vector<FitOutcome> ListSources(std::span<const std::string> arguments);

// Numbers of the jobs, out of so many, that --shard leaves. Throws Error for a bad value.
std::vector<size_t> JobsOfShard(size_t count_of_jobs);

// Fills an outcome from a report.json. Throws Json::exception for one of another version.
void TakeReport(const nlohmann::ordered_json& report, FitOutcome* outcome);

// Fits outcome->source on one thread into a folder, unless its whole result is there. Fills the
// outcome. Throws Error if the fit fails.
void FitOrKeep(const FitSettings& settings, ResultFolder* folder, FitOutcome* outcome);

// Makes jobs side by side, `at_once` of them, with progress by the name of `things`. `make` makes
// one; what it throws becomes the error of its outcome, which has failed then. `tell` is called as
// each ends, one at a time, with how many have ended. After Ctrl-C none begins.
void MakeJobs(size_t count, int at_once, const std::string& things,
              const std::function<FitOutcome&(size_t k)>& outcome_of,
              const std::function<void(size_t k)>& make,
              const std::function<void(size_t k, size_t done)>& tell);

// Why a fit failed, for tables and pages, which may go to others: without names of folders.
std::string ErrorToSend(const std::string& error, const FitOutcome& outcome,
                        const std::string& out);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_JOBS_H_
