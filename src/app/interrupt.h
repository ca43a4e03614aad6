#ifndef TRILOBE_APP_INTERRUPT_H_
#define TRILOBE_APP_INTERRUPT_H_

#include <csignal>

namespace trilobe {

// While one lives, the first SIGINT (Ctrl-C), SIGTERM or SIGHUP does not end the program but is
// kept in signal(), and acknowledged on standard error; the next one ends it, unless there is a
// model that is not yet on disk (UnsavedModel): then the program goes on until it is. A third one
// ends it in any case. A signal that the program was started to ignore stays ignored. A reader of
// standard output that has gone away is an error of writing.
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

// One lives as long as there is something that must reach the disk. With the last of them the
// program ends, if more than one signal has come.
class UnsavedModel {
 public:
  UnsavedModel();
  ~UnsavedModel();
  UnsavedModel(const UnsavedModel&) = delete;
  UnsavedModel& operator=(const UnsavedModel&) = delete;
};

}  // namespace trilobe

#endif  // TRILOBE_APP_INTERRUPT_H_
