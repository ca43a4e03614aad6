#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/files/little_endian.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

constexpr std::string_view kMagic = "NVIDIA ARC MBSDF V1\n";
constexpr std::string_view kData = "MBSDF_DATA=\n";  // of files before there was transmission
constexpr std::string_view kReflection = "MBSDF_DATA_REFLECTION=\n";
constexpr std::string_view kTransmission = "MBSDF_DATA_TRANSMISSION=\n";

struct Grid {
  uint32_t channels, theta, phi;
  size_t cells() const { return size_t{theta} * theta * phi; }
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& source) : rest_(bytes), source_(source) {}

  // After the magic come lines of metadata, then the data.
  void FindReflection() {
    if (!rest_.starts_with(kMagic)) {
      Fail("this does not begin as an MBSDF file does", ErrorKind::kFormat, "content");
    }
    do {
      const size_t end = rest_.find('\n');
      if (end == std::string_view::npos) {
        Fail("it ends before its data", ErrorKind::kMissing, "data");
      }
      rest_.remove_prefix(end + 1);
      if (rest_.starts_with(kTransmission)) {
        Fail("it has transmission only, and no reflection", ErrorKind::kUnsupported, "data");
      }
    } while (!rest_.starts_with(kData) && !rest_.starts_with(kReflection));
    rest_.remove_prefix(rest_.find('\n') + 1);
  }

  Grid TakeGrid() {
    const uint32_t type = TakeUint32(), theta = TakeUint32(), phi = TakeUint32();
    if (type > 1) {
      Fail("type " + std::to_string(type) + " of data; it must be 0 (one value) or 1 (RGB)",
           ErrorKind::kUnknown, "type", std::to_string(type));
    }
    constexpr uint32_t kMost = 1 << 14;
    if (theta == 0 || phi == 0 || theta > kMost || phi > kMost) {
      Fail("a grid of " + std::to_string(theta) + " x " + std::to_string(theta) + " x " +
               std::to_string(phi) + "; each must be from 1 to " + std::to_string(kMost),
           ErrorKind::kRange, "grid");
    }
    return {type == 0 ? 1U : 3U, theta, phi};
  }

  std::string_view TakeValues(const Grid& grid) {
    const size_t size = grid.cells() * grid.channels * sizeof(float);
    if (rest_.size() < size) {
      Fail("truncated: " + std::to_string(rest_.size()) + " bytes of reflection data, and its " +
               "header announces " + std::to_string(size) + "; get it once more",
           ErrorKind::kFormat, "bytes", std::to_string(rest_.size()));
    }
    if (grid.cells() > static_cast<size_t>(std::numeric_limits<int>::max())) {
      Fail("it has more samples than any measurement", ErrorKind::kLimit, "grid");
    }
    const std::string_view values = rest_.substr(0, size);
    rest_.remove_prefix(size);
    if (!rest_.empty() && !rest_.starts_with(kTransmission)) {
      Fail(std::to_string(rest_.size()) + " bytes too many after the reflection data",
           ErrorKind::kFormat, "bytes", std::to_string(rest_.size()));
    }
    return values;
  }

 private:
  uint32_t TakeUint32() {
    if (rest_.size() < sizeof(uint32_t)) {
      Fail("it ends within the header of its data", ErrorKind::kFormat, "header");
    }
    const auto value = LoadLittleEndian<uint32_t>(rest_.data());
    rest_.remove_prefix(sizeof(uint32_t));
    return value;
  }

  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind, std::string_view key,
                         std::string_view value = "") const {
    throw ErrorIn(kind, source_, problem).About(key, value);
  }

  std::string_view rest_;
  const std::string& source_;
};

// A measured BSDF of NVIDIA's Material Definition Language (`.mbsdf`, MDL specification, appendix
// E; docs/file-formats.md), its part for reflection: float32 BRDF values [1/sr], RGB or one for all
// channels, on a grid of theta_in, theta_out and the angle between the azimuths, 0 to 180 degrees.
// Samples stand at the centres of the cells. Throws Error on anything else.
Measurement ParseMbsdf(std::string_view bytes, const std::string& source) {
  Reader reader(bytes, source);
  reader.FindReflection();
  const Grid grid = reader.TakeGrid();
  const std::string_view values = reader.TakeValues(grid);
  SampleCollector collector(source, "MBSDF file of scattered samples");
  const char* at = values.data();
  for (uint32_t i = 0; i < grid.theta; ++i) {
    for (uint32_t o = 0; o < grid.theta; ++o) {
      for (uint32_t p = 0; p < grid.phi; ++p) {
        Rgb rho{};
        for (int c = 0; c < kChannels; ++c) {
          rho[c] = LoadLittleEndian<float>(at + (grid.channels == 1 ? 0 : c) * sizeof(float));
        }
        at += grid.channels * sizeof(float);
        collector.Add({(i + 0.5) / grid.theta * (kPi / 2), 0, (o + 0.5) / grid.theta * (kPi / 2),
                       (p + 0.5) / grid.phi * kPi},
                      rho);
      }
    }
  }
  return collector.Take();
}

bool LooksLikeMbsdf(std::string_view bytes) { return bytes.starts_with(kMagic); }

}  // namespace

MeasurementFormat MbsdfFormat() {
  return {.name = "mbsdf",
          .description = "an MDL .mbsdf file",
          .ending = ".mbsdf",
          .is_text = false,
          .recognise = LooksLikeMbsdf,
          .read = ReadBy<ParseMbsdf>};
}

}  // namespace trilobe
