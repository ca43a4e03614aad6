#include "core/files/file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <locale>
#include <ostream>
#include <stdexcept>
#include <string>

#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

void WriteText(const std::string& path, const std::string& text) {
  WriteFile(path, [&](std::ostream& out) { out << text; });
}

// Ends a forked child, with status 0 only if `check` holds.
[[noreturn]] void ExitWith(const std::function<bool()>& check) {
  int status = 1;
  try {
    status = check() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
  }
  _exit(status);
}

TEST(ReadFile, GivesAllBytes) {
  const TestDirectory directory;
  const std::string bytes("a\0b\r\n\xff", 6);
  EXPECT_EQ(ReadFile(directory.Make("file", bytes)), bytes);
  EXPECT_EQ(ReadFile(directory.Make("empty", "")), "");
}

TEST(ReadFile, RefusesWhatIsNoFile) {
  const TestDirectory directory;
  EXPECT_THAT(ErrorOf([&] { ReadFile(directory.Path("missing")); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("missing"),
                                         .key = "read",
                                         .value = "No such file or directory"}));
  EXPECT_THAT(
      ErrorOf([&] { ReadFile(directory.path()); }),
      IsError(ErrorKind::kFile, {.file = directory.path(), .key = "read", .value = "directory"}));
  EXPECT_THAT(ErrorOf([] { ReadFile("/dev/zero"); }),
              IsError(ErrorKind::kFile, {.key = "read", .value = "not a regular file"}));
  EXPECT_THAT(ErrorOf([] { ReadFile(""); }),
              IsError(ErrorKind::kFile, {.key = "read", .value = "No such file or directory"}));
  // A pipe that nobody writes to must not make it wait.
  ASSERT_EQ(mkfifo(directory.Path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(
      ErrorOf([&] { ReadFile(directory.Path("pipe")); }),
      IsError(ErrorKind::kFile,
              {.file = directory.Path("pipe"), .key = "read", .value = "not a regular file"}));
}

TEST(ReadFile, RefusesAHugeFileBeforeReadingIt) {
  const TestDirectory directory;
  const std::string path = directory.Make("huge", "");
  std::filesystem::resize_file(path, uintmax_t{1} << 40);  // sparse
  EXPECT_THAT(ErrorOf([&] { ReadFile(path); }),
              IsError(ErrorKind::kFile, {.file = path, .key = "read", .value = "size"}));
}

TEST(ReadFile, ReportsAnUnreadableFile) {
  const TestDirectory directory;
  const std::string path = directory.Make("secret", "text");
  ASSERT_EQ(chmod(path.c_str(), 0), 0);
  EXPECT_EXIT(ExitWith([&] {
                // The superuser may read anything, so be somebody else.
                if (geteuid() == 0 && setuid(65534) != 0) return false;
                return ErrorOf([&] { ReadFile(path); })->facts().value == "Permission denied";
              }),
              testing::ExitedWithCode(0), "");
}

TEST(WriteFile, WritesAndReplaces) {
  const TestDirectory directory;
  const std::string path = directory.Path("file");
  WriteText(path, "first, the longer one");
  WriteText(path, std::string("second\0", 7));
  EXPECT_EQ(TestDirectory::Content(path), std::string("second\0", 7));
  EXPECT_THAT(directory.Names(), ElementsAre("file"));
}

TEST(WriteFile, FollowsASymbolicLink) {
  const TestDirectory directory;
  const std::string path = directory.Make("file", "old");
  std::filesystem::create_symlink("file", directory.Path("link"));
  WriteText(directory.Path("link"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(directory.Path("link")));
  EXPECT_EQ(TestDirectory::Content(path), "new");
}

TEST(WriteFile, PrintsNumbersInTheClassicLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const TestDirectory directory;
  const std::locale before = std::locale::global({std::locale::classic(), new Comma});
  WriteFile(directory.Path("file"), [](std::ostream& out) { out << 0.5; });
  std::locale::global(before);
  EXPECT_EQ(TestDirectory::Content(directory.Path("file")), "0.5");
}

TEST(WriteFile, LeavesEverythingAsItWasWhenTheWriterFails) {
  const TestDirectory directory;
  const std::string path = directory.Make("file", "old");
  EXPECT_THROW(WriteFile(path,
                         [](std::ostream& out) {
                           out << "half";
                           throw std::out_of_range("the writer's own error");
                         }),
               std::out_of_range);
  EXPECT_THAT(
      ErrorOf([&] { WriteFile(path, [](std::ostream& out) { out.setstate(std::ios::failbit); }); }),
      IsError(ErrorKind::kFile, {.file = path, .key = "write", .value = "content"}));
  EXPECT_EQ(TestDirectory::Content(path), "old");
  EXPECT_THAT(directory.Names(), ElementsAre("file"));
}

TEST(WriteFile, RefusesImpossibleTargets) {
  const TestDirectory directory;
  EXPECT_THAT(
      ErrorOf([&] { WriteText(directory.path(), ""); }),
      IsError(ErrorKind::kFile, {.file = directory.path(), .key = "write", .value = "directory"}));
  EXPECT_THAT(ErrorOf([&] { WriteText(directory.Path("no/file"), ""); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("no/file"), .key = "write"}));
  EXPECT_THAT(ErrorOf([] { WriteText("", ""); }),
              IsError(ErrorKind::kFile, {.key = "write", .value = "No such file or directory"}));
  // Renaming over a device would replace it.
  EXPECT_THAT(ErrorOf([] { WriteText("/dev/null", ""); }),
              IsError(ErrorKind::kFile, {.key = "write", .value = "not a regular file"}));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_THAT(directory.Names(), IsEmpty());
}

TEST(WriteFile, ReportsAnUnwritableDirectory) {
  const TestDirectory directory;
  ASSERT_EQ(chmod(directory.path().c_str(), 0555), 0);
  EXPECT_EXIT(ExitWith([&] {
                if (geteuid() == 0 && setuid(65534) != 0) return false;
                return ErrorOf([&] { WriteText(directory.Path("file"), "text"); })->facts().value ==
                       "Permission denied";
              }),
              testing::ExitedWithCode(0), "");
  ASSERT_EQ(chmod(directory.path().c_str(), 0755), 0);
  EXPECT_THAT(directory.Names(), IsEmpty());
}

// Files made under `umask 0777` cannot be opened again, nor can files be made in its folders: that
// is known before the work.
TEST(CheckWritable, FindsOutThatFilesCouldNotBeOpened) {
  const TestDirectory directory;
  ASSERT_EQ(chmod(directory.path().c_str(), 0777), 0);
  EXPECT_EXIT(ExitWith([&] {
                if (geteuid() == 0 && setuid(65534) != 0) return false;
                umask(0777);
                return ErrorOf([&] { CheckWritable(directory.Path("file")); })->facts().value ==
                       "permissions";
              }),
              testing::ExitedWithCode(0), "");
  EXPECT_THAT(directory.Names(), IsEmpty());
}

// Makes writes beyond 1 MB fail in this process: by a small file system at `directory` where that
// is permitted, else by a limit on the length of files. Returns the reason to expect.
std::string FillTheDisk(const std::string& directory) {
  if (unshare(CLONE_NEWNS) == 0 &&
      mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
      mount("tmpfs", directory.c_str(), "tmpfs", 0, "size=1m") == 0) {
    return "No space left on device";
  }
  const rlimit limit = {1 << 20, 1 << 20};
  std::signal(SIGXFSZ, SIG_IGN);
  if (setrlimit(RLIMIT_FSIZE, &limit) != 0) throw std::runtime_error("setrlimit failed");
  return "File too large";
}

TEST(WriteFile, LeavesEverythingAsItWasOnAFullDisk) {
  const TestDirectory directory;
  EXPECT_EXIT(ExitWith([&] {
                const std::string reason = FillTheDisk(directory.path());
                const std::string path = directory.Make("file", "old");
                const auto error = ErrorOf([&] { WriteText(path, std::string(3 << 20, 'x')); });
                std::cerr << "message: " << error->what() << std::endl;
                return error->facts().value == reason && error->facts().file == path &&
                       TestDirectory::Content(path) == "old" &&
                       directory.Names() == std::vector<std::string>{"file"};
              }),
              testing::ExitedWithCode(0), "");
}

// A run that was killed while it wrote leaves a temporary file, whose lock nobody holds.
TEST(WriteFile, IsNotInTheWayOfWhatAKilledRunLeft) {
  const TestDirectory directory;
  const std::string path = directory.Path("file");
  // Killed before it can rename, many times, so that names could collide if they were not random.
  for (int k = 0; k < 5; ++k) {
    EXPECT_EXIT(WriteFile(
                    path, [](std::ostream& out) { out << "half"; },
                    [](std::string_view) { std::raise(SIGKILL); }),
                testing::KilledBySignal(SIGKILL), "");
  }
  EXPECT_EQ(directory.Names().size(), 5U);
  WriteText(path, "whole");
  EXPECT_EQ(TestDirectory::Content(path), "whole");

  directory.Make(".somebody.trilobe-tmp-notours", "");
  directory.Make("file.trilobe-tmp-0123456789abcdef", "");
  SweepTemporaryFiles(directory.path());
  EXPECT_THAT(directory.Names(), ElementsAre(".somebody.trilobe-tmp-notours", "file",
                                             "file.trilobe-tmp-0123456789abcdef"));
}

TEST(SweepTemporaryFiles, LeavesWhatIsStillBeingWritten) {
  const TestDirectory directory;
  const std::string path = directory.Path("file");
  WriteFile(
      path, [](std::ostream& out) { out << "new"; },
      [&](std::string_view) {
        SweepTemporaryFiles(directory.path());
        EXPECT_EQ(directory.Names().size(), 1U);
      });
  EXPECT_EQ(TestDirectory::Content(path), "new");
  SweepTemporaryFiles(directory.Path("missing"));  // nothing to do
}

TEST(WriteFile, ShowsTheOldFileUntilTheNewOneIsWhole) {
  const TestDirectory directory;
  const std::string path = directory.Make("file", "old");
  WriteFile(
      path, [](std::ostream& out) { out << "new"; },
      [&](std::string_view content) {
        EXPECT_EQ(content, "new");
        EXPECT_EQ(TestDirectory::Content(path), "old");
      });
  EXPECT_THAT(ErrorOf([&] {
                WriteFile(
                    path, [](std::ostream& out) { out << "newer"; },
                    [](std::string_view) { throw Error(ErrorKind::kData, "no"); });
              }),
              IsError(ErrorKind::kData));
  EXPECT_EQ(TestDirectory::Content(path), "new");
  EXPECT_THAT(directory.Names(), ElementsAre("file"));
}

TEST(MakeNamelessFile, IsInNoFolder) {
  const TestDirectory directory;
  const NamelessFile file = MakeNamelessFile(directory.Path("a.png"));
  EXPECT_THAT(directory.Names(), IsEmpty());
  EXPECT_GE(std::fputs("text", file.get()), 0);
  std::rewind(file.get());
  EXPECT_EQ(std::fgetc(file.get()), 't');
  EXPECT_THAT(ErrorOf([&] { MakeNamelessFile(directory.Path("none/a.png")); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("none/a.png"), .key = "write"}));
}

TEST(CheckWritable, FindsOutBeforeAndLeavesNothing) {
  const TestDirectory directory;
  const std::string file = directory.Make("file", "old");
  CheckWritable(file);
  CheckWritable(directory.Path("new"));
  CheckWritable(directory.Path("a/b/new"));  // whose folders can be made
  CheckWritable("relative");
  EXPECT_EQ(TestDirectory::Content(file), "old");
  EXPECT_THAT(directory.Names(), ElementsAre("file"));
  std::filesystem::create_symlink("nothing", directory.Path("dangling"));
  EXPECT_THAT(
      ErrorOf([&] { CheckWritable(directory.Path("dangling")); }),
      IsError(ErrorKind::kFile,
              {.file = directory.Path("dangling"), .key = "write", .value = "dangling link"}));
  EXPECT_THAT(
      ErrorOf([&] { CheckWritable(directory.path()); }),
      IsError(ErrorKind::kFile, {.file = directory.path(), .key = "write", .value = "directory"}));
  EXPECT_THAT(ErrorOf([&] { CheckWritable(directory.Path("file/a")); }),
              IsError(ErrorKind::kFile,
                      {.file = directory.Path("file/a"), .key = "write", .value = "no directory"}));
  EXPECT_THAT(ErrorOf([] { CheckWritable("/proc/a/b"); }),
              IsError(ErrorKind::kFile,
                      {.file = "/proc/a/b", .key = "write", .value = "No such file or directory"}));
}

TEST(CheckWritable, SeesAFullDisk) {
  const TestDirectory directory;
  EXPECT_EXIT(ExitWith([&] {
                const std::string reason = FillTheDisk(directory.path());
                if (reason == "File too large") return true;  // no file system of its own
                const std::string path = directory.Path("file");
                CheckWritable(path);
                std::ofstream(directory.Path("other")) << std::string(1 << 20, 'x');
                return ErrorOf([&] { CheckWritable(path); })->facts().value == reason &&
                       directory.Names() == std::vector<std::string>{"other"};
              }),
              testing::ExitedWithCode(0), "");
}

TEST(MakeDirectories, MakesParentsAndAcceptsWhatIsThere) {
  const TestDirectory directory;
  MakeDirectories(directory.Path("a/b/c"));
  MakeDirectories(directory.Path("a/b/c"));
  MakeDirectories(directory.Path("d/"));
  EXPECT_TRUE(std::filesystem::is_directory(directory.Path("a/b/c")));
  EXPECT_TRUE(std::filesystem::is_directory(directory.Path("d")));
}

TEST(MakeDirectories, RefusesAFileInTheWay) {
  const TestDirectory directory;
  directory.Make("file", "");
  EXPECT_THAT(ErrorOf([&] { MakeDirectories(directory.Path("file")); }),
              IsError(ErrorKind::kFile,
                      {.file = directory.Path("file"), .key = "make", .value = "Not a directory"}));
  EXPECT_THAT(
      ErrorOf([&] { MakeDirectories(directory.Path("file/a")); }),
      IsError(ErrorKind::kFile,
              {.file = directory.Path("file/a"), .key = "make", .value = "Not a directory"}));
  EXPECT_THAT(ErrorOf([] { MakeDirectories(""); }),
              IsError(ErrorKind::kFile, {.key = "make", .value = "Invalid argument"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
