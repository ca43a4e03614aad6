#ifndef TRILOBE_TESTS_APP_RUN_ON_TERMINAL_H_
#define TRILOBE_TESTS_APP_RUN_ON_TERMINAL_H_

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/paths.h"

namespace trilobe {

struct TerminalResult {
  int status = -1;   // exit status; -1 if it was killed by a signal
  std::string text;  // received by the terminal, control characters included
};

// Runs the real program on a terminal of its own, of so many columns. As soon as it has written
// `cue`, sends it `signal` (none if 0), that many times.
inline TerminalResult RunOnTerminal(const std::vector<std::string>& arguments,
                                    const std::string& cue, int signal, int times = 1,
                                    uint16_t columns = 80) {
  std::vector<std::string> words = CommandOf(Program(), arguments);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int terminal = -1;
  const winsize size_of_terminal = {
      .ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
  const pid_t pid = forkpty(&terminal, nullptr, nullptr, &size_of_terminal);
  if (pid == 0) {
    HeedSignals();
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
    execv(argv[0], argv.data());
    _exit(127);
  }
  TerminalResult result;
  bool sent = signal == 0;
  char buffer[4096];
  // A read from a terminal whose program has ended fails.
  for (ssize_t size; (size = read(terminal, buffer, sizeof(buffer))) > 0;) {
    result.text.append(buffer, static_cast<size_t>(size));
    if (!sent && result.text.find(cue) != std::string::npos) {
      for (int k = 0; k < times; ++k) {
        if (k > 0) usleep(20000);  // two that wait at the same time count as one
        kill(pid, signal);
      }
      sent = true;
    }
  }
  close(terminal);
  int wait_status = 0;
  waitpid(pid, &wait_status, 0);
  if (WIFEXITED(wait_status)) result.status = WEXITSTATUS(wait_status);
  return result;
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_APP_RUN_ON_TERMINAL_H_
