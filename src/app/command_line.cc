#include "app/command_line.h"

#include <gflags/gflags.h>

#include <limits>
#include <string_view>
#include <utility>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

using gflags::CommandLineFlagInfo;

// With a value, too, which gflags would take for the list of all flags of all libraries.
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

// What a flag is called today that has had another name.
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

// What values of a type are, in words.
std::string ValuesOf(const std::string& type) {
  if (type == "bool") return "true or false";
  if (type == "double") return "a number";
  if (type == "int32") return WholeNumber<int32_t>();
  if (type == "int64") return WholeNumber<int64_t>();
  if (type == "uint64") return WholeNumber<uint64_t>();
  return "a value of type " + type;
}

}  // namespace

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
      throw Error("--" + name + " lacks its value; give --" + name + "=VALUE");
    }
  }
  for (++k; k < argc; ++k) line.words.emplace_back(argv[k]);
  return line;
}

void SetFlags(const CommandLine& line, const char* program) {
  std::vector<std::string> words = {program};
  for (const auto& [name, value, known] : line.flags) {
    if (!known) continue;
    if (gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) {
      const CommandLineFlagInfo info = gflags::GetCommandLineFlagInfoOrDie(name.c_str());
      throw Error("--" + name + "=" + value + ": give " + ValuesOf(info.type));
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

}  // namespace trilobe
