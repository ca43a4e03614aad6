#ifndef TRILOBE_TESTS_CONTENTS_H_
#define TRILOBE_TESTS_CONTENTS_H_

#include <fstream>
#include <sstream>
#include <string>
#include <utility>

namespace trilobe {

// The bytes of a file, read without the code under test; none if there is no such file. Not one by
// one: of the 35 MB of a measurement that takes seconds where nothing is optimised.
inline std::string Contents(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return std::move(bytes).str();
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_CONTENTS_H_
