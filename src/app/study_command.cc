// `trilobe study`: the same measurements fitted by several solvers from several starting points.

#include <gflags/gflags.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/command.h"
#include "app/fit_jobs.h"
#include "app/fit_settings.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/model_flags.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "app/solver_flags.h"
#include "app/study_page.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/study/draw_study.h"
#include "fit/study/study.h"
#include "io/pictures/gnuplot.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/io/model_files/trace_file.h"
#include "trilobe/solvers/registry/solvers.h"

DECLARE_string(shard);
DEFINE_string(solvers, "auto,awls,lm", "the solvers to compare, by name");
DEFINE_int32(
    runs, 5,
    "runs of each solver on each problem: the first from the start --init, the others from "
    "random ones, --init=random with the seeds 2, 3, ...");
DEFINE_string(set, "",
              "FLAG=a,b,c: run with each of these values of a flag of `fit`; several flags are "
              "separated by ; and values with commas in them by |. A flag that only some solvers "
              "read is varied for these");

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kRunsName = "runs.csv";
constexpr const char* kMethodsName = "methods.csv";
constexpr const char* kTracesName = "traces.csv";
constexpr const char* kStudyPageName = "index.html";
constexpr const char* kFilesOfStudy[] = {kStudyPageName, kRunsName, kMethodsName, kTracesName};

// The parts without blanks around them.
std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    const size_t begin = part.find_first_not_of(' ');
    parts.push_back(begin == std::string::npos
                        ? ""
                        : part.substr(begin, part.find_last_not_of(' ') + 1 - begin));
  }
  return parts;
}

// --- What is to be run
// ----------------------------------------------------------------------------

// A flag of --set, and its values.
struct Sweep {
  std::string flag;
  std::vector<std::string> values;
};

// Flags that this command sets itself.
constexpr const char* kFlagsOfStudy[] = {
    "solver",      "seed",    "data_seed", "out",   "shard",   "plots",  "reconstruction",
    "convergence", "threads", "scene",     "cache", "nocache", "verbose"};

std::vector<std::string> FlagsToSet() {
  std::vector<std::string> flags = FitFlags();
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  for (const char* const flag : kFlagsOfStudy) std::erase(flags, flag);
  return flags;
}

std::vector<Sweep> SweepsFromFlags() {
  std::vector<Sweep> sweeps;
  const std::vector<std::string> known = FlagsToSet();
  for (const std::string& part : Split(FLAGS_set, ';')) {
    const size_t equals = part.find('=');
    const std::string flag = part.substr(0, equals);
    const std::string values = equals == std::string::npos ? "" : part.substr(equals + 1);
    if (std::ranges::find(known, flag) == known.end()) {
      throw Error("--set=" + part + ": '" + flag +
                  "' is no flag of fit that can be varied; write FLAG=a,b,c");
    }
    if (values.empty()) throw Error("--set=" + part + ": give values, as in FLAG=a,b,c");
    if (!IsDefault(flag)) throw Error("--" + flag + " and --set=" + part + ": give one of them");
    if (std::ranges::find(sweeps, flag, &Sweep::flag) != sweeps.end()) {
      throw Error("--set varies --" + flag + " twice; give all values at once, as in FLAG=a,b,c");
    }
    sweeps.push_back({flag, Split(values, values.find('|') == std::string::npos ? ',' : '|')});
  }
  return sweeps;
}

// Throws Error for a flag that none of the solvers reads.
void CheckThatSomeSolverReads(const std::vector<Sweep>& sweeps,
                              const std::vector<const SolverEntry*>& solvers) {
  const std::vector<std::string> particular = ParticularSolverFlags();
  for (const auto& [flag, values] : sweeps) {
    if (std::ranges::find(particular, flag) == particular.end()) continue;
    const auto takes = [&flag = flag](const SolverEntry* solver) {
      return TakesFlag(*solver, flag);
    };
    if (std::ranges::any_of(solvers, takes)) continue;
    throw Error("--set varies --" + flag +
                ", which none of --solvers reads; see `trilobe solvers`");
  }
}

// Whether E of fits with different values of the flag is of other data or weights.
bool ChangesProblem(const std::string& flag) {
  const std::vector<std::string> flags = WithSourceFlags({"weighting", "prior"});
  return std::ranges::find(flags, flag) != flags.end();
}

