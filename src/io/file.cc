#include "trilobe/io/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <locale>
#include <sstream>
#include <string_view>
#include <utility>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

// Far above any file that this library knows (a MERL file has 35 MB), far below what would exhaust
// a machine.
constexpr off_t kMaxFileSize = off_t{1} << 30;

[[noreturn]] void FailToRead(const std::string& path, const std::string& reason) {
  throw Error("cannot read '" + path + "': " + reason);
}

[[noreturn]] void FailToWrite(const std::string& path, const std::string& reason) {
  throw Error("cannot write '" + path + "': " + reason);
}

// An open file, closed when it goes out of scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { Close(); }

  int get() const { return fd_; }
  bool ok() const { return fd_ >= 0; }
  // False with errno set where the system kept an error back until now, as network file systems do.
  bool Close() { return fd_ < 0 || close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

// A file that vanishes when it goes out of scope, unless it was renamed away before.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
  }

  bool RenameTo(const std::string& target) {
    if (std::rename(path_.c_str(), target.c_str()) != 0) return false;
    path_.clear();
    return true;
  }

 private:
  std::string path_;
};

// False with errno set if not all bytes could be written.
bool WriteAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
  return true;
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

// Where `path` leads if it is a symbolic link, so that the link survives. Anything but a regular
// file is refused: renaming over /dev/null would replace the device.
std::string ResolveTarget(const std::string& path) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, error);
  if (path.empty() || error) {
    FailToWrite(path, path.empty() ? std::strerror(ENOENT) : error.message());
  }
  if (std::filesystem::is_symlink(target)) {
    FailToWrite(path, "it is a symbolic link to nothing; remove it or make what it names");
  }
  struct stat status {};
  if (stat(target.c_str(), &status) != 0) return target;
  if (S_ISDIR(status.st_mode)) FailToWrite(path, "it is a directory; give the name of a file");
  if (!S_ISREG(status.st_mode)) FailToWrite(path, "it is not a regular file");
  return target;
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

// The content is collected in memory first, so that a failing `write` touches no file, and every
// system error is seen with its errno. Not synced to the disk: this guards against a full disk and
// a dying program, not against a power cut.
void WriteFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  const std::string target = ResolveTarget(path);
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  write(stream);
  if (!stream) FailToWrite(path, "its content could not be produced");

  static std::atomic<unsigned> counter{0};
  const std::string temporary_path =
      target + ".tmp-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
  Descriptor file(open(temporary_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.ok()) FailToWrite(path, std::strerror(errno));
  TemporaryFile temporary(temporary_path);
  const bool ok = WriteAll(file.get(), stream.view()) && file.Close() && temporary.RenameTo(target);
  if (!ok) FailToWrite(path, std::strerror(errno));
}

void MakeDirectories(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error && !std::filesystem::is_directory(path, error) && !error) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) throw Error("cannot make the directory '" + path + "': " + error.message());
}

}  // namespace trilobe
