#ifndef TRILOBE_APP_INTERRUPT_H_
#define TRILOBE_APP_INTERRUPT_H_

#include <csignal>

namespace trilobe {

// While an object exists, the first SIGINT (Ctrl-C), SIGTERM or SIGHUP is stored in signal() and
// acknowledged on standard error. The second one ends the program, after an UnsavedModel is
// written. The third one ends it at once. Signals that were ignored at the start stay ignored. A
// closed standard output is a write error, not a signal.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  static int signal();  // 0 while none has come

 private:
  struct sigaction old_int_ {
  }, old_term_{}, old_hup_{}, old_pipe_{};
};

// Exists while a model is not yet on disk. The destructor of the last one ends the program if more
// than one signal has come.
class UnsavedModel {
 public:
  UnsavedModel();
  ~UnsavedModel();
  UnsavedModel(const UnsavedModel&) = delete;
  UnsavedModel& operator=(const UnsavedModel&) = delete;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_INTERRUPT_H_
