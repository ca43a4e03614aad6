#include "core/files/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <locale>
#include <random>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

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

// Far above any file that this library reads (a MERL file has 35 MB), far below the memory of a
// machine.
constexpr off_t kMaxFileSize = off_t{1} << 30;

// `value` is the reason in a word, for programs; without, it is the system's.
[[noreturn]] void FailToRead(const std::string& path, const std::string& reason,
                             const std::string& value = "") {
  throw Error(ErrorKind::kFile, "cannot read '" + path + "': " + reason)
      .At(path)
      .About("read", value.empty() ? reason : value);
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

[[noreturn]] void FailToWrite(const std::string& path, const std::string& reason,
                              const std::string& value = "") {
  throw Error(ErrorKind::kFile, "cannot write '" + path + "': " + reason)
      .At(path)
      .About("write", value.empty() ? reason : value);
}

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

// Why no file can be made at `path`, by errno.
std::string WhyNot(const std::filesystem::path& path) {
  std::string reason = std::strerror(errno);  // before other calls
  std::error_code ignored;
  const std::filesystem::path folder = path.parent_path();
  if (folder.empty() || std::filesystem::exists(folder, ignored)) return reason;
  return "there is no folder '" + folder.string() + "'; make it first";
}

// Marks the names of temporary files, which are hidden: .NAME.trilobe-tmp-0123456789abcdef
constexpr std::string_view kTemporaryMark = ".trilobe-tmp-";
constexpr size_t kTemporaryDigits = 16;

std::string TemporaryName(const std::filesystem::path& target) {
  // Cut so that the whole name does not exceed the limit of file names.
  const std::string name = target.filename().string().substr(0, 200);
  return target.parent_path() / ("." + name + std::string(kTemporaryMark) + RandomDigits());
}

bool IsTemporaryName(std::string_view name) {
  const size_t mark = name.rfind(kTemporaryMark);
  return mark != std::string_view::npos && mark > 0 && name.front() == '.' &&
         name.size() == mark + kTemporaryMark.size() + kTemporaryDigits &&
         name.find_first_not_of("0123456789abcdef", mark + kTemporaryMark.size()) ==
             std::string_view::npos;
}

// A new file beside `target`, removed at the end of its scope unless it was renamed. It is locked
// while its writer lives. SweepTemporaryFiles recognises abandoned files by the lock, since process
// numbers may coincide between containers.
class TemporaryFile {
 public:
  // ok() is false, with errno set, where none can be made.
  explicit TemporaryFile(const std::filesystem::path& target) : file_(-1) {
    constexpr int kAttempts = 100;
    for (int k = 0; k < kAttempts; ++k) {
      path_ = TemporaryName(target);
      const int fd = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno == EEXIST) continue;
      file_ = Descriptor(fd);
      if (fd < 0) break;
      // Without locks in the file system, nothing is swept either.
      flock(fd, LOCK_EX);
      struct stat status {};
      if (fstat(fd, &status) == 0 && status.st_nlink > 0) return;
      // A sweeper was faster than the lock.
    }
    file_ = Descriptor(-1);
    path_.clear();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { Unlink(); }

  bool ok() const { return file_.get() >= 0; }
  // Whether this process could read and write it by its name.
  bool MayBeOpened() const {
    return faccessat(AT_FDCWD, path_.c_str(), R_OK | W_OK, AT_EACCESS) == 0;
  }
  // Removes the name; the file lives until it is closed.
  void Unlink() {
    if (!path_.empty()) unlink(path_.c_str());
    path_.clear();
  }
  bool Write(std::string_view bytes) { return WriteAll(file_.get(), bytes); }
  bool RenameTo(const std::string& target) {
    // Network file systems may report errors only when a descriptor is closed; the lock is kept.
    const int copy = dup(file_.get());
    if (copy < 0 || close(copy) != 0) return false;
    if (std::rename(path_.c_str(), target.c_str()) != 0) return false;
    path_.clear();
    return true;
  }

 private:
  Descriptor file_;
  std::string path_;
};

// The target of `path` if it is a symbolic link, so that the link survives. Anything but a regular
// file is refused: renaming over /dev/null would replace the device.
std::string ResolveTarget(const std::string& path) {
  std::error_code error;
  const std::filesystem::path target =
      std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  if (path.empty() || error) {
    FailToWrite(path, path.empty() ? std::strerror(ENOENT) : error.message());
  }
  if (std::filesystem::is_symlink(target)) {
    FailToWrite(path, "it is a symbolic link to nothing; remove it or make what it names",
                "dangling link");
  }
  struct stat status {};
  if (stat(target.c_str(), &status) != 0) return target;
  if (S_ISDIR(status.st_mode)) {
    FailToWrite(path, "it is a directory; give the name of a file", "directory");
  }
  if (!S_ISREG(status.st_mode)) FailToWrite(path, "it is not a regular file", "not a regular file");
  return target;
}

}  // namespace

