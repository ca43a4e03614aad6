#ifndef TRILOBE_CORE_SYSTEM_CONTENT_HASH_H_
#define TRILOBE_CORE_SYSTEM_CONTENT_HASH_H_

#include <string>
#include <string_view>

namespace trilobe {

// 128 bits (XXH3) of some bytes, as 32 hexadecimal digits.
std::string ContentHash(std::string_view bytes);

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_CONTENT_HASH_H_
