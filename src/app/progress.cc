#include "trilobe/app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace trilobe {
namespace {

volatile std::sig_atomic_t caught_signal = 0;

extern "C" void OnSignal(int signal) { caught_signal = signal; }

void Catch(int signal, struct sigaction* old) {
  struct sigaction action {};
  action.sa_handler = OnSignal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second one ends the program
  sigaction(signal, nullptr, old);
  if (old->sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

Progress::Progress(const SolverOptions& options)
    : max_iterations_(options.max_iterations),
      max_seconds_(options.max_seconds),
      on_terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::Show(const IterationRecord& record) {
  if (!on_terminal_) return;
  const double relative_change =
      last_.objective > 0 ? (record.objective - last_.objective) / last_.objective : 0;
  std::fprintf(stderr, "\r\033[Kiteration %d   E %.6g", record.iteration, record.objective);
  if (record.iteration > 0) {
    const double left =
        std::min((max_iterations_ - record.iteration) * record.seconds / record.iteration,
                 max_seconds_ - record.seconds);
    std::fprintf(stderr, " (%+.2g %%)   %.1f s, at most %.0f s left", 100 * relative_change,
                 record.seconds, std::ceil(std::max(0.0, left)));
  }
  std::fflush(stderr);
  last_ = record;
}

InterruptGuard::InterruptGuard() {
  caught_signal = 0;
  Catch(SIGINT, &old_int_);
  Catch(SIGTERM, &old_term_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_int_, nullptr);
  sigaction(SIGTERM, &old_term_, nullptr);
}

int InterruptGuard::signal() { return caught_signal; }

}  // namespace trilobe
