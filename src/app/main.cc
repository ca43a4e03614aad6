// The program `trilobe`: picks the subcommand, checks its flags, runs it, reports errors.

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <malloc.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "app/command.h"
#include "app/command_line.h"
#include "app/flags.h"
#include "app/solver_flags.h"
#include "core/base/nearest_name.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {FitCommand(),     SolversCommand(),  PlanCommand(),
                                                CompareCommand(), ScoreCommand(),    PlotCommand(),
                                                InfoCommand(),    ConvertCommand(),  SynthCommand(),
                                                ViewCommand(),    MaterialsCommand()};
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

// Of the flags that a command takes, the one that another name was meant to be; "" if it is far
// from all.
std::string MeantFlag(const std::string& name, const Command& command) {
  std::vector<std::string_view> taken(command.flags.begin(), command.flags.end());
  taken.insert(taken.end(), command.particular_flags.begin(), command.particular_flags.end());
  if (taken.empty()) return "";
  const std::string_view nearest = NearestName(name, taken);
  return 3 * EditDistance(name, nearest) <= name.size() ? std::string(nearest) : "";
}

// Flags that the command does not take must not be swallowed in silence.
void CheckFlags(const CommandLine& line, const Command& command) {
  for (const CommandLine::Flag& flag : line.flags) {
    const auto is_in = [&flag](const std::vector<std::string>& names) {
      return std::ranges::find(names, flag.name) != names.end();
    };
    if (is_in(command.flags) || is_in(command.particular_flags)) continue;
    // Those of gflags and glog, as --version and --v, are everybody's.
    if (flag.known &&
        gflags::GetCommandLineFlagInfoOrDie(flag.name.c_str()).filename.find("src/app/") ==
            std::string::npos) {
      continue;
    }
    const std::string meant = flag.known ? "" : MeantFlag(flag.name, command);
    throw Error("trilobe " + command.name + " has no flag --" + flag.name +
                (meant.empty() ? "; see" : "; did you mean --" + meant + "? See") +
                " `trilobe help " + command.name + "`");
  }
}

int Help(const CommandLine& line) {
  if (line.words.empty()) {
    PrintHelp();
    return 0;
  }
  const Command& command = FindCommand(line.words[0]);
  CheckFlags(line, command);
  PrintHelp(command);
  return 0;
}

int Run(const CommandLine& line) {
  const Command& command = FindCommand(line.words[0]);
  CheckFlags(line, command);
  const std::vector<std::string> arguments(line.words.begin() + 1, line.words.end());
  const int count = static_cast<int>(arguments.size());
  if (count < command.min_arguments || count > command.max_arguments) {
    throw Error("trilobe " + command.name + " takes " +
                (command.arguments.empty() ? "no arguments" : command.arguments) + ", but got " +
                std::to_string(count) + "; see `trilobe help " + command.name + "`");
  }
  return command.run(arguments);
}

// What was printed may still be in a buffer, and its disk full.
void FlushOutput() {
  const bool written = std::cout.flush() && std::fflush(stdout) == 0;
  if (!written) throw Error("cannot write to standard output");
}

// `trilobe fit --help` and `trilobe help fit` are the same, and other flags may come with both.
int Main(int argc, char** argv) {
  DefineSolverFlags();
  CommandLine line = ReadCommandLine(argc, argv);
  SetFlags(line, argv[0]);
  if (argc < 2) line.help = true;
  if (!line.words.empty() && line.words[0] == "help") {
    line.words.erase(line.words.begin());
    line.help = true;
  }
  if (line.help) return Help(line);
  if (line.words.empty()) throw Error("no command; known: " + KnownCommands());
  return Run(line);
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // What was freed stays for what is made next. Else each large table comes as pages of its own,
  // and to clear these takes the system 3 % of a fit.
  constexpr int kAll = 1 << 30;  // bytes
  mallopt(M_MMAP_THRESHOLD, kAll);
  mallopt(M_TRIM_THRESHOLD, kAll);
#endif
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
    std::cerr << "trilobe: internal error: " << trilobe::Printable(error.what()) << "\n";
  }
  return 1;
}
