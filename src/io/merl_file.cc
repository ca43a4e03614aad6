#include "trilobe/io/merl_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "trilobe/base/error.h"
#include "trilobe/io/content.h"
#include "trilobe/io/file.h"
#include "trilobe/io/little_endian.h"

namespace trilobe {
namespace {

using Dimensions = std::array<int32_t, 3>;  // theta_h, theta_d, phi_d
constexpr MerlGrid kGrid{};
constexpr Dimensions kDimensions = {kGrid.theta_h, kGrid.theta_d, kGrid.phi_d};
constexpr size_t kHeaderSize = sizeof(Dimensions);
constexpr size_t kPlaneSize = sizeof(double) * kDimensions[0] * kDimensions[1] * kDimensions[2];
constexpr size_t kFileSize = kHeaderSize + kChannels * kPlaneSize;

std::string ToString(const Dimensions& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

// Why `bytes` is no MERL file, or nothing if it is one.
std::string Defect(std::string_view bytes) {
  const std::string size = std::to_string(bytes.size()) + " bytes";
  const std::string expected = "a MERL file has " + std::to_string(kFileSize) + " bytes";
  if (bytes.empty()) return "the file is empty; " + expected;
  if (const Content content = RecogniseContent(bytes);
      content.kind != Content::Kind::kUnknown && content.kind != Content::Kind::kMerl) {
    return "this is " + content.name +
           "; a measurement is a MERL .binary file, an RGL *_rgb.bsdf file, or synth:NAME";
  }
  if (bytes.size() < kHeaderSize) return "truncated: " + size + "; " + expected;
  Dimensions n;
  std::memcpy(n.data(), bytes.data(), kHeaderSize);
  if (n != kDimensions) {
    return "the header says " + ToString(n) + " bins in a file of " + size + "; a MERL file has " +
           ToString(kDimensions) + " bins";
  }
  if (bytes.size() < kFileSize) {
    return "truncated: " + size + "; " + expected + "; get it once more";
  }
  if (bytes.size() > kFileSize) {
    return std::to_string(bytes.size() - kFileSize) + " bytes too many: " + size + "; " + expected;
  }
  return "";
}

}  // namespace

BrdfTable ParseMerl(std::string_view bytes, const std::string& source) {
  if (const std::string defect = Defect(bytes); !defect.empty()) {
    throw Error(source + ": " + defect);
  }
  BrdfTable table{source, kGrid, {}};
  const char* data = bytes.data() + kHeaderSize;
  for (std::vector<double>& plane : table.stored) {
    plane.resize(kGrid.size());
    std::memcpy(plane.data(), data, kPlaneSize);
    data += kPlaneSize;
  }
  return table;
}

BrdfTable ReadMerl(const std::string& path) { return ParseMerl(ReadFile(path), path); }

void WriteMerl(const BrdfTable& table, const std::string& path) {
  if (table.grid != kGrid) {
    const Dimensions n = {table.grid.theta_h, table.grid.theta_d, table.grid.phi_d};
    throw Error("cannot write '" + path + "': a MERL file has " + ToString(kDimensions) +
                " bins, this table has " + ToString(n));
  }
  WriteFile(path, [&](std::ostream& out) {
    std::array<char, kHeaderSize> header{};
    std::memcpy(header.data(), kDimensions.data(), kHeaderSize);
    out.write(header.data(), kHeaderSize);
    for (std::vector<double> plane : table.stored) {
      for (int bin = 0; bin < kGrid.size(); ++bin) {
        if (ReasonOf(table, bin) != Unmeasured::kNo) plane[bin] = -1;
      }
      out.write(reinterpret_cast<const char*>(plane.data()), kPlaneSize);
    }
  });
}

}  // namespace trilobe
