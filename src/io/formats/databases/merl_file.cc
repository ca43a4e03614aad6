#include "io/formats/databases/merl_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/little_endian.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {
namespace {

using Dimensions = std::array<int32_t, 3>;  // theta_h, theta_d, phi_d
constexpr size_t kHeaderSize = sizeof(Dimensions);

Dimensions DimensionsOf(const MerlGrid& grid) { return {grid.theta_h, grid.theta_d, grid.phi_d}; }

size_t PlaneSize(const MerlGrid& grid) { return sizeof(double) * grid.size(); }

std::string ToString(const Dimensions& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

// A header as a machine of the other byte order writes it.
std::string BigEndian(const Dimensions& dimensions) {
  std::string bytes;
  for (const int32_t n : dimensions) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift);
  }
  return bytes;
}

// What makes a file none of MERL's.
struct MerlDefect {
  std::string key, value, problem;
};

// Why `bytes` is no MERL file, or nothing if it is one.
std::optional<MerlDefect> DefectOf(std::string_view bytes, const MerlGrid& grid) {
  const size_t file_size = kHeaderSize + kChannels * PlaneSize(grid);
  const std::string size = std::to_string(bytes.size()) + " bytes";
  const std::string expected = "a MERL file has " + std::to_string(file_size) + " bytes";
  const std::string length = std::to_string(bytes.size());
  if (bytes.empty()) return MerlDefect{"bytes", length, "the file is empty; " + expected};
  if (const Content content = RecogniseContent(bytes); content.kind != Content::Kind::kUnknown) {
    return MerlDefect{"content", content.name, "this is " + content.name + "; " + expected};
  }
  if (bytes.size() < kHeaderSize) {
    return MerlDefect{"bytes", length, "truncated: " + size + "; " + expected};
  }
  Dimensions n;
  std::memcpy(n.data(), bytes.data(), kHeaderSize);
  if (bytes.starts_with(BigEndian(DimensionsOf(grid)))) {
    return MerlDefect{"numbers", "big-endian",
                      "its numbers are big-endian; a MERL file has little-endian ones: swap the "
                      "bytes of its three int32 and of all float64 after them"};
  }
  if (n != DimensionsOf(grid)) {
    return MerlDefect{"bins", ToString(n),
                      "the header says " + ToString(n) + " bins in a file of " + size +
                          "; a MERL file has " + ToString(DimensionsOf(grid)) + " bins"};
  }
  if (bytes.size() == kHeaderSize + kChannels * PlaneSize(grid) / 2) {
    return MerlDefect{
        "numbers", "float32",
        "its values are float32; a MERL file has float64: write them so, " + expected};
  }
  if (bytes.size() < file_size) {
    return MerlDefect{"bytes", length,
                      "truncated: " + size + "; " + expected + "; get it once more"};
  }
  if (bytes.size() > file_size) {
    return MerlDefect{
        "bytes", length,
        std::to_string(bytes.size() - file_size) + " bytes too many: " + size + "; " + expected};
  }
  return std::nullopt;
}

}  // namespace

BrdfTable ParseMerl(std::string_view bytes, const std::string& source, const MerlGrid& grid) {
  CheckGrid(grid);
  if (const std::optional<MerlDefect> defect = DefectOf(bytes, grid)) {
    throw ErrorIn(ErrorKind::kFormat, source, defect->problem).About(defect->key, defect->value);
  }
  BrdfTable table{source, grid, {}};
  const char* data = bytes.data() + kHeaderSize;
  for (std::vector<double>& plane : table.stored) {
    plane.resize(grid.size());
    std::memcpy(plane.data(), data, PlaneSize(grid));
    data += PlaneSize(grid);
  }
  return table;
}

BrdfTable ReadMerl(const std::string& path) { return ParseMerl(ReadFile(path), path); }

void WriteMerl(const BrdfTable& table, const std::string& path,
               const BeforeRenaming& before_renaming) {
  CheckTable(table);
  const Dimensions dimensions = DimensionsOf({});
  if (DimensionsOf(table.grid) != dimensions) {
    throw Error(ErrorKind::kMismatch, "cannot write '" + path + "': a MERL file has " +
                                          ToString(dimensions) + " bins, this table has " +
                                          ToString(DimensionsOf(table.grid)))
        .At(path)
        .About("bins", ToString(DimensionsOf(table.grid)));
  }
  WriteFile(
      path,
      [&](std::ostream& out) {
        std::array<char, kHeaderSize> header{};
        std::memcpy(header.data(), dimensions.data(), kHeaderSize);
        out.write(header.data(), kHeaderSize);
        for (std::vector<double> plane : table.stored) {
          for (int bin = 0; bin < table.grid.size(); ++bin) {
            if (ReasonOf(table, bin) != Unmeasured::kNo) plane[bin] = -1;
          }
          out.write(reinterpret_cast<const char*>(plane.data()),
                    static_cast<std::streamsize>(PlaneSize(table.grid)));
        }
      },
      before_renaming);
}

namespace {

bool LooksLikeMerl(std::string_view bytes) {
  const Dimensions usual = DimensionsOf({});
  return bytes.size() >= kHeaderSize && std::memcmp(bytes.data(), usual.data(), kHeaderSize) == 0;
}

}  // namespace

MeasurementFormat MerlFormat() {
  return {.name = "merl",
          .description = "a MERL .binary file",
          .ending = ".binary",
          .is_text = false,
          .recognise = LooksLikeMerl,
          .read =
              [](std::string_view bytes, const std::string& source, const SourceOptions&) {
                return Measurement{.source = source,
                                   .kind = "MERL measurement",
                                   .table = ParseMerl(bytes, source)};
              },
          .written_as = "MERL layout",
          .write =
              [](const Measurement& measurement, const std::string& path, int,
                 const BeforeRenaming& before_renaming) {
                const BrdfTable& table = TableOf(measurement);
                WriteMerl(table, path, before_renaming);
                return ValidText(CountBins(table), "bins");
              }};
}

}  // namespace trilobe
