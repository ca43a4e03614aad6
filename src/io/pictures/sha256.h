#ifndef TRILOBE_IO_PICTURES_SHA256_H_
#define TRILOBE_IO_PICTURES_SHA256_H_

#include <string>
#include <string_view>

namespace trilobe {

// The 32 bytes of SHA-256 (FIPS 180-4), by which a page's Content-Security-Policy names the scripts
// and styles that may run in it.
std::string Sha256(std::string_view bytes);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_SHA256_H_
