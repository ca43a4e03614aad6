#include "fit/scene/fit_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <thread>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

std::string Content(int k) { return std::string(10000 + k, static_cast<char>('a' + k % 26)); }

TEST(FitCache, KeepsBytesUnderTheirKey) {
  const TestDirectory directory;
  const FitCache cache(directory.Path("made/by/it"));
  EXPECT_EQ(cache.Find("key"), std::nullopt);
  const std::string bytes("a\0b\nc\xff", 6);
  cache.Keep("key", bytes);
  cache.Keep("other", "");
  EXPECT_EQ(cache.Find("key"), bytes);
  EXPECT_EQ(cache.Find("other"), "");
  EXPECT_EQ(cache.Find("third"), std::nullopt);
  cache.Keep("key", "new");
  EXPECT_EQ(cache.Find("key"), "new");
  EXPECT_EQ(FitCache(directory.Path("made/by/it")).Find("key"), "new");
}

TEST(FitCache, WithoutAFolderKeepsNothing) {
  const FitCache cache;
  cache.Keep("key", "content");
  EXPECT_EQ(cache.Find("key"), std::nullopt);
}

// A crash or a person may truncate or change an entry: it counts whole or not at all.
TEST(FitCache, TornEntriesCountAsNone) {
  const TestDirectory directory;
  const FitCache cache(directory.path());
  cache.Keep("key", "the content of an entry");
  const std::string whole = TestDirectory::Content(cache.PathOf("key"));
  const std::string name = std::filesystem::path(cache.PathOf("key")).filename();
  for (size_t size = 0; size < whole.size(); ++size) {
    directory.Make(name, whole.substr(0, size));
    EXPECT_EQ(cache.Find("key"), std::nullopt) << size;
  }
  for (size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] ^= 1;
    directory.Make(name, flipped);
    EXPECT_EQ(cache.Find("key"), std::nullopt) << at;
  }
  directory.Make(name, whole + "x");
  EXPECT_EQ(cache.Find("key"), std::nullopt);
  cache.Keep("key", "again");
  EXPECT_EQ(cache.Find("key"), "again");
}

// A copy of one material's entry over another's would else give that one's model.
TEST(FitCache, AnEntryInThePlaceOfAnotherCountsAsNone) {
  const TestDirectory directory;
  const FitCache cache(directory.path());
  cache.Keep("felt", "a model of felt");
  cache.Keep("rust", "a model of rust");
  std::filesystem::copy_file(cache.PathOf("felt"), cache.PathOf("rust"),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(cache.Find("rust"), std::nullopt);
  EXPECT_EQ(cache.Find("felt"), "a model of felt");
}

TEST(FitCache, ThatCannotBeWrittenToHarmsNothing) {
  const TestDirectory directory;
  const FitCache cache(directory.Path("cache"));
  std::filesystem::remove_all(directory.Path("cache"));
  cache.Keep("key", "content");
  EXPECT_EQ(cache.Find("key"), std::nullopt);
  EXPECT_THAT(ErrorOf([&] { FitCache(directory.Make("file", "")); }),
              IsError(ErrorKind::kFile,
                      {.file = directory.Path("file"), .key = "make", .value = "Not a directory"}));
}

// Writers and readers of the same keys, in threads of several processes.
TEST(FitCache, CanBeSharedByThreadsAndProcesses) {
  constexpr int kProcesses = 3, kRounds = 50, kKeys = 4;
  const TestDirectory directory;
  const auto use = [&] {
    const FitCache cache(directory.path());
    bool good = true;
    for (int round = 0; round < kRounds; ++round) {
      const int k = round % kKeys;
      cache.Keep(std::to_string(k), Content(k));
      const auto found = cache.Find(std::to_string(k));
      good = good && found == Content(k);  // some process has written it, and none another
    }
    return good;
  };
  std::vector<pid_t> children;
  for (int p = 0; p < kProcesses; ++p) {
    const pid_t pid = fork();
    if (pid == 0) {
      bool good[2] = {false, false};
      {
        const std::jthread other([&] { good[1] = use(); });
        good[0] = use();
      }
      _exit(good[0] && good[1] ? 0 : 1);
    }
    children.push_back(pid);
  }
  for (const pid_t pid : children) {
    int status = -1;
    waitpid(pid, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(directory.Names().size(), static_cast<size_t>(kKeys));  // nothing temporary is left
}

TEST(FitCache, FolderFollowsTheXdgSpecification) {
  setenv("HOME", "/home/me", 1);
  setenv("XDG_CACHE_HOME", "/x", 1);
  EXPECT_EQ(DefaultCacheFolder(), "/x/trilobe");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(DefaultCacheFolder(), "/home/me/.cache/trilobe");
  unsetenv("XDG_CACHE_HOME");
  EXPECT_EQ(DefaultCacheFolder(), "/home/me/.cache/trilobe");
  unsetenv("HOME");
  EXPECT_EQ(DefaultCacheFolder(), "");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
