#ifndef TRILOBE_TESTS_CORE_FILES_FIRST_BYTES_H_
#define TRILOBE_TESTS_CORE_FILES_FIRST_BYTES_H_

#include <string>

namespace trilobe {

// ASCII text in UTF-16, after `mark`.
inline std::string Utf16(const std::string& mark, const std::string& text, bool little_endian) {
  std::string wide = mark;
  for (const char c : text) {
    wide.push_back(little_endian ? c : '\0');
    wide.push_back(little_endian ? '\0' : c);
  }
  return wide;
}

// How a model file begins.
inline const std::string kJson =
    "{\"format\": \"trilobe-model\", \"version\": 1, \"kind\": \"isotropic\"}";

}  // namespace trilobe

#endif  // TRILOBE_TESTS_CORE_FILES_FIRST_BYTES_H_
