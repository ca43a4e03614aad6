// `trilobe study`: the same measurements fitted by several solvers from several starting points.

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "app/command.h"
#include "app/fit_jobs.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/result_folder.h"
#include "app/solver_flags.h"
#include "app/study_jobs.h"
#include "app/study_page.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/study/draw_study.h"
#include "fit/study/study.h"
#include "io/pictures/gnuplot.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/io/model_files/trace_file.h"

DECLARE_string(shard);
namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Reads what a fit left.
void ReadRun(const ResultFolder& folder, StudyRun* run) {
  const std::string path = folder.PathOf("report.json");
  const Json report = Json::parse(ReadJsonText(path, path + ": not a report"));
  run->stop_reason = report.at("stop_reason");
  const Json& seconds = report.at("seconds");
  double before = 0;  // the solver begins
  for (const char* const phase : {"prepare", "init", "nodes"}) {
    before += seconds.at(phase).get<double>();
  }
  run->seconds = before + seconds.at("solve").get<double>();
  if (const Json& sphere = report.at("appearance"); !sphere.is_null()) {
    if (!sphere.at("psnr_db").is_null()) run->psnr_db = sphere.at("psnr_db").get<double>();
    run->mean_delta_e = sphere.at("mean_delta_e").get<double>();
  }
  run->trace = ReadTrace(folder.PathOf("trace.csv"));
  for (IterationRecord& record : run->trace) record.seconds += before;
  run->file = ReadModel(folder.PathOf("model.json"));
}

// Fits, or keeps what is there, and reads it. Throws Error if either fails.
void MakeRun(StudyJob* job, ResultFolder* folder) {
  FitOrKeep(job->settings, folder, &job->outcome);
  if (!job->outcome.has_model()) return;
  const StudyRun planned = job->run;
  try {
    ReadRun(*folder, &job->run);
    return;
  } catch (const std::exception&) {
    if (job->outcome.state != FitOutcome::State::kKept) throw;
  }
  // A file of it was damaged since.
  job->run = planned;
  fs::remove(folder->PathOf("report.json"));
  FitOrKeep(job->settings, folder, &job->outcome);
  ReadRun(*folder, &job->run);
}

// "trilobe study nylon.binary --runs=3", with the sources as they were typed.
std::string CommandText(std::span<const std::string> arguments) {
  std::string text = "trilobe study";
  for (const std::string& argument : arguments) text += " " + argument;
  std::vector<std::string> flags = StudyFlags();
  flags.insert(flags.end(), {"seed", "data_seed", "solvers", "runs", "set"});
  for (const auto& [flag, value] : GivenFlags(flags)) {
    const bool plain = value.find_first_of(" ;|&'\"$*?<>()") == std::string::npos;
    text += " --" + flag + "=" + (plain ? value : "'" + value + "'");
  }
  return text;
}

// Draws the figures of all problems; says on standard error if it cannot.
void DrawFigures(const std::vector<StudyRun>& runs, const std::string& out, int threads,
                 StudyPageContents* contents) {
  if (!HaveGnuplot()) {
    std::cerr << "trilobe: no pictures, as gnuplot is not installed\n";
    return;
  }
  struct Task {
    std::string problem;
    const StudyFigure* figure;
    bool drawn = false;
  };
  std::vector<Task> tasks;
  for (const std::string& problem : ProblemsOf(runs)) {
    for (const StudyFigure& figure : StudyFigures()) tasks.push_back({problem, &figure});
  }
  std::mutex mutex;
  std::string failure;
  ParallelJobs(static_cast<int>(tasks.size()), threads, [&](int k) {
    Task& task = tasks[k];
    try {
      const std::vector<StudyRun> own = RunsOn(task.problem, runs);
      const std::string folder = out + "/" + contents->folder_of.at(task.problem);
      MakeDirectories(folder);
      task.drawn = DrawStudyFigure(*task.figure, own, folder);
    } catch (const Error& error) {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = error.what();
    }
  });
  for (const Task& task : tasks) {
    if (task.drawn) contents->figures[task.problem].push_back(task.figure);
  }
  if (!failure.empty()) {
    std::cerr << "trilobe: pictures are missing: " << Printable(failure) << "\n";
  }
}

void PrintStudy(const std::vector<StudyRun>& runs) {
  const std::vector<std::string> problems = ProblemsOf(runs);
  const std::vector<MethodSummary> summaries = SummariesOf(runs);
  for (const std::string& problem : problems) {
    std::vector<MethodSummary> own;
    std::ranges::copy_if(summaries, std::back_inserter(own),
                         [&](const MethodSummary& of) { return of.problem == problem; });
    std::cout << "\n" << Printable(problem) << "\n" << MethodsText(own);
  }
  std::cout << "\n";
  for (const std::string& sentence : VerdictOn(runs)) std::cout << Printable(sentence) << "\n";
}

