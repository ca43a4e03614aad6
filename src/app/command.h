#ifndef TRILOBE_APP_COMMAND_H_
#define TRILOBE_APP_COMMAND_H_

#include <span>
#include <string>
#include <vector>

namespace trilobe {

// A subcommand of the program. Flags are gflags, defined in the command's file (shared ones in
// flags.h); a command that is given one of another is an error.
struct Command {
  std::string name;
  std::string summary;    // one line for `trilobe help`
  std::string arguments;  // "SOURCE", "MODEL SOURCE", ...
  int min_arguments = 0;
  int max_arguments = 0;
  std::string details;  // some lines for `trilobe help NAME`: what it reads, does and writes
  std::vector<std::string> flags;  // those that it takes, listed in its help
  // For a flag whose values bring flags of their own, as --solver does: those of all its values,
  // and what the help is to say about the value given and its flags.
  std::vector<std::string> particular_flags = {};
  std::string (*particular_help)() = nullptr;
  // Positional arguments only. Returns the exit status; throws Error for bad input.
  int (*run)(std::span<const std::string> arguments) = nullptr;
};

// Exit status where all was tried and some of it failed, as of the experiments.
inline constexpr int kSomeFailed = 3;

// One function a command, each in its own file.
Command CompareCommand();
Command ConvertCommand();
Command FitCommand();
Command InfoCommand();
Command MaterialsCommand();
Command PlanCommand();
Command PlotCommand();
Command ScoreCommand();
Command SolversCommand();
Command SynthCommand();
Command ViewCommand();

// All commands, in the order of `trilobe help`.
const std::vector<Command>& Commands();

}  // namespace trilobe

#endif  // TRILOBE_APP_COMMAND_H_
