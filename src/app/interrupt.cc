#include "trilobe/app/interrupt.h"

#include <atomic>
#include <exception>

namespace trilobe {
namespace {

// Lock-free, so that a handler of signals may use them.
std::atomic<int> caught_signal = 0;
std::atomic<int> signals_caught = 0;
std::atomic<int> unsaved_models = 0;
static_assert(std::atomic<int>::is_always_lock_free);

// As if nobody had caught it; from a handler it arrives when the handler is through.
void EndBy(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

extern "C" void OnSignal(int signal) {
  caught_signal = signal;
  if (++signals_caught > 1 && unsaved_models == 0) EndBy(signal);
}

void Catch(int signal, struct sigaction* old) {
  struct sigaction action {};
  action.sa_handler = OnSignal;
  action.sa_flags = SA_RESTART;
  sigaction(signal, nullptr, old);
  if (old->sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  caught_signal = signals_caught = 0;
  Catch(SIGINT, &old_int_);
  Catch(SIGTERM, &old_term_);
  Catch(SIGHUP, &old_hup_);
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
  if (--unsaved_models == 0 && signals_caught > 1 && !failed) EndBy(caught_signal);
}

}  // namespace trilobe