std::string ReadFile(const std::string& path) {
  // O_NONBLOCK keeps the call from waiting for a writer when the path is a named pipe.
  Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.ok() || fstat(file.get(), &status) != 0) FailToRead(path, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) {
    FailToRead(path, "it is a directory; give the name of a file", "directory");
  }
  if (!S_ISREG(status.st_mode)) FailToRead(path, "it is not a regular file", "not a regular file");
  if (status.st_size > kMaxFileSize) {
    FailToRead(path,
               "it has " + std::to_string(status.st_size) +
                   " bytes, more than any measurement or model (at most 1 GiB)",
               "size");
  }
  std::string bytes(static_cast<size_t>(status.st_size), '\0');
  const ssize_t count = ReadAll(file.get(), bytes.data(), bytes.size());
  char beyond = 0;
  const ssize_t excess = count < 0 ? -1 : ReadAll(file.get(), &beyond, 1);
  if (excess < 0) FailToRead(path, std::strerror(errno));
  if (count < status.st_size || excess > 0) {
    FailToRead(path, "its length changed while it was read; try again when it is complete",
               "length");
  }
  return bytes;
}

std::string RandomDigits() {
  std::random_device random;
  std::array<char, kTemporaryDigits + 1> digits;
  std::snprintf(digits.data(), digits.size(), "%08x%08x", random(), random());
  return digits.data();
}

std::string EndingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension();
  std::ranges::transform(ending, ending.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

// The content is collected in memory first, so that a failing `write` touches no file, and every
// system error is seen with its errno. Not synced to the disk: this guards against a full disk and
// a dying program, not against a power cut.
void WriteFile(const std::string& path, const std::function<void(std::ostream&)>& write,
               const BeforeRenaming& before_renaming) {
  const std::string target = ResolveTarget(path);
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.exceptions(std::ios::badbit);  // so that lack of memory throws
  write(stream);
  if (!stream) FailToWrite(path, "its content could not be produced", "content");

  TemporaryFile file(target);
  if (!file.ok()) FailToWrite(path, WhyNot(path));
  if (!file.Write(stream.view())) FailToWrite(path, std::strerror(errno));
  before_renaming(stream.view());
  if (!file.RenameTo(target)) FailToWrite(path, std::strerror(errno));
}

NamelessFile MakeNamelessFile(const std::string& path) {
  const std::string name = TemporaryName(ResolveTarget(path));
  const int fd = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (fd < 0) FailToWrite(path, WhyNot(path));
  unlink(name.c_str());
  NamelessFile file(fdopen(fd, "w+"));
  if (!file) {
    const std::string reason = std::strerror(errno);
    close(fd);
    FailToWrite(path, reason);
  }
  return file;
}

void CheckWritable(const std::string& path) {
  std::filesystem::path target = ResolveTarget(path);
  std::error_code error;
  while (!std::filesystem::exists(target.parent_path(), error) && !error) {
    target = target.parent_path();
  }
  if (!std::filesystem::is_directory(target.parent_path(), error)) {
    FailToWrite(path, "'" + target.parent_path().string() + "' is not a directory", "no directory");
  }
  // The size of a model and its report, so that a full disk is detected.
  const std::string bytes(size_t{1} << 18, ' ');
  TemporaryFile file(target);
  const bool stays_open = !file.ok() || file.MayBeOpened();
  file.Unlink();  // a signal may end the program at any time
  if (!stays_open) {
    FailToWrite(path, "nobody could open the file afterwards, by its permissions; run `umask 022`",
                "permissions");
  }
  if (!file.ok() || !file.Write(bytes)) FailToWrite(path, std::strerror(errno));
}

void SweepTemporaryFiles(const std::string& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> left;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (IsTemporaryName(it->path().filename().string())) left.push_back(it->path());
  }
  for (const std::filesystem::path& path : left) {
    const Descriptor file(open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
    if (file.ok() && flock(file.get(), LOCK_EX | LOCK_NB) == 0) unlink(path.c_str());
  }
}

void MakeDirectories(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!error && !std::filesystem::is_directory(path, error) && !error) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) {
    throw Error(ErrorKind::kFile, "cannot make the directory '" + path + "': " + error.message())
        .At(path)
        .About("make", error.message());
  }
}

}  // namespace trilobe
