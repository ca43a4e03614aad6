#ifndef TRILOBE_TESTS_CORE_BASE_NO_THREADS_H_
#define TRILOBE_TESTS_CORE_BASE_NO_THREADS_H_

#include <pthread.h>

#include <cstddef>

namespace trilobe {

// While it lives, this process gets no new thread from the system, whoever runs it: its stack would
// be larger than any address space.
class NoThreads {
 public:
  NoThreads() {
    pthread_getattr_default_np(&before_);
    pthread_attr_t huge;
    pthread_attr_init(&huge);
    pthread_attr_setstacksize(&huge, size_t{1} << 60);
    pthread_setattr_default_np(&huge);
    pthread_attr_destroy(&huge);
  }
  ~NoThreads() {
    pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

 private:
  pthread_attr_t before_;
};

}  // namespace trilobe

#endif  // TRILOBE_TESTS_CORE_BASE_NO_THREADS_H_
