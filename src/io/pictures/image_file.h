#ifndef TRILOBE_IO_PICTURES_IMAGE_FILE_H_
#define TRILOBE_IO_PICTURES_IMAGE_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// A latitude-longitude light probe from a Radiance picture (.hdr): rows from top to bottom, twice
// as wide as high. Throws Error for anything else and for a probe without light.
Environment ParseProbe(std::string_view bytes, const std::string& source);
Environment ReadProbe(const std::string& path);

// An 8-bit RGB picture as the bytes of a PNG file. pixels: [height * width * 3], rows from the top.
std::string EncodePng(int width, int height, const std::string& pixels);

// Atomically writes one.
void WritePng(const std::string& path, int width, int height, const std::string& pixels);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_IMAGE_FILE_H_