// Tables, figures and the page of all runs, and what is printed.
void Gather(std::vector<StudyJob> jobs, std::span<const std::string> arguments,
            const ResultFolder& summary) {
  std::vector<StudyRun> runs;
  StudyPageContents contents;
  contents.command = CommandText(arguments);
  contents.tables = {kRunsName, kMethodsName, kTracesName};
  for (StudyJob& job : jobs) {
    contents.folder_of[job.run.problem] = job.folder_of_problem;
    runs.push_back(std::move(job.run));
  }
  CompareRuns(&runs);
  DrawFigures(runs, summary.path(), ThreadsFromFlags(), &contents);
  const auto write = [&](const char* name, const std::string& text) {
    WriteFile(summary.PathOf(name), [&](std::ostream& out) { out << text; });
  };
  write(kRunsName, RunsCsv(runs));
  write(kMethodsName, MethodsCsv(SummariesOf(runs)));
  write(kTracesName, TracesCsv(runs));
  write(kStudyPageName, StudyPage(runs, contents));
  PrintStudy(runs);
}

void PrintRun(const StudyJob& job, size_t done, size_t count) {
  const FitOutcome& outcome = job.outcome;
  std::cout << "[" << done << "/" << count << "] " << Printable(job.run.problem) << ", "
            << Printable(job.run.method) << ", start " << job.run.start << ": "
            << StateName(outcome.state);
  if (outcome.has_model()) {
    std::cout << ", E " << Text(job.run.objective(), 6) << ", " << Text(job.run.seconds, 3) << " s";
  }
  if (!job.run.error.empty()) std::cout << ": " << Printable(job.run.error);
  std::cout << std::endl;
}

// Throws Error where the figures may not be written.
void CheckFigures(const std::vector<StudyJob>& jobs, const std::string& out, const Inputs& inputs) {
  std::set<std::string> folders;
  for (const StudyJob& job : jobs) folders.insert(job.folder_of_problem);
  for (const std::string& folder : folders) {
    for (const StudyFigure& figure : StudyFigures()) {
      for (const char* const ending : {".svg", ".pdf"}) {
        inputs.CheckOutput(out + "/" + folder + "/" + figure.name + ending);
      }
    }
  }
}

int RunStudy(std::span<const std::string> arguments) {
  const std::string out = FLAGS_out.empty() ? "out/study" : FLAGS_out;
  std::vector<StudyJob> jobs = StudyJobsFromFlags(arguments);
  std::vector<std::string> read;
  for (const StudyJob& job : jobs) {
    read.push_back(job.outcome.source);
    read.insert(read.end(), job.settings.inputs.begin(), job.settings.inputs.end());
  }
  const Inputs inputs(read);
  std::vector<ResultFolder> folders;
  for (const StudyJob& job : jobs) {
    folders.emplace_back(out + "/" + job.run.folder, FitFileNames(), inputs);
  }
  const std::vector<std::string> names(std::begin(kFilesOfStudy), std::end(kFilesOfStudy));
  const ResultFolder summary(out, names, inputs);
  if (FLAGS_shard.empty()) CheckFigures(jobs, out, inputs);
  summary.Open();

  const std::vector<size_t> shard = JobsOfShard(jobs.size());
  const InterruptGuard guard;
  MakeJobs(
      shard.size(), "runs", [&](size_t k) -> FitOutcome& { return jobs[shard[k]].outcome; },
      [&](size_t k) { MakeRun(&jobs[shard[k]], &folders[shard[k]]); },
      [&](size_t k, size_t done) {
        StudyJob& job = jobs[shard[k]];
        if (!job.outcome.error.empty()) {
          job.run.error = ErrorToSend(job.outcome.error, job.outcome, out);
        }
        PrintRun(job, done, shard.size());
      });
  if (InterruptGuard::signal() != 0) {
    std::cout << "interrupted  the same command goes on with what is missing\n";
    return 128 + InterruptGuard::signal();
  }
  const bool whole = FLAGS_shard.empty();
  const bool failed =
      std::ranges::any_of(jobs, [](const StudyJob& job) { return job.run.failed(); });
  if (whole) Gather(std::move(jobs), arguments, summary);
  std::cout << "written      a folder for each run" << (whole ? ", the tables and " : "")
            << (whole ? kStudyPageName : "") << " in " << Printable(out) << "\n";
  return failed ? kSomeFailed : 0;
}

}  // namespace

Command StudyCommand() {
  std::vector<std::string> flags = StudyFlags();
  for (const std::string& flag : ParticularSolverFlags()) std::erase(flags, flag);
  flags.insert(flags.begin(),
               {"solvers", "runs", "set", "out", "shard", "threads", "seed", "data_seed"});
  return {.name = "study",
          .summary = "compare solvers on measurements, from several starts",
          .arguments = "SOURCE...",
          .min_arguments = 1,
          .max_arguments = std::numeric_limits<int>::max(),
          .details =
              "Fits each SOURCE, or each measurement of a folder, by each of the solvers from each "
              "of the starts, on\none thread each, and compares: who finds the lowest E, how "
              "often, how soon, whether E ever rose, whether\nthe lobes are the same, and whether "
              "it looks better. Models are what the solvers found (--raw); --noraw\nadds what "
              "`fit` does after them. Writes DIR/index.html (a page), DIR/runs.csv, methods.csv "
              "and traces.csv,\nDIR/PROBLEM/*.svg and *.pdf (figures), and a folder for each run, "
              "as `fit` does. Without --out DIR is\nout/study. Ctrl-C keeps what is finished; the "
              "same command goes on, and fits again only what has\nchanged. --shard=i/n shares the "
              "runs out between machines (docs/study.md).",
          .flags = flags,
          .run = RunStudy};
}

}  // namespace trilobe
