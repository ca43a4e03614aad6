#include "app/study_jobs.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "app/fit_flags.h"
#include "app/fit_jobs.h"
#include "app/fit_settings.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/solver_flags.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/starts/solvers.h"

DEFINE_string(solvers, "auto,awls,lm", "the solvers to compare, by name");
DEFINE_int32(
    runs, 5,
    "runs of each solver on each problem: the first from the start --init, the others from "
    "random ones, --init=random with the seeds that follow --seed; --starts is another name of it");
DEFINE_string(set, "",
              "FLAG=a,b,c: run with each of these values of a flag of `fit`; several flags are "
              "separated by ; and values with commas in them by |. A flag that only some solvers "
              "read is varied for these");

namespace trilobe {
namespace {

namespace fs = std::filesystem;

// A flag of --set, and its values.
struct Sweep {
  std::string flag;
  std::vector<std::string> values;
};

// Flags that this command sets itself.
constexpr const char* kFlagsOfStudy[] = {
    "solver",      "seed",    "data_seed", "out",   "shard",   "plots",  "reconstruction",
    "convergence", "threads", "scene",     "cache", "nocache", "verbose"};

}  // namespace

std::vector<std::string> StudyFlags() {
  std::vector<std::string> flags = FitFlags();
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  for (const char* const flag : kFlagsOfStudy) std::erase(flags, flag);
  return flags;
}

namespace {

std::vector<Sweep> SweepsFromFlags() {
  std::vector<Sweep> sweeps;
  const std::vector<std::string> known = StudyFlags();
  for (const std::string& part : Split(FLAGS_set, ';')) {
    const size_t equals = part.find('=');
    const std::string flag = part.substr(0, equals);
    const std::string values = equals == std::string::npos ? "" : part.substr(equals + 1);
    if (std::ranges::find(known, flag) == known.end()) {
      throw Error(ErrorKind::kUnknown,
                  "--set=" + part + ": '" + flag +
                      "' is no flag of fit that can be varied; write FLAG=a,b,c")
          .About("set", part);
    }
    if (values.empty()) {
      throw Error(ErrorKind::kFormat, "--set=" + part + ": give values, as in FLAG=a,b,c")
          .About("set", part);
    }
    if (!IsDefault(flag)) {
      throw Error(ErrorKind::kConflict, "--" + flag + " and --set=" + part + ": give one of them")
          .About(flag);
    }
    if (std::ranges::find(sweeps, flag, &Sweep::flag) != sweeps.end()) {
      throw Error(ErrorKind::kConflict,
                  "--set varies --" + flag + " twice; give all values at once, as in FLAG=a,b,c")
          .About(flag);
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
    throw Error(ErrorKind::kUnsupported,
                "--set varies --" + flag + ", which none of --solvers reads; see `trilobe solvers`")
        .About(flag);
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

void SetFlag(const std::string& flag, const std::string& value) {
  if (gflags::SetCommandLineOption(flag.c_str(), value.c_str()).empty()) {
    throw Error(ErrorKind::kFormat, "--set: --" + flag + "=" + value + " is no value of this flag")
        .About(flag, value);
  }
}

// The solver's time in each run, so that methods have the same, unless --max_iterations or
// --max_seconds says otherwise.
constexpr const char* kSeconds = "30";
constexpr const char* kIterations = "1000000000";  // as many as that time allows

// Whether a flag is given, or is among those that are varied.
bool IsSet(const std::string& flag, const Values& values) {
  const auto is_it = [&](const auto& value) { return value.first == flag; };
  return !IsDefault(flag) || std::ranges::any_of(values, is_it);
}

void SetLimits(const Values& values) {
  if (IsSet("max_iterations", values)) return;
  SetFlag("max_iterations", kIterations);
  if (!IsSet("max_seconds", values)) SetFlag("max_seconds", kSeconds);
}

// Whether the flag changes how many numbers a model has, or what they are of.
bool ChangesForm(const std::string& flag) {
  const std::vector<std::string> flags = ModelFlags();
  return flag == "max_parameters" || std::ranges::find(flags, flag) != flags.end();
}

// The settings of `trilobe fit` with these flags.
FitSettings SettingsOf(const std::string& solver, const Values& values, int start) {
  const gflags::FlagSaver as_given;
  if (IsDefault("data_seed")) SetFlag("data_seed", std::to_string(FLAGS_seed));  // for all starts
  SetFlag("solver", solver);
  SetLimits(values);
  // A larger form has a lower E on what it was fitted to.
  const bool changes_form =
      std::ranges::any_of(values, [](const auto& value) { return ChangesForm(value.first); });
  if (IsDefault("held_out") && changes_form) SetFlag("held_out", "true");
  for (const auto& [flag, value] : values) SetFlag(flag, value);
  // Studies are of solvers, without the steps after them. With --model=auto, the choice of a form
  // is the result.
  if (IsDefault("raw") && !ChoosesModel()) SetFlag("raw", "true");
  // All solvers fit the same form.
  if (IsDefault("nodes") && !IsOn("raw") && !ChoosesModel()) SetFlag("nodes", "given");
  if (start > 1) {
    SetFlag("init", "random");
    SetFlag("seed", std::to_string(FLAGS_seed + start - 1));
  }
  return FitSettingsFromFlags();
}

// The name of a folder that needs no quotes in a shell: letters, digits, and the other characters
// that mean nothing there; "copper-log-noise-0.05" of "copper log noise:0.05".
std::string AsName(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ||
                       static_cast<unsigned char>(c) >= 0x80;  // of letters in UTF-8
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (name.ends_with('-')) name.pop_back();
  while (name.starts_with('.')) name.erase(0, 1);
  return name.empty() ? "unnamed" : name;
}

// Another folder for another text whose name is the same but for what means something in a shell.
class FolderNames {
 public:
  std::string NameOf(const std::string& text) {
    if (const auto known = name_of_.find(text); known != name_of_.end()) return known->second;
    const std::string plain = AsName(text);
    std::string name = plain;
    for (int k = 2; !taken_.insert(name).second; ++k) name = plain + "-" + std::to_string(k);
    return name_of_[text] = name;
  }

 private:
  std::map<std::string, std::string> name_of_;
  std::set<std::string> taken_ = {std::begin(kFilesOfStudy), std::end(kFilesOfStudy)};
};

// Throws Error where nothing is to be read.
void CheckSource(const std::string& source) {
  std::error_code ignored;
  if (IsSynthetic(source) || fs::exists(source, ignored)) return;
  throw Error(ErrorKind::kFile, "cannot read '" + source + "': no such file")
      .At(source)
      .About("read");
}

// Throws Error for a run that there is already.
void CheckNew(const StudyJob& job, std::set<std::string>* folders) {
  if (!folders->insert(job.run.folder).second) {
    throw Error(ErrorKind::kConflict, "'" + job.run.problem + "' by '" + job.run.method +
                                          "' is asked for twice; name each solver and value once")
        .About("problem", job.run.problem);
  }
}

}  // namespace

int RunsAtOnce() { return IsDefault("threads") ? 1 : ThreadsFromFlags(); }

std::string LimitsText() {
  std::string text;
  for (const auto& [flag, value] : GivenFlags({"max_iterations", "max_seconds"})) {
    text += (text.empty() ? "--" : " --") + flag + "=" + value;
  }
  if (!text.empty()) return text;
  if (FLAGS_set.find("max_iterations") != std::string::npos ||
      FLAGS_set.find("max_seconds") != std::string::npos) {
    return "by --set";
  }
  return std::string(kSeconds) + " s of each solver, by the clock (--max_seconds)";
}

std::vector<StudyJob> StudyJobsFromFlags(std::span<const std::string> arguments) {
  if (FLAGS_runs < 1 || FLAGS_runs > 10000) {
    throw Error(ErrorKind::kRange, "--runs must be from 1 to 10000").About("runs", FLAGS_runs);
  }
  const std::vector<Sweep> sweeps = SweepsFromFlags();
  std::vector<const SolverEntry*> solvers;
  for (const std::string& name : Split(FLAGS_solvers, ',')) solvers.push_back(&FindSolver(name));
  if (solvers.empty()) {
    throw Error(ErrorKind::kMissing, "--solvers is empty; name some, as auto,awls,lm")
        .About("solvers");
  }
  CheckThatSomeSolverReads(sweeps, solvers);
  // Random starts are the same for all values of --init.
  const bool varies_start = std::ranges::find(sweeps, "init", &Sweep::flag) != sweeps.end();
  const int runs = varies_start ? 1 : FLAGS_runs;
  std::vector<StudyJob> jobs;
  std::set<std::string> folders, told;
  FolderNames problem_names;
  std::map<std::string, FolderNames> method_names;  // by problem
  const int at_once = RunsAtOnce();
  for (const FitOutcome& source : ListSources(arguments)) {
    CheckSource(source.source);
    for (const SolverEntry* solver : solvers) {
      for (const Values& values : ChoicesFor(*solver, sweeps)) {
        std::string of_problem, of_method;
        for (const auto& [flag, value] : values) {
          (ChangesProblem(flag) ? of_problem : of_method) += " " + Label(flag, value);
        }
        for (int start = 1; start <= runs; ++start) {
          StudyJob job;
          job.settings = SettingsOf(solver->name, values, start);
          job.run = {.problem = source.name + of_problem,
                     .method = solver->name + of_method,
                     .start = start,
                     .folder = ""};
          job.settings.side_by_side = at_once;
          job.folder_of_problem = problem_names.NameOf(job.run.problem);
          job.run.folder = job.folder_of_problem + "/" +
                           method_names[job.run.problem].NameOf(job.run.method) + "/start-" +
                           std::to_string(start);
          CheckNew(job, &folders);
          // The first of the runs on the same data tells what was noticed of them.
          job.settings.tell_notes = told.insert(job.folder_of_problem).second;
          job.outcome = {.name = job.run.folder, .source = source.source};
          jobs.push_back(std::move(job));
        }
      }
    }
  }
  return jobs;
}

}  // namespace trilobe
