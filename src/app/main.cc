// The program `trilobe`: picks the subcommand, checks its flags, runs it, reports errors.

#include <gflags/gflags.h>
#include <glog/logging.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "trilobe/app/command.h"
#include "trilobe/base/error.h"

namespace trilobe {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = {FitCommand(),  ScoreCommand(),   PlotCommand(),
                                                InfoCommand(), ConvertCommand(), SynthCommand()};
  return commands;
}

namespace {

const Command* FindCommand(const std::string& name) {
  for (const Command& command : Commands()) {
    if (command.name == name) return &command;
  }
  return nullptr;
}

std::string KnownCommands() {
  std::string names;
  for (const Command& command : Commands()) names += command.name + ", ";
  return names + "help";
}

void PrintHelp() {
  std::cout << "trilobe fits multi-lobe non-parametric microfacet models to measured BRDFs.\n\n"
               "usage: trilobe COMMAND ARGUMENTS [--FLAG=VALUE ...]\n\n";
  for (const Command& command : Commands()) {
    std::cout << "  " << std::left << std::setw(10) << command.name << command.summary << "\n";
  }
  std::cout << "  help      this page, or `trilobe help COMMAND`\n\n"
               "A SOURCE is a MERL .binary file, an RGL *_rgb.bsdf file, or synth:NAME "
               "(`trilobe synth` lists the names).\n";
}

void PrintHelp(const Command& command) {
  std::cout << "usage: trilobe " << command.name << " " << command.arguments
            << " [--FLAG=VALUE ...]\n\n"
            << command.summary << "\n\n"
            << command.details << "\n\nflags:\n";
  for (const std::string& name : command.flags) {
    const auto flag = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
    std::cout << "  --" << name << "=" << (flag.default_value.empty() ? "..." : flag.default_value)
              << "\n      " << flag.description << "\n";
  }
}

int Help(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    PrintHelp();
    return 0;
  }
  const Command* command = FindCommand(arguments[0]);
  if (command == nullptr) {
    throw Error("unknown command '" + arguments[0] + "'; known: " + KnownCommands());
  }
  PrintHelp(*command);
  return 0;
}

// Flags of other commands must not be swallowed in silence.
void CheckFlags(const Command& command) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  for (const auto& flag : flags) {
    const bool ours = flag.filename.find("src/app/") != std::string::npos;
    const bool taken = std::ranges::find(command.flags, flag.name) != command.flags.end();
    if (!flag.is_default && ours && !taken) {
      throw Error("trilobe " + command.name + " has no flag --" + flag.name +
                  "; see `trilobe help " + command.name + "`");
    }
  }
}

int Run(const std::vector<std::string>& words) {
  const Command* command = FindCommand(words[0]);
  if (command == nullptr) {
    throw Error("unknown command '" + words[0] + "'; known: " + KnownCommands());
  }
  const std::vector<std::string> arguments(words.begin() + 1, words.end());
  const int count = static_cast<int>(arguments.size());
  if (count < command->min_arguments || count > command->max_arguments) {
    throw Error("trilobe " + command->name + " takes " + command->arguments + ", but got " +
                std::to_string(count) + " arguments; see `trilobe help " + command->name + "`");
  }
  CheckFlags(*command);
  return command->run(arguments);
}

// What was printed may still be in a buffer, and its disk full.
void FlushOutput() {
  const bool written = std::cout.flush() && std::fflush(stdout) == 0;
  if (!written) throw Error("cannot write to standard output");
}

int Main(int argc, char** argv) {
  // `trilobe fit --help` and `trilobe help fit` are the same; gflags' own --help lists everything.
  std::vector<std::string> words;
  bool help = argc < 2;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-help" || word == "-h" || (i == 1 && word == "help")) {
      help = true;
    } else if (!word.starts_with("-")) {
      words.push_back(word);
    }
  }
  if (help) return Help(words);
  gflags::ParseCommandLineFlags(&argc, &argv, /*remove_flags=*/true);
  words.assign(argv + 1, argv + argc);
  if (words.empty()) throw Error("no command; known: " + KnownCommands());
  return Run(words);
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
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
