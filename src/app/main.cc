// The program `trilobe`: picks the subcommand, checks its flags, runs it, reports errors.

#include <fcntl.h>
#include <gflags/gflags.h>
#include <glog/logging.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/fit_flags.h"
#include "app/flags.h"
#include "app/help.h"
#include "app/man_page.h"
#include "app/solver_flags.h"
#include "app/status.h"
#include "core/base/names.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {

const std::vector<Command>& Commands() {
  static const std::vector<Command> commands = [] {
    std::vector<Command> all = {
        FitCommand(),   StudyCommand(),     SolversCommand(), PlanCommand(),    CompareCommand(),
        ScoreCommand(), PlotCommand(),      InfoCommand(),    ConvertCommand(), SynthCommand(),
        ViewCommand(),  MaterialsCommand(), MeasureCommand()};
    // Whatever writes files can be told to overwrite.
    for (Command& command : all) {
      const auto out = std::ranges::find(command.flags, "out");
      if (out != command.flags.end()) command.flags.insert(out + 1, "force");
    }
    return all;
  }();
  return commands;
}

namespace {

using gflags::CommandLineFlagInfo;

// The command line, taken apart by the rules of gflags: a word that begins with - is a flag, whose
// value follows after = or, but for one of true and false, as the next word; after -- all are
// words.
struct CommandLine {
  struct Flag {
    std::string name;   // without its dashes, nor the no of --noplots
    std::string value;  // "true" or "false" where it stands alone
    bool known = true;  // else the name is as it was typed
  };
  std::vector<std::string> words;
  std::vector<Flag> flags;
  bool help = false;     // --help, -help or -h
  bool all = false;      // --all, of help
  bool man = false;      // --man, of help
  bool version = false;  // --version
};

// Also recognises --help=VALUE, which gflags would take for the list of all flags of all libraries.
bool IsHelp(std::string_view word) {
  const std::string_view name = word.substr(0, word.find('='));
  return word == "-h" || name == "--help" || name == "-help";
}

bool IsBool(const std::string& name) {
  CommandLineFlagInfo info;
  return gflags::GetCommandLineFlagInfo(name.c_str(), &info) && info.type == "bool";
}

bool IsKnown(const std::string& name) {
  CommandLineFlagInfo info;
  return gflags::GetCommandLineFlagInfo(name.c_str(), &info);
}

// Current name of a flag that has had another one.
std::string CurrentName(const std::string& name) {
  constexpr std::pair<std::string_view, std::string_view> kRenamed[] = {
      {"max_numbers", "max_parameters"}, {"guide", "prior"}, {"course", "convergence"}};
  for (const auto& [before, now] : kRenamed) {
    if (name == before) return std::string(now);
  }
  return name;
}

template <typename Integer>
std::string WholeNumber() {
  return "a whole number from " + std::to_string(std::numeric_limits<Integer>::min()) + " to " +
         std::to_string(std::numeric_limits<Integer>::max());
}

// Permitted values of a type, in words.
std::string ValuesOf(const std::string& type) {
  if (type == "bool") return "true or false";
  if (type == "double") return "a number";
  if (type == "int32") return WholeNumber<int32_t>();
  if (type == "int64") return WholeNumber<int64_t>();
  if (type == "uint64") return WholeNumber<uint64_t>();
  return "a value of type " + type;
}

// Throws Error where the last flag lacks its value.
CommandLine ReadCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  int k = 1;
  for (; k < argc && std::string_view(argv[k]) != "--"; ++k) {
    const std::string word = argv[k];
    if (word.size() < 2 || word[0] != '-') {
      line.words.push_back(word);
      continue;
    }
    if (IsHelp(word)) {
      line.help = true;
      continue;
    }
    if (word == "--all") {
      line.all = true;
      continue;
    }
    if (word == "--man") {
      line.man = true;
      continue;
    }
    if (word == "--version" || word == "-version") {
      line.version = true;
      continue;
    }
    const size_t begin = word[1] == '-' ? 2 : 1;
    const size_t equals = word.find('=');
    std::string name = CurrentName(word.substr(begin, equals - begin));
    if (!IsKnown(name)) {
      const bool is_no =
          equals == std::string::npos && name.starts_with("no") && IsBool(name.substr(2));
      line.flags.push_back(is_no ? CommandLine::Flag{name.substr(2), "false"}
                                 : CommandLine::Flag{name, "", false});
    } else if (equals != std::string::npos) {
      line.flags.push_back({std::move(name), word.substr(equals + 1)});
    } else if (IsBool(name)) {
      line.flags.push_back({std::move(name), "true"});
    } else if (++k < argc) {
      line.flags.push_back({std::move(name), argv[k]});
    } else {
      throw Error(ErrorKind::kMissing, "--" + name + " lacks its value; give --" + name + "=VALUE")
          .About(name);
    }
  }
  for (++k; k < argc; ++k) line.words.emplace_back(argv[k]);
  return line;
}

