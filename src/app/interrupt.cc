#include "app/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <exception>
#include <string_view>

namespace trilobe {
namespace {

// Lock-free, so that a handler of signals may use them.
std::atomic<int> caught_signal = 0;
std::atomic<int> signals_caught = 0;
std::atomic<int> unsaved_models = 0;
std::atomic<bool> on_terminal = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// Takes the signal's default action; from a handler it arrives when the handler is through.
void EndBySignal(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// On a terminal in the place of a line of progress.
void WriteLine(std::string_view line) {
  const int error = errno;
  if (on_terminal) static_cast<void>(!write(STDERR_FILENO, "\r\033[K", 4));
  static_cast<void>(!write(STDERR_FILENO, line.data(), line.size()));
  errno = error;
}

extern "C" void OnSignal(int signal) {
  caught_signal = signal;
  switch (++signals_caught) {
    case 1:
      return WriteLine(
          "trilobe: stopping: the best so far is kept; a second Ctrl-C ends at once, but not "
          "before a model is on disk\n");
    case 2:
      if (unsaved_models == 0) break;
      return WriteLine(
          "trilobe: stopping: a model is not on disk yet; a third Ctrl-C ends at once, and loses "
          "it\n");
    default:
      break;
  }
  EndBySignal(signal);
}

void InstallHandler(int signal, struct sigaction* old) {
  struct sigaction action {};
  action.sa_handler = OnSignal;
  action.sa_flags = SA_RESTART;
  sigaction(signal, nullptr, old);
  if (old->sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  caught_signal = signals_caught = 0;
  on_terminal = isatty(STDERR_FILENO) != 0;
  InstallHandler(SIGINT, &old_int_);
  InstallHandler(SIGTERM, &old_term_);
  InstallHandler(SIGHUP, &old_hup_);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &old_pipe_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
  sigaction(SIGHUP, &old_hup_, nullptr);
  sigaction(SIGPIPE, &old_pipe_, nullptr);
}

int InterruptGuard::signal() { return caught_signal; }

UnsavedModel::UnsavedModel() { ++unsaved_models; }

UnsavedModel::~UnsavedModel() {
  // An error on its way ends the program anyway, and says where the model is.
  const bool failed = std::uncaught_exceptions() > 0;
  if (--unsaved_models == 0 && signals_caught > 1 && !failed) EndBySignal(caught_signal);
}

}  // namespace trilobe
