#ifndef TRILOBE_APP_COMMAND_LINE_H_
#define TRILOBE_APP_COMMAND_LINE_H_

#include <string>
#include <vector>

namespace trilobe {

// What a user has typed, taken apart by the rules of gflags: a word that begins with - is a flag,
// whose value follows after = or, but for one of true and false, as the next word; after -- all are
// words.
struct CommandLine {
  struct Flag {
    std::string name;   // without its dashes, nor the no of --noplots
    std::string value;  // "true" or "false" where it stands alone
    bool known = true;  // else the name is as it was typed
  };
  std::vector<std::string> words;
  std::vector<Flag> flags;
  bool help = false;  // --help, -help or -h
};

// Throws Error where the last flag lacks its value.
CommandLine ReadCommandLine(int argc, const char* const* argv);

// Sets flags that are known. Throws Error for a value that is of another type than its flag.
void SetFlags(const CommandLine& line, const char* program);

}  // namespace trilobe

#endif  // TRILOBE_APP_COMMAND_LINE_H_