// Sets flags that are known. Throws Error for a value that is of another type than its flag.
void SetFlags(const CommandLine& line, const char* program) {
  std::vector<std::string> words = {program};
  for (const auto& [name, value, known] : line.flags) {
    if (!known) continue;
    if (gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) {
      const CommandLineFlagInfo info = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      throw Error(ErrorKind::kFormat, "--" + name + "=" + value + ": give " + ValuesOf(info.type))
          .About(name, value);
    }
    words.push_back("--" + name + "=" + value);
  }
  // Once more by gflags itself, whose own flags (--version, --flagfile) it knows what to do about.
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int argc = static_cast<int>(words.size());
  char** begin = argv.data();
  gflags::ParseCommandLineFlags(&argc, &begin, /*remove_flags=*/true);
}

std::string KnownCommands() {
  std::string names;
  for (const Command& command : Commands()) names += command.name + ", ";
  return names + "help";
}

const Command& FindCommand(const std::string& name) {
  const auto found = std::ranges::find(Commands(), name, &Command::name);
  if (found != Commands().end()) return *found;
  std::vector<std::string_view> known;
  for (const Command& command : Commands()) known.push_back(command.name);
  known.emplace_back("help");
  throw UnknownName("command", name, known);
}

// The flag of a command that another name was probably meant to be; "" if it is far from all.
std::string MeantFlag(const std::string& name, const Command& command) {
  std::vector<std::string_view> taken(command.flags.begin(), command.flags.end());
  taken.insert(taken.end(), command.particular_flags.begin(), command.particular_flags.end());
  return MeantName(name, taken);
}

// Flags that the command does not take must not be swallowed in silence.
void CheckFlags(const CommandLine& line, const Command& command) {
  for (const CommandLine::Flag& flag : line.flags) {
    const auto is_in = [&flag](const std::vector<std::string>& names) {
      return std::ranges::find(names, flag.name) != names.end();
    };
    if (is_in(command.flags) || is_in(command.particular_flags)) continue;
    if (flag.name == "quiet") continue;
    // Flags of gflags and glog, such as --version and --v, are valid for all commands.
    if (flag.known &&
        gflags::GetCommandLineFlagInfoOrDie(flag.name.c_str()).filename.find("src/app/") ==
            std::string::npos) {
      continue;
    }
    const std::string meant = flag.known ? "" : MeantFlag(flag.name, command);
    throw Error(ErrorKind::kUnknown,
                "trilobe " + command.name + " has no flag --" + flag.name +
                    (meant.empty() ? "; see" : "; did you mean --" + meant + "? See") +
                    " `trilobe help " + command.name + "`")
        .About("flag", flag.name);
  }
}

