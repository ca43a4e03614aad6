// The program `trilobe`: picks the subcommand, checks its flags, runs it, reports errors.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "trilobe/app/command.h"
#include "trilobe/app/flags.h"
#include "trilobe/app/solver_flags.h"
#include "trilobe/base/error.h"

namespace trilobe {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {FitCommand(),     SolversCommand(), PlanCommand(),
                                                CompareCommand(), ScoreCommand(),   PlotCommand(),
                                                InfoCommand(),    ConvertCommand(), SynthCommand()};
  return commands;
}

namespace {

std::string KnownCommands() {
  std::string names;
  for (const Command& command : Commands()) names += command.name + ", ";
  return names + "help";
}

const Command& FindCommand(const std::string& name) {
  for (const Command& command : Commands()) {
    if (command.name == name) return command;
  }
  throw Error("unknown command '" + name + "'; known: " + KnownCommands());
}

void PrintHelp() {
  std::cout << "trilobe fits multi-lobe non-parametric microfacet models to measured BRDFs.\n\n"
               "usage: trilobe COMMAND ARGUMENTS [--FLAG=VALUE ...]\n\n";
  for (const Command& command : Commands()) {
    std::cout << "  " << std::left << std::setw(10) << command.name << command.summary << "\n";
  }
  std::cout
      << "  help      this page, or `trilobe help COMMAND`\n\n"
         "A SOURCE is a MERL .binary file, an RGL *_rgb.bsdf file, a UTIA .bin file or another of\n"
         "docs/file-formats.md, or synth:NAME (`trilobe synth` lists the names).\n";
}

void PrintHelp(const Command& command) {
  // Before anything is printed: it may throw.
  const std::string particular =
      command.particular_help != nullptr ? "\n" + command.particular_help() : "";
  std::cout << "usage: trilobe " << command.name << " " << command.arguments
            << " [--FLAG=VALUE ...]\n\n"
            << command.summary << "\n\n"
            << command.details << "\n"
            << particular;
  if (!command.flags.empty()) std::cout << "\nflags:\n";
  for (const std::string& flag : command.flags) std::cout << FlagHelp(flag);
}

// Flags of other commands must not be swallowed in silence.
void CheckFlags(const Command& command) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  for (const auto& flag : flags) {
    const bool ours = flag.filename.find("src/app/") != std::string::npos;
    const auto is_in = [&flag](const std::vector<std::string>& names) {
      return std::ranges::find(names, flag.name) != names.end();
    };
    const bool taken = is_in(command.flags) || is_in(command.particular_flags);
    if (!flag.is_default && ours && !taken) {
      throw Error("trilobe " + command.name + " has no flag --" + flag.name +
                  "; see `trilobe help " + command.name + "`");
    }
  }
}

int Help(const std::vector<std::string>& words) {
  if (words.empty()) {
    PrintHelp();
    return 0;
  }
  const Command& command = FindCommand(words[0]);
  CheckFlags(command);
  PrintHelp(command);
  return 0;
}

int Run(const std::vector<std::string>& words) {
  const Command& command = FindCommand(words[0]);
  const std::vector<std::string> arguments(words.begin() + 1, words.end());
  const int count = static_cast<int>(arguments.size());
  if (count < command.min_arguments || count > command.max_arguments) {
    throw Error("trilobe " + command.name + " takes " + command.arguments + ", but got " +
                std::to_string(count) + " arguments; see `trilobe help " + command.name + "`");
  }
  CheckFlags(command);
  return command.run(arguments);
}

// What was printed may still be in a buffer, and its disk full.
void FlushOutput() {
  const bool written = std::cout.flush() && std::fflush(stdout) == 0;
  if (!written) throw Error("cannot write to standard output");
}

// `trilobe fit --help` and `trilobe help fit` are the same, and other flags may come with both. So
// the words for help are taken out before gflags sees them: its own --help would list everything.
bool TakeOutHelp(int* argc, char** argv) {
  const auto is_help = [](const std::string& word) {
    return word == "--help" || word == "-help" || word == "-h";
  };
  char** const end = std::remove_if(argv + 1, argv + *argc, is_help);
  const bool found = end != argv + *argc;
  *argc = static_cast<int>(end - argv);
  argv[*argc] = nullptr;
  return found;
}

int Main(int argc, char** argv) {
  const bool help = argc < 2 || TakeOutHelp(&argc, argv);
  DefineSolverFlags();
  gflags::ParseCommandLineFlags(&argc, &argv, /*remove_flags=*/true);
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "help") {
    words.erase(words.begin());
    return Help(words);
  }
  if (help) return Help(words);
  if (words.empty()) throw Error("no command; known: " + KnownCommands());
  return Run(words);
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  // A file that has reached `ulimit -f` is an error of writing then, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  FLAGS_logtostderr = true;
  google::InitGoogleLogging(argv[0]);
  gflags::SetVersionString(TRILOBE_VERSION);
  try {
    const int status = trilobe::Main(argc, argv);
    trilobe::FlushOutput();
    return status;
  } catch (const trilobe::Error& error) {
    std::cerr << "trilobe: error: " << error.what() << "\n";
  } catch (const std::bad_alloc&) {
    std::cerr << "trilobe: error: out of memory\n";
  } catch (const std::exception& error) {
    std::cerr << "trilobe: internal error: " << error.what() << "\n";
  }
  return 1;
}
