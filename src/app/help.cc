#include "app/help.h"

#include <gflags/gflags.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "app/status.h"
#include "core/base/text.h"

namespace trilobe {
namespace {

// Flags that come first in the help of each command that takes them.
constexpr std::string_view kCommon[] = {
    "solvers", "runs",    "model",     "lobes",     "solver",     "max_iterations", "max_seconds",
    "columns", "theta_i", "theta_o",   "max_angle", "scale",      "noise",          "at",
    "scene",   "out",     "plots",     "threads",   "json",       "verbose",        "directions",
    "next",    "by",      "theta_max", "in_plane",  "incidences", "step",           "blind"};

bool IsCommon(const std::string& flag) {
  return std::ranges::find(kCommon, flag) != std::end(kCommon);
}

// Column in which the further lines of a line begin that begins with a space.
size_t HangingIndent(const std::string& line) {
  constexpr size_t kFarthest = 24;
  const size_t begin = line.find_first_not_of(' ');
  const size_t gap = line.find("  ", begin);
  const size_t column = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
  return column <= kFarthest ? column : begin;
}

// Appends words, of which the first line of the text has `used` characters already.
void AddWords(const std::string& words, size_t used, size_t indent, size_t width,
              std::string* text) {
  std::istringstream stream(words);
  bool first = true;
  for (std::string word; stream >> word; first = false) {
    const size_t space = first ? 0 : 1;
    if (!first && used + space + word.size() > width) {
      *text += "\n" + std::string(indent, ' ') + word;
      used = indent + word.size();
    } else {
      *text += std::string(space, ' ') + word;
      used += space + word.size();
    }
  }
  *text += "\n";
}

}  // namespace

std::string Wrapped(const std::string& text, int width) {
  const auto columns = static_cast<size_t>(width);
  std::string wrapped, paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) AddWords(paragraph, 0, 0, columns, &wrapped);
    paragraph.clear();
  };
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const size_t begin = line.find_first_not_of(' ');
    if (begin == 0) {
      paragraph += line + " ";
      continue;
    }
    end_paragraph();
    if (begin == std::string::npos) {
      wrapped += "\n";
      continue;
    }
    // The first column stays as it is, with its spaces.
    const size_t indent = HangingIndent(line);
    wrapped += line.substr(0, indent);
    AddWords(line.substr(indent), indent, indent, columns, &wrapped);
  }
  end_paragraph();
  return wrapped;
}

int OutputWidth() {
  constexpr int kLeast = 40, kMost = 100;
  return std::clamp(TerminalColumns(STDOUT_FILENO).value_or(kMost), kLeast, kMost);
}

std::string FlagHelp(const std::string& flag) {
  const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.c_str());
  std::string value = info.default_value.empty() ? "..." : info.default_value;
  if (info.type == "double") value = Text(std::stod(value));  // gflags gives 17 digits
  return "  --" + flag + "=" + value + "\n      " + info.description + "\n";
}

std::string HelpText() {
  std::string text = "trilobe " + std::string(kPurpose) +
                     ".\n\nusage: trilobe COMMAND ARGUMENTS [--FLAG=VALUE ...]\n\n";
  constexpr size_t kNames = 10;
  for (const Command& command : Commands()) {
    text += "  " + command.name + std::string(kNames - command.name.size(), ' ') + command.summary +
            "\n";
  }
  text += "  help      this page, or `trilobe help COMMAND`\n\n" + std::string(kSourceHelp) + "\n";
  return Wrapped(text, OutputWidth());
}

std::string UsageOf(const Command& command) {
  return "trilobe " + command.name + (command.arguments.empty() ? "" : " " + command.arguments) +
         " [--FLAG=VALUE ...]";
}

std::string CommandText(const Command& command, bool all) {
  std::string text = command.summary + "\n\n" + command.details + "\n";
  if (command.particular_help != nullptr) text += "\n" + command.particular_help();
  if (all && !command.lists.empty()) text += "\n" + command.lists;
  const bool has_common = std::ranges::any_of(command.flags, IsCommon);
  if (!command.flags.empty()) text += "\nflags:\n";
  for (const std::string& flag : command.flags) {
    if (!has_common || IsCommon(flag)) text += FlagHelp(flag);
  }
  std::string others;
  for (const std::string& flag : command.flags) {
    if (!has_common || IsCommon(flag)) continue;
    others += all ? FlagHelp(flag) : (others.empty() ? "  --" : ", --") + flag;
  }
  if (all && !others.empty()) text += "\nfurther flags:\n" + others;
  if (!all && !others.empty()) {
    text += "\nfurther flags, on which `trilobe help " + command.name + " --all` has more:\n" +
            others + "\n";
  }
  return text;
}

std::string HelpText(const Command& command, bool all) {
  return Wrapped("usage: " + UsageOf(command) + "\n\n" + CommandText(command, all), OutputWidth());
}

}  // namespace trilobe