// A choice of a value for each flag that is varied.
using Values = std::vector<std::pair<std::string, std::string>>;

// All choices for a solver.
std::vector<Values> ChoicesFor(const SolverEntry& solver, const std::vector<Sweep>& sweeps) {
  std::vector<Values> choices = {{}};
  const std::vector<std::string> particular = ParticularSolverFlags();
  for (const Sweep& sweep : sweeps) {
    const bool of_some = std::ranges::find(particular, sweep.flag) != particular.end();
    if (of_some && !TakesFlag(solver, sweep.flag)) continue;
    std::vector<Values> longer;
    for (const Values& choice : choices) {
      for (const std::string& value : sweep.values) {
        longer.push_back(choice);
        longer.back().emplace_back(sweep.flag, value);
      }
    }
    choices = std::move(longer);
  }
  return choices;
}

// "dogleg", but "g_filter=1" and "raw=false", which do not tell what they are of.
std::string Label(const std::string& flag, const std::string& value) {
  const bool tells = std::isalpha(static_cast<unsigned char>(value[0])) != 0 && value != "true" &&
                     value != "false";
  return tells ? value : flag + "=" + value;
}

struct Job {
  StudyRun run;
  std::string folder_of_problem;
  FitOutcome outcome;
  FitSettings settings;
};

void SetFlag(const std::string& flag, const std::string& value) {
  if (gflags::SetCommandLineOption(flag.c_str(), value.c_str()).empty()) {
    throw Error("--set: --" + flag + "=" + value + " is no value of this flag");
  }
}

// The settings of `trilobe fit` with these flags.
FitSettings SettingsOf(const std::string& solver, const Values& values, int start) {
  const gflags::FlagSaver as_given;
  if (IsDefault("data_seed")) SetFlag("data_seed", std::to_string(FLAGS_seed));  // for all starts
  SetFlag("solver", solver);
  // What a solver found, without what would follow it. As to auto's choice of a form, that is it.
  if (IsDefault("raw") && !ChoosesModel()) SetFlag("raw", "true");
  for (const auto& [flag, value] : values) SetFlag(flag, value);
  if (start > 1) {
    SetFlag("init", "random");
    SetFlag("seed", std::to_string(FLAGS_seed + start - 1));
  }
  return FitSettingsFromFlags();
}

// What follows the name of a source or a solver, as the end of the name of its folder.
std::string AsName(std::string labels) {
  std::ranges::replace(labels, '/', '_');
  std::ranges::replace(labels, ' ', ',');
  return labels;
}

// Throws Error where nothing is to be read.
void CheckSource(const std::string& source) {
  std::error_code ignored;
  if (IsSynthetic(source) || fs::exists(source, ignored)) return;
  throw Error("cannot read '" + source + "': no such file");
}

// Throws Error for a folder that is taken.
void CheckFolder(const Job& job, std::set<std::string>* folders) {
  for (const char* const taken : kFilesOfStudy) {
    if (job.folder_of_problem == taken) {
      throw Error("'" + job.folder_of_problem +
                  "' is the name of a file of the study; rename the source");
    }
  }
  if (!folders->insert(job.run.folder).second) {
    throw Error("'" + job.run.problem + "' by '" + job.run.method +
                "' is asked for twice; name each solver and value once");
  }
}

