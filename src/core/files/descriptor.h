#ifndef TRILOBE_CORE_FILES_DESCRIPTOR_H_
#define TRILOBE_CORE_FILES_DESCRIPTOR_H_

#include <unistd.h>

#include <utility>

namespace trilobe {

// An open file, closed when it goes out of scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }

  int get() const { return fd_; }
  bool ok() const { return fd_ >= 0; }

 private:
  int fd_;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_DESCRIPTOR_H_
