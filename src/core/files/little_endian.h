#ifndef TRILOBE_CORE_FILES_LITTLE_ENDIAN_H_
#define TRILOBE_CORE_FILES_LITTLE_ENDIAN_H_

#include <bit>
#include <cstring>
#include <type_traits>

namespace trilobe {

// MERL and RGL files are little-endian and are copied without swapping bytes. A port to a
// big-endian machine starts here: all readers and writers of binary numbers include this file.
static_assert(std::endian::native == std::endian::little, "files are read as little-endian");

// The number stored at `bytes`, which need not be aligned.
template <typename T>
requires std::is_arithmetic_v<T> T LoadLittleEndian(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_LITTLE_ENDIAN_H_
