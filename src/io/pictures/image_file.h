#ifndef TRILOBE_IO_PICTURES_IMAGE_FILE_H_
#define TRILOBE_IO_PICTURES_IMAGE_FILE_H_

#include <string>
#include <string_view>

#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// A light probe in latitude and longitude, as a Radiance picture (.hdr): rows from the top down,
// twice as wide as high. Throws Error on anything else, and where no light is in it.
Environment ParseProbe(std::string_view bytes, const std::string& source);
Environment ReadProbe(const std::string& path);

// An 8-bit RGB picture as PNG, whole or not at all. [height * width * 3], row by row from the top.
void WritePng(const std::string& path, int width, int height, const std::string& pixels);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_IMAGE_FILE_H_
