// `trilobe study`: the same measurements fitted by several solvers from several starting points.

#include <gflags/gflags.h>

#include <algorithm>
#include <charconv>
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
#include "app/program.h"
#include "app/result_folder.h"
#include "app/solver_flags.h"
#include "app/study_jobs.h"
#include "app/study_page.h"
#include "app/study_record.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "core/files/text_lines.h"
#include "fit/reports/draw_study.h"
#include "fit/reports/profiles.h"
#include "fit/reports/study.h"
#include "io/pictures/gnuplot.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/trace_file.h"

DECLARE_string(shard);
namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::optional<double> NumberOr(const Json& value) {
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

// Reads what a fit left.
void ReadRun(const ResultFolder& folder, StudyRun* run) {
  const std::string path = folder.PathOf("report.json");
  const Json report = Json::parse(ReadJsonText(path, "not a report"));
  run->stop_reason = report.at("stop_reason");
  const Json& seconds = report.at("seconds");
  double before = 0;  // the solver begins
  for (const char* const phase : {"prepare", "init", "nodes"}) {
    before += seconds.at(phase).get<double>();
  }
  run->seconds = before + seconds.at("solve").get<double>() -
                 report.at("phases").at("diagnosing").get<double>();
  run->samples = report.at("valid_samples");
  run->parameters = report.at("stored_parameters");
  run->weighting = report.at("weighting");
  if (!report.at("diagnosis").is_null()) {
    run->optimality = NumberOr(report.at("diagnosis").at("optimality"));
  }
  run->relative_E = NumberOr(report.at("relative_objective"));
  if (const Json& repeats = report.at("repeats"); !repeats.is_null()) {
    run->noise_E = NumberOr(repeats.at("relative_objective"));
  }
  const Json& verdict = report.at("verdict");
  run->of_sphere = verdict.at("of") == "sphere";
  run->psnr_db = NumberOr(verdict.at("psnr_db"));
  run->mean_delta_e = NumberOr(verdict.at("mean_delta_e"));
  run->seen = VerdictOf({.mean_delta_e = verdict.at("mean_delta_e"),
                         .delta_e_95 = verdict.at("delta_e_95")})
                  .visibility != Visibility::kNone;
  if (const Json& held_out = report.at("held_out"); !held_out.is_null()) {
    run->held_out_E = NumberOr(held_out.at("relative_objective"));
    run->held_out_delta_e = NumberOr(held_out.at("mean_delta_e"));
  }
  run->date = report.at("date");
  run->processor = report.at("machine").at("processor");
  run->side_by_side = report.at("machine").at("side_by_side");
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

// A number in as few digits as read back to it: gflags gives 0.05 as 0.050000000000000003.
std::string AsTyped(const std::string& flag, const std::string& value) {
  if (gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).type != "double") return value;
  const std::optional<double> number = ToNumber(value);
  if (!number) return value;
  char text[32];
  return {text, std::to_chars(std::begin(text), std::end(text), *number).ptr};
}

// "trilobe study nylon.binary --runs=3", with the sources as they were typed.
std::string CommandText(std::span<const std::string> arguments) {
  std::string text = "trilobe study";
  for (const std::string& argument : arguments) text += " " + argument;
  std::vector<std::string> flags = StudyFlags();
  flags.insert(flags.end(), {"seed", "data_seed", "solvers", "runs", "set", "threads"});
  for (const auto& [flag, given] : GivenFlags(flags)) {
    const std::string value = AsTyped(flag, given);
    const bool plain = value.find_first_of(" ;|&'\"$*?<>()") == std::string::npos;
    text += " --" + flag + "=" + (plain ? value : "'" + value + "'");
  }
  return text;
}

// "a", or of several "a (3 runs), b (12 runs)".
template <typename Value>
std::string ValuesOf(const std::vector<StudyRun>& runs, const Value& value) {
  std::vector<std::pair<std::string, int>> counts;
  for (const StudyRun& run : runs) {
    if (run.failed()) continue;
    const std::string text = value(run);
    const auto known = std::ranges::find(counts, text, &std::pair<std::string, int>::first);
    if (known == counts.end()) {
      counts.emplace_back(text, 1);
    } else {
      ++known->second;
    }
  }
  std::string all;
  for (const auto& [text, count] : counts) {
    all += (all.empty() ? "" : ", ") + text;
    if (counts.size() > 1) all += " (" + std::to_string(count) + (count == 1 ? " run)" : " runs)");
  }
  return all;
}

// Tells readers of a page what its figures depend on.
std::vector<std::pair<std::string, std::string>> SettingOf(const std::vector<StudyRun>& runs,
                                                           const std::string& command) {
  std::string first, last;
  for (const StudyRun& run : runs) {
    if (run.failed()) continue;
    if (first.empty() || run.date < first) first = run.date;
    last = std::max(last, run.date);
  }
  const std::string revision = ProgramRevision();
  return {{"command", command},
          {"program", ProgramName() + (revision.empty() ? "" : ", revision " + revision) +
                          ", build " + ProgramBuild().substr(0, 12)},
          {"limit of a run", LimitsText()},
          {"threads", ValuesOf(runs,
                               [](const StudyRun& run) {
                                 return run.side_by_side == 1
                                            ? std::string("1, one run at a time")
                                            : "1 for each run, " +
                                                  std::to_string(run.side_by_side) +
                                                  " runs side by side, which slows each";
                               })},
          {"machine", ValuesOf(runs, [](const StudyRun& run) { return run.processor; })},
          {"date", first == last ? first : first + " to " + last}};
}

// Draws the figures of all problems; says on standard error if it cannot. Returns whether the disk
// is full.
bool DrawFigures(const std::vector<StudyRun>& runs, const std::string& out, int threads,
                 StudyPageContents* contents) {
  if (!HaveGnuplot()) {
    std::cerr << "trilobe: no pictures, as gnuplot is not installed\n";
    return false;
  }
  struct Task {
    std::string problem;  // "": all
    const StudyFigure* figure;
    bool drawn = false;
  };
  std::vector<Task> tasks;
  for (const StudyFigure& figure : ProfileFigures()) tasks.push_back({"", &figure});
  for (const std::string& problem : ProblemsOf(runs)) {
    for (const StudyFigure& figure : StudyFigures()) tasks.push_back({problem, &figure});
  }
  std::mutex mutex;
  std::string failure;
  ParallelJobs(static_cast<int>(tasks.size()), threads, [&](int k) {
    Task& task = tasks[k];
    try {
      if (task.problem.empty()) {
        task.drawn = DrawStudyFigure(*task.figure, runs, out);
        return;
      }
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
    if (!task.drawn) continue;
    (task.problem.empty() ? contents->profiles : contents->figures[task.problem])
        .push_back(task.figure);
  }
  return !failure.empty() && TellMissingPictures(failure, out);
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
  if (problems.size() > 1) std::cout << "\n" << TimesTextOf(runs);
  std::cout << "\n";
  for (const std::string& sentence : VerdictOn(runs)) std::cout << Printable(sentence) << "\n";
}

// Tables, figures and the page of all runs, and what is printed. Returns whether the disk is full.
bool Gather(std::vector<StudyJob> jobs, std::span<const std::string> arguments,
            const ResultFolder& summary) {
  std::vector<StudyRun> runs;
  StudyPageContents contents;
  for (StudyJob& job : jobs) {
    contents.folder_of[job.run.problem] = job.folder_of_problem;
    runs.push_back(std::move(job.run));
  }
  CompareRuns(&runs);
  contents.setting = SettingOf(runs, CommandText(arguments));
  contents.tables = {kRunsName, kMethodsName, kTracesName};
  if (ProblemsOf(runs).size() >= kFewestProblems) contents.tables.emplace_back(kProfilesName);
  const bool is_full = DrawFigures(runs, summary.path(), ThreadsFromFlags(), &contents);
  const auto write = [&](const char* name, const std::string& text) {
    WriteFile(summary.PathOf(name), [&](std::ostream& out) { out << text; });
  };
  write(kRunsName, RunsCsv(runs));
  write(kMethodsName, MethodsCsv(SummariesOf(runs)));
  write(kTracesName, TracesCsv(runs));
  if (contents.tables.size() > 3) write(kProfilesName, ProfilesCsv(runs));
  write(kStudyPageName, StudyPage(runs, contents));
  PrintStudy(runs);
  return is_full;
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
  if (!FLAGS_force) CheckSameStudy(out, jobs);
  summary.Open();
  WriteFile(summary.PathOf(kStudyRecordName),
            [&](std::ostream& record) { record << StudyRecord(jobs, CommandText(arguments)); });

  const std::vector<size_t> shard = JobsOfShard(jobs.size());
  const InterruptGuard guard;
  MakeJobs(
      shard.size(), RunsAtOnce(), "runs",
      [&](size_t k) -> FitOutcome& { return jobs[shard[k]].outcome; },
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
  const bool is_full = whole && Gather(std::move(jobs), arguments, summary);
  std::cout << "written      a folder for each run" << (whole ? ", the tables and " : "")
            << (whole ? kStudyPageName : "") << " in " << Printable(out) << "\n";
  if (failed) return kSomeFailed;
  return is_full ? 1 : 0;
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
              "of the starts, and\ncompares: who finds the lowest E, how often, how soon, whether "
              "E ever rose, whether the lobes are the\nsame, and whether it looks better. Each run "
              "has one thread and 30 seconds, unless --max_seconds or\n--max_iterations says "
              "otherwise. One runs at a time, so that times can be compared; --threads=N runs N\n"
              "side by side. Where --set varies the form of the model, samples are held out "
              "(--held_out). Models are\nwhat the solvers found (--raw); --noraw adds what `fit` "
              "does after them. Writes DIR/index.html (a page),\nDIR/runs.csv, methods.csv, "
              "traces.csv and, of three problems or more, profiles.csv,\nDIR/PROBLEM/*.svg and "
              "*.pdf (figures), and a folder for each run, as `fit` does. Without --out DIR is\n"
              "out/study. Ctrl-C keeps what is finished; the same command goes on, and fits again "
              "only what has\nchanged. --shard=i/n shares the runs out between machines "
              "(docs/study.md).",
          .flags = flags,
          .other_names = {{"starts", "runs"}},
          .run = RunStudy};
}

}  // namespace trilobe
