#ifndef TRILOBE_TESTS_APP_RUN_PROGRAM_H_
#define TRILOBE_TESTS_APP_RUN_PROGRAM_H_

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/contents.h"
#include "tests/paths.h"

namespace trilobe {

// A folder of the running test's own, removed with what is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "trilobe_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "cannot make a folder like " << name;
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// Lets a child heed signals. It inherits those that whoever started the tests ignores, as nohup and
// the `&` of a script do.
inline void HeedSignals() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

struct ProgramResult {
  int status = -1;  // exit status; -1 if it was killed by a signal
  std::string out, err;
};

// The words of a command. A fit draws pictures, which takes its time, only in tests that ask for
// them; and those of scenes and of several measurements draw none by themselves.
inline std::vector<std::string> CommandOf(const std::string& program,
                                          const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const auto asks = [&](const char* flag) {
    return std::ranges::any_of(arguments,
                               [&](const std::string& word) { return word.starts_with(flag); });
  };
  if (!arguments.empty() && arguments[0] == "fit" && !asks("--plots") && !asks("--noplots") &&
      !asks("--scene")) {
    words.insert(words.begin() + 2, "--noplots");  // the last word may lack its value
  }
  return words;
}

// Runs the real program with these arguments, without a shell; each of `environment` ("PATH=") is
// set for it. Or a copy of it.
inline ProgramResult RunProgram(const std::vector<std::string>& arguments,
                                const std::vector<std::string>& environment = {},
                                const std::string& program = Program()) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", err = folder / "err";
  std::vector<std::string> words = CommandOf(program, arguments);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::vector<std::string> settings = environment;
  const pid_t pid = fork();
  if (pid == 0) {
    const int out_fd = open(out.c_str(), O_CREAT | O_WRONLY, 0600);
    const int err_fd = open(err.c_str(), O_CREAT | O_WRONLY, 0600);
    if (dup2(out_fd, STDOUT_FILENO) < 0 || dup2(err_fd, STDERR_FILENO) < 0) _exit(126);
    HeedSignals();
    setenv("TRILOBE_TEST_QUIET", "1", 1);  // unless `environment` says otherwise
    for (std::string& setting : settings) putenv(setting.data());
    execv(argv[0], argv.data());
    _exit(127);
  }
  int wait_status = 0;
  waitpid(pid, &wait_status, 0);
  return {WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1, Contents(out), Contents(err)};
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_APP_RUN_PROGRAM_H_
