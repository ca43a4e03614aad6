#ifndef TRILOBE_EXPERIMENTS_PROGRAM_H_
#define TRILOBE_EXPERIMENTS_PROGRAM_H_

#include <gflags/gflags.h>

#include <cstdio>
#include <exception>
#include <span>
#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe {

// The main() of a measuring program: takes the flags off the words, hands the others, of which
// there must be `count`, to `run`, which returns the exit status, and reports errors in a line.
// usage: "NAME [--flag=VALUE] WORD ...".
template <typename Run>
int ProgramMain(int argc, char** argv, const std::string& usage, int count, const Run& run) {
  gflags::SetUsageMessage(usage);
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  try {
    const std::span<char*> words(argv + 1, argc - 1);
    if (argc - 1 != count) throw Error(ErrorKind::kFormat, "usage: " + usage).About("usage");
    return run(words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: error: %s\n", usage.substr(0, usage.find(' ')).c_str(), error.what());
    return 1;
  }
}

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_PROGRAM_H_