std::vector<Job> JobsFromFlags(std::span<const std::string> arguments) {
  if (FLAGS_runs < 1 || FLAGS_runs > 10000) throw Error("--runs must be from 1 to 10000");
  const std::vector<Sweep> sweeps = SweepsFromFlags();
  std::vector<const SolverEntry*> solvers;
  for (const std::string& name : Split(FLAGS_solvers, ',')) solvers.push_back(&FindSolver(name));
  if (solvers.empty()) throw Error("--solvers is empty; name some, as auto,awls,lm");
  CheckThatSomeSolverReads(sweeps, solvers);
  // Random starts are the same for all values of --init.
  const bool varies_start = std::ranges::find(sweeps, "init", &Sweep::flag) != sweeps.end();
  const int runs = varies_start ? 1 : FLAGS_runs;
  std::vector<Job> jobs;
  std::set<std::string> folders, told;
  for (const FitOutcome& source : ListSources(arguments)) {
    CheckSource(source.source);
    for (const SolverEntry* solver : solvers) {
      for (const Values& values : ChoicesFor(*solver, sweeps)) {
        std::string of_problem, of_method;
        for (const auto& [flag, value] : values) {
          (ChangesProblem(flag) ? of_problem : of_method) += " " + Label(flag, value);
        }
        for (int start = 1; start <= runs; ++start) {
          Job job;
          job.settings = SettingsOf(solver->name, values, start);
          job.run = {.problem = source.name + of_problem,
                     .method = solver->name + of_method,
                     .start = start,
                     .folder = ""};
          job.folder_of_problem = source.name + AsName(of_problem);
          job.run.folder = job.folder_of_problem + "/" + solver->name + AsName(of_method) +
                           "/start-" + std::to_string(start);
          CheckFolder(job, &folders);
          // Of the runs on the same data, the first tells what was noticed of them.
          job.settings.tell_notes = told.insert(job.folder_of_problem).second;
          job.outcome = {.name = job.run.folder, .source = source.source};
          jobs.push_back(std::move(job));
        }
      }
    }
  }
  return jobs;
}

// --- What came out
// --------------------------------------------------------------------------------

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
void MakeRun(Job* job, ResultFolder* folder) {
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
  std::vector<std::string> flags = FlagsToSet();
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
      std::vector<StudyRun> own;
      std::ranges::copy_if(runs, std::back_inserter(own),
                           [&](const StudyRun& run) { return run.problem == task.problem; });
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
void Gather(std::vector<Job> jobs, std::span<const std::string> arguments,
            const ResultFolder& summary) {
  std::vector<StudyRun> runs;
  StudyPageContents contents;
  contents.command = CommandText(arguments);
  contents.tables = {kRunsName, kMethodsName, kTracesName};
  for (Job& job : jobs) {
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

void PrintRun(const Job& job, size_t done, size_t count) {
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

int RunStudy(std::span<const std::string> arguments) {
  const std::string out = FLAGS_out.empty() ? "out/study" : FLAGS_out;
  std::vector<Job> jobs = JobsFromFlags(arguments);
  std::vector<std::string> read;
  for (const Job& job : jobs) {
    read.push_back(job.outcome.source);
    read.insert(read.end(), job.settings.inputs.begin(), job.settings.inputs.end());
  }
  const Inputs inputs(read);
  std::vector<ResultFolder> folders;
  for (const Job& job : jobs) {
    folders.emplace_back(out + "/" + job.run.folder, FitFileNames(), FitFolderMarks(), inputs);
  }
  const std::vector<std::string> names(std::begin(kFilesOfStudy), std::end(kFilesOfStudy));
  const ResultFolder summary(out, names, names, inputs);
  summary.Open();

  const std::vector<size_t> shard = JobsOfShard(jobs.size());
  const InterruptGuard guard;
  {
    JobProgress progress(shard.size(), "runs");
    std::mutex mutex;
    size_t done = 0;
    ParallelJobs(static_cast<int>(shard.size()), ThreadsFromFlags(), [&](int k) {
      if (InterruptGuard::signal() != 0) return;
      Job& job = jobs[shard[k]];
      try {
        MakeRun(&job, &folders[shard[k]]);
      } catch (const std::exception& exception) {
        job.outcome.state = FitOutcome::State::kFailed;
        job.run.error = ErrorToSend(MessageOf(exception), job.outcome, out);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      progress.Clear();
      PrintRun(job, ++done, shard.size());
      progress.Done(job.outcome.name, job.outcome.state != FitOutcome::State::kKept);
    });
  }
  if (InterruptGuard::signal() != 0) {
    std::cout << "interrupted  the same command goes on with what is missing\n";
    return 128 + InterruptGuard::signal();
  }
  const bool whole = FLAGS_shard.empty();
  const bool failed = std::ranges::any_of(jobs, [](const Job& job) { return job.run.failed(); });
  if (whole) Gather(std::move(jobs), arguments, summary);
  std::cout << "written      a folder for each run" << (whole ? ", the tables and " : "")
            << (whole ? kStudyPageName : "") << " in " << Printable(out) << "\n";
  return failed ? kSomeFailed : 0;
}

}  // namespace

Command StudyCommand() {
  std::vector<std::string> flags = FlagsToSet();
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
