#include "io/pictures/image_file.h"

#include <array>
#include <cmath>
#include <ostream>
#include <sstream>
#include <utility>
#include <vector>

#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/own_mark.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

// The part of the library that is used, compiled into this file alone. Its reader of Radiance
// pictures is not: where a picture is cut off, that of version 2.27 does not end, or shows what
// happens to be in memory.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace trilobe {
namespace {

constexpr int kMaxPixels = 1 << 25;

using Rgbe = std::array<unsigned char, 4>;  // mantissas, and the exponent that they share

Rgb ToRgb(const Rgbe& pixel) {
  if (pixel[3] == 0) return {};
  const double unit = std::ldexp(1.0, pixel[3] - (128 + 8));
  return {pixel[0] * unit, pixel[1] * unit, pixel[2] * unit};
}

// A Radiance picture (Ward 1991), from its first byte to its last.
class RadianceReader {
 public:
  RadianceReader(std::string_view bytes, const std::string& source)
      : bytes_(bytes), source_(source) {}

  // Reads up to the pixels. False if this is no such picture.
  bool ReadHeader(int* width, int* height) {
    if (!bytes_.starts_with("#?")) return false;
    bool has_format = false;
    std::string line;
    while (ReadLine(&line) && !line.empty()) {
      has_format = has_format || line == "FORMAT=32-bit_rle_rgbe";
    }
    if (!ReadLine(&line)) return false;
    std::istringstream resolution(line);
    std::string y, x;
    int rows = 0, columns = 0;
    resolution >> y >> rows >> x >> columns;
    *width = columns;
    *height = rows;
    return has_format && !resolution.fail() && y == "-Y" && x == "+X";
  }

  // Whether what follows can be this many rows, since nobody should be given gigabytes for a line.
  bool CanHold(int width, int height) const {
    constexpr int kLongestRun = 127;
    const size_t row = MayHaveRuns(width) ? 4 + 4 * 2 * ((width - 1) / kLongestRun + 1) : 4 * width;
    return bytes_.size() - at_ >= row * height;
  }

  // The next row. [width]
  void ReadRow(std::vector<Rgbe>* row) {
    // No colour begins with 2, 2.
    const bool runs = MayHaveRuns(static_cast<int>(row->size())) && at_ + 2 < bytes_.size() &&
                      bytes_[at_] == 2 && bytes_[at_ + 1] == 2 && (bytes_[at_ + 2] & 0x80) == 0;
    if (runs) {
      ReadRuns(row);
    } else {
      ReadColors(row);
    }
    ++row_;
  }

 private:
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind, std::string_view key) const {
    const std::string row = std::to_string(row_);
    throw ErrorIn(kind, source_, "row " + row + " of the Radiance picture " + problem)
        .About(key, row);
  }

  unsigned char Next() {
    if (at_ >= bytes_.size()) Fail("is cut off", ErrorKind::kFormat, "bytes");
    return static_cast<unsigned char>(bytes_[at_++]);
  }

  static bool MayHaveRuns(int width) { return width >= 8 && width < 1 << 15; }

  void ReadColors(std::vector<Rgbe>* row) {
    for (Rgbe& pixel : *row) {
      for (unsigned char& byte : pixel) byte = Next();
      if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
        Fail("is packed as it was before 1991; write it again by a newer program",
             ErrorKind::kUnsupported, "packing");
      }
    }
  }

  void ReadRuns(std::vector<Rgbe>* row) {
    const auto width = static_cast<int>(row->size());
    at_ += 2;
    const int high = Next();
    if (high * 256 + Next() != width) Fail("has another length", ErrorKind::kMismatch, "width");
    for (int k = 0; k < 4; ++k) {
      for (int x = 0; x < width;) {
        int count = Next();
        const bool run = count > 128;
        if (run) count -= 128;
        if (count == 0 || count > width - x) Fail("is broken", ErrorKind::kFormat, "runs");
        unsigned char byte = 0;
        for (int i = 0; i < count; ++i) {
          if (i == 0 || !run) byte = Next();
          (*row)[x++][k] = byte;
        }
      }
    }
  }

  bool ReadLine(std::string* line) {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) return false;
    *line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return true;
  }

  std::string_view bytes_;
  const std::string& source_;
  size_t at_ = 0;
  int row_ = 0;
};

}  // namespace

Environment ParseProbe(std::string_view bytes, const std::string& source) {
  RadianceReader reader(bytes, source);
  int width = 0, height = 0;
  if (!reader.ReadHeader(&width, &height)) {
    const Content content = RecogniseContent(bytes);
    const bool foreign = content.kind == Content::Kind::kForeign && !bytes.starts_with("#?");
    throw ErrorIn(ErrorKind::kFormat, source,
                  "not a Radiance picture" + (foreign ? " but " + content.name : "") +
                      "; give a light probe as a lat-long .hdr file")
        .About("content", content.name);
  }
  if (height < 2 || width / 2 != height || width % 2 != 0 || width > kMaxPixels / height) {
    throw ErrorIn(
        ErrorKind::kRange, source,
        "the picture is " + std::to_string(width) + " x " + std::to_string(height) +
            " pixels; a probe in latitude and longitude is twice as wide as high, and has at "
            "most 33 million pixels")
        .About("pixels", std::to_string(width) + " x " + std::to_string(height));
  }
  if (!reader.CanHold(width, height)) {
    throw ErrorIn(ErrorKind::kFormat, source,
                  "the Radiance picture is cut off; its " + std::to_string(width) + " x " +
                      std::to_string(height) + " pixels are not all there")
        .About("bytes");
  }
  Environment environment{source, width, height, {}};
  environment.radiance.reserve(static_cast<size_t>(width) * height);
  std::vector<Rgbe> row(width);
  for (int y = 0; y < height; ++y) {
    reader.ReadRow(&row);
    for (const Rgbe& pixel : row) environment.radiance.push_back(ToRgb(pixel));
  }
  DrawLights(environment, 1);  // for its error
  return environment;
}

Environment ReadProbe(const std::string& path) { return ParseProbe(ReadFile(path), path); }

std::string EncodePng(int width, int height, const std::string& pixels) {
  CheckNumber("the width of a picture", width, width >= 1, "1 or more");
  CheckNumber("the height of a picture", height, height >= 1, "1 or more");
  CheckSize("a picture", pixels.size(), static_cast<size_t>(width) * height * kChannels);
  std::string png;
  const auto append = [](void* written, void* data, int size) {
    static_cast<std::string*>(written)->append(static_cast<const char*>(data), size);
  };
  if (stbi_write_png_to_func(append, &png, width, height, kChannels, pixels.data(),
                             width * kChannels) == 0) {
    throw Error(ErrorKind::kFile, "cannot encode the picture").About("write");
  }
  return png;
}

void WritePng(const std::string& path, int width, int height, const std::string& pixels) {
  std::string png = EncodePng(width, height, pixels);
  WriteFile(path, [&](std::ostream& out) { out << MarkedPicture(std::move(png)); });
}

}  // namespace trilobe
