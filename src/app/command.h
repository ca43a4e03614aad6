#ifndef TRILOBE_APP_COMMAND_H_
#define TRILOBE_APP_COMMAND_H_

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace trilobe {

// A subcommand of the program. Its flags are gflags, defined in its own file or, if shared, in
// flags.cc. Flags that it does not list are an error.
struct Command {
  std::string name;
  std::string summary;    // one line for `trilobe help`
  std::string arguments;  // "SOURCE", "MODEL SOURCE", ...
  // What goes on while it runs (Status): "comparing"; empty if it tells itself.
  std::string doing = {};
  int min_arguments = 0;
  int max_arguments = 0;
  std::string details;             // text for `trilobe help NAME`: what it reads, does and writes
  std::vector<std::string> flags;  // accepted flags, listed in its help
  std::string lists = {};          // further text for `trilobe help NAME --all`
  // Other names of flags, and the flags: {"starts", "runs"}.
  std::vector<std::pair<std::string, std::string>> other_names = {};
  // Flags that only some values of another flag accept (--solver): those of all values, and the
  // help of the given value.
  std::vector<std::string> particular_flags = {};
  std::string (*particular_help)() = nullptr;
  // Runs the command with its positional arguments. Returns the exit status. Throws Error.
  int (*run)(std::span<const std::string> arguments) = nullptr;
};

// Exit status if some of several inputs failed; also that of the experiments.
inline constexpr int kSomeFailed = 3;

// The commands, each defined in its own file.
Command CompareCommand();
Command ConvertCommand();
Command FitCommand();
Command InfoCommand();
Command MaterialsCommand();
Command MeasureCommand();
Command PlanCommand();
Command PlotCommand();
Command ScoreCommand();
Command SolversCommand();
Command StudyCommand();
Command SynthCommand();
Command ViewCommand();

// All commands, in the order of `trilobe help`.
const std::vector<Command>& Commands();

}  // namespace trilobe

#endif  // TRILOBE_APP_COMMAND_H_
