#ifndef TRILOBE_TESTS_TEST_DIRECTORY_H_
#define TRILOBE_TESTS_TEST_DIRECTORY_H_

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/contents.h"

namespace trilobe {

// A fresh folder for one test, gone after it.
class TestDirectory {
 public:
  TestDirectory() {
    std::string pattern = testing::TempDir() + "/trilobe-XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for the test");
    path_ = pattern;
    chmod(path_.c_str(), 0755);
  }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;
  ~TestDirectory() { std::filesystem::remove_all(path_); }

  const std::string& path() const { return path_; }
  std::string Path(const std::string& name) const { return path_ + "/" + name; }

  // Makes a file without the code under test, and returns its path.
  std::string Make(const std::string& name, std::string_view content) const {
    std::ofstream(Path(name), std::ios::binary) << content;
    return Path(name);
  }

  static std::string Content(const std::string& path) { return Contents(path); }

  // Sorted names of what is in the folder.
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.push_back(entry.path().filename());
    }
    std::ranges::sort(names);
    return names;
  }

 private:
  std::string path_;
};

}  // namespace trilobe

#endif  // TRILOBE_TESTS_TEST_DIRECTORY_H_
