#include "core/files/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/files/descriptor.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Far above any file that this library knows (a MERL file has 35 MB), far below what would exhaust
// a machine.
constexpr off_t kMaxFileSize = off_t{1} << 30;

[[noreturn]] void FailToRead(const std::string& path, const std::string& reason) {
  throw Error("cannot read '" + path + "': " + reason);
}

// Bytes read, fewer than `size` only at the end of the file; -1 with errno set on failure.
ssize_t ReadAll(int fd, char* data, size_t size) {
  size_t done = 0;
  while (done < size) {
    const ssize_t count = read(fd, data + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return -1;
    if (count == 0) break;
    done += static_cast<size_t>(count);
  }
  return static_cast<ssize_t>(done);
}

}  // namespace

std::string ReadFile(const std::string& path) {
  // O_NONBLOCK keeps the call from waiting for a writer when the path is a named pipe.
  Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.ok() || fstat(file.get(), &status) != 0) FailToRead(path, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) FailToRead(path, "it is a directory; give the name of a file");
  if (!S_ISREG(status.st_mode)) FailToRead(path, "it is not a regular file");
  if (status.st_size > kMaxFileSize) {
    FailToRead(path, "it has " + std::to_string(status.st_size) +
                         " bytes, more than any measurement or model (at most 1 GiB)");
  }
  std::string bytes(static_cast<size_t>(status.st_size), '\0');
  const ssize_t count = ReadAll(file.get(), bytes.data(), bytes.size());
  char beyond = 0;
  const ssize_t excess = count < 0 ? -1 : ReadAll(file.get(), &beyond, 1);
  if (excess < 0) FailToRead(path, std::strerror(errno));
  if (count < status.st_size || excess > 0) {
    FailToRead(path, "its length changed while it was read; try again when it is complete");
  }
  return bytes;
}

}  // namespace trilobe
