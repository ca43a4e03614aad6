// System limits on memory, file size and cores are reported in one line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/paths.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;

// Runs the program within limits of the shell's `ulimit`, for at most ten seconds of processor
// time.
ProgramResult RunWithin(const std::string& limit, const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"-c", "ulimit -t 10; ulimit " + limit + "; exec \"$0\" \"$@\"",
                                    Program()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunProgram(words, {}, "/bin/sh");
}

bool IsOneLine(const std::string& text) { return std::ranges::count(text, '\n') == 1; }

// OpenBLAS would try for ever to map its work space, and so would a thread of its own.
TEST(Limits, WithLittleMemoryEachCommandEnds) {
  if (kSanitized) GTEST_SKIP() << "sanitizers reserve terabytes";
  int failed = 0, done = 0;
  for (int kib = 120000; kib <= 360000; kib += 80000) {
    const std::string limit = "-v " + std::to_string(kib);
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{"fit", "synth:felt@12x12x24", "--solver=newton",
                                   "--max_iterations=1", "--lobes=1", "--threads=1", "--noplots"},
          {"info", "synth:felt@12x12x24"}}) {
      const ProgramResult result = RunWithin(limit, command);
      EXPECT_TRUE(result.status == 0 || result.status == 1)
          << limit << ", " << command[0] << ": " << result.status << "\n"
          << result.err;
      if (result.status == 1) {
        EXPECT_THAT(result.err, HasSubstr("out of memory"));
        EXPECT_TRUE(IsOneLine(result.err)) << result.err;
      }
      ++(result.status == 0 ? done : failed);
    }
  }
  EXPECT_GT(failed, 0);
  EXPECT_GT(done, 0);
}

TEST(Limits, OnSizesOfFilesAreErrorsOfWriting) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  // A MERL file has 35 MB, and the first is found out before the work.
  const std::vector<std::string> commands[] = {
      {"fit", "synth:felt@12x12x24", "--max_iterations=1", "--noplots", "--out=" + out},
      {"synth", "felt", "--out=" + out + "/felt.binary"}};
  for (const std::vector<std::string>& command : commands) {
    std::filesystem::create_directory(out);
    const ProgramResult result = RunWithin("-f 100", command);
    EXPECT_EQ(result.status, 1) << command[0];
    EXPECT_THAT(result.err, HasSubstr("File too large")) << command[0];
    EXPECT_TRUE(IsOneLine(result.err)) << result.err;
    EXPECT_TRUE(std::filesystem::is_empty(out)) << command[0];
  }
}

TEST(Limits, MoreThreadsThanCoresAreNoneOfUse) {
  const ProgramResult result = RunProgram({"info", "synth:felt@12x12x24", "--threads=3000"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr("--threads=3000 is more than there are cores"));
  EXPECT_TRUE(IsOneLine(result.err)) << result.err;
  EXPECT_THAT(result.err,
              HasSubstr("using " + std::to_string(std::thread::hardware_concurrency())));
}

// Some files of the system are regular by name, and who reads them waits until there is more.
TEST(Limits, AFolderOfSpecialFilesIsReadAtOnce) {
  const TemporaryFolder folder;
  const std::string data = folder / "data";
  std::filesystem::create_directory(data);
  ASSERT_EQ(mkfifo((data + "/pipe").c_str(), 0600), 0);
  for (const std::string& source : {std::string("/proc"), data}) {
    const ProgramResult result = RunProgram({"fit", source, "--out=" + (folder / "out")});
    EXPECT_TRUE(result.status == 1 || result.status == 3) << source << ": " << result.err;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