// Takes other names of a command's flags. Throws Error where both are given.
void TakeOtherNames(CommandLine* line) {
  const size_t place = !line->words.empty() && line->words[0] == "help" ? 1 : 0;
  if (line->words.size() <= place) return;
  const auto command = std::ranges::find(Commands(), line->words[place], &Command::name);
  if (command == Commands().end()) return;
  for (const auto& [other, name] : command->other_names) {
    const auto given = std::ranges::find(line->flags, other, &CommandLine::Flag::name);
    if (given == line->flags.end()) continue;
    if (std::ranges::find(line->flags, name, &CommandLine::Flag::name) != line->flags.end()) {
      throw Error(ErrorKind::kConflict,
                  "--" + other + " is another name of --" + name + "; give one of them")
          .About(name);
    }
    given->name = name;
  }
}

int Help(const CommandLine& line) {
  if (line.words.empty()) {
    std::cout << (line.man ? ManPage() : HelpText());
    return 0;
  }
  const Command& command = FindCommand(line.words[0]);
  CheckFlags(line, command);
  std::cout << HelpText(command, line.all);
  return 0;
}

int Run(const CommandLine& line) {
  const Command& command = FindCommand(line.words[0]);
  CheckFlags(line, command);
  const std::vector<std::string> arguments(line.words.begin() + 1, line.words.end());
  const int count = static_cast<int>(arguments.size());
  if (count < command.min_arguments || count > command.max_arguments) {
    throw Error(ErrorKind::kRange,
                "trilobe " + command.name + " takes " +
                    (command.arguments.empty() ? "no arguments" : command.arguments) +
                    ", but got " + std::to_string(count) + "; see `trilobe help " + command.name +
                    "`")
        .About("arguments", count);
  }
  if (command.doing.empty()) return command.run(arguments);
  const StageScope stage(command.doing);
  return command.run(arguments);
}

// Printed text may still be in a buffer, and its disk full.
void FlushOutput() {
  const bool written = std::cout.flush() && std::fflush(stdout) == 0;
  if (!written) throw Error(ErrorKind::kFile, "cannot write to standard output").About("write");
}

// A descriptor of a standard stream that is closed would be that of the next file that is opened,
// and what is printed would go into it. Writing to the stream still fails.
void OccupyStandardStreams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (fcntl(fd, F_GETFD) < 0) open("/dev/null", O_RDONLY);  // takes the lowest that is free
  }
}

// `trilobe fit --help` and `trilobe help fit` are the same, and other flags may come with both.
int Main(int argc, char** argv) {
  DefineSourceFlags();
  DefineFitFlags();
  DefineSolverFlags();
  CommandLine line = ReadCommandLine(argc, argv);
  TakeOtherNames(&line);
  SetFlags(line, argv[0]);
  const LineClearing clearing;
  if (argc < 2) line.help = true;
  if (!line.words.empty() && line.words[0] == "help") {
    line.words.erase(line.words.begin());
    line.help = true;
  }
  if (line.version) {
    std::cout << "trilobe version " << TRILOBE_VERSION << "\n";
    return 0;
  }
  if (line.man && (!line.help || !line.words.empty())) {
    throw Error(ErrorKind::kUnknown,
                "--man is of the help of all commands; give `trilobe help --man`")
        .About("flag", "man");
  }
  if (line.help) return Help(line);
  if (line.all) {
    throw Error(ErrorKind::kUnknown, "--all is for `trilobe help COMMAND`; leave it out")
        .About("flag", "all");
  }
  if (line.words.empty()) {
    throw Error(ErrorKind::kMissing, "no command; known: " + KnownCommands()).About("command");
  }
  return Run(line);
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // Freed memory stays for reuse. Otherwise each large table comes as pages of its own, and to
  // clear these takes the system 3 % of a fit.
  constexpr int kAll = 1 << 30;  // bytes
  mallopt(M_MMAP_THRESHOLD, kAll);
  mallopt(M_TRIM_THRESHOLD, kAll);
  // One heap for all threads: what one of them freed, another takes. With a heap each, a fit with
  // pictures on two threads takes 390 instead of 275 MB. Small pieces have a cache by thread.
  mallopt(M_ARENA_MAX, 1);
#endif
  // A file that has reached `ulimit -f` is an error of writing then, as a full disk is.
  std::signal(SIGXFSZ, SIG_IGN);
  trilobe::OccupyStandardStreams();
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
