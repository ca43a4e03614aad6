#include "io/formats/databases/merl_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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
constexpr Dimensions kUsualDimensions = {90, 90, 180};

Dimensions DimensionsOf(const MerlGrid& grid) { return {grid.theta_h, grid.theta_d, grid.phi_d}; }

size_t PlaneSize(const MerlGrid& grid) { return sizeof(double) * grid.size(); }

std::string ToString(const Dimensions& n) {
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

// The number at `bytes`, of either order of bytes.
template <typename T>
T LoadNumber(const char* bytes, bool big_endian) {
  std::array<char, sizeof(T)> in_order;
  std::memcpy(in_order.data(), bytes, sizeof(T));
  if (big_endian) std::ranges::reverse(in_order);
  return LoadLittleEndian<T>(in_order.data());
}

// How the numbers of a file are written. Whoever keeps tables in this format may have other numbers
// of bins, float32, or the bytes of another machine.
struct MerlLayout {
  MerlGrid grid;
  bool is_float = false, big_endian = false;

  size_t NumberSize() const { return is_float ? sizeof(float) : sizeof(double); }
  size_t FileSize() const { return kHeaderSize + kChannels * NumberSize() * grid.size(); }
  double Number(const char* bytes, int k) const {
    const char* const at = bytes + NumberSize() * static_cast<size_t>(k);
    return is_float ? LoadNumber<float>(at, big_endian) : LoadNumber<double>(at, big_endian);
  }
};

// MERL's numbers in another order are refused: nobody knows which one of them is phi_d.
bool IsPlausible(const Dimensions& n) {
  constexpr int kFewest = 4, kMost = 720;
  constexpr double kMostBins = 2e7;
  const auto [fewest, most] = std::minmax({n[0], n[1], n[2]});
  if (n != kUsualDimensions && std::ranges::is_permutation(n, kUsualDimensions)) return false;
  return fewest >= kFewest && most <= kMost && 1.0 * n[0] * n[1] * n[2] <= kMostBins;
}

// The layout that the header says, if there is one whose size the file has.
std::optional<MerlLayout> LayoutOf(std::string_view bytes) {
  if (bytes.size() < kHeaderSize) return std::nullopt;
  for (const bool big_endian : {false, true}) {
    Dimensions n;
    for (size_t k = 0; k < n.size(); ++k) {
      n[k] = LoadNumber<int32_t>(bytes.data() + k * sizeof(int32_t), big_endian);
    }
    if (!IsPlausible(n)) continue;
    for (const bool is_float : {false, true}) {
      const MerlLayout layout = {{n[0], n[1], n[2]}, is_float, big_endian};
      if (bytes.size() == layout.FileSize()) return layout;
    }
  }
  return std::nullopt;
}

// What makes a file none of MERL's.
struct MerlDefect {
  std::string key, value, problem;
};

// Why `bytes`, without a layout, is no MERL file.
MerlDefect DefectOf(std::string_view bytes) {
  const size_t file_size = MerlLayout().FileSize();
  const std::string size = std::to_string(bytes.size()) + " bytes";
  const std::string expected = "a MERL file has " + std::to_string(file_size) + " bytes";
  const std::string length = std::to_string(bytes.size());
  if (bytes.empty()) return {"bytes", length, "the file is empty; " + expected};
  if (const Content content = RecogniseContent(bytes); content.kind != Content::Kind::kUnknown) {
    return {"content", content.name, "this is " + content.name + "; " + expected};
  }
  if (bytes.size() < kHeaderSize) {
    return {"bytes", length, "truncated: " + size + "; " + expected};
  }
  Dimensions n;
  std::memcpy(n.data(), bytes.data(), kHeaderSize);
  if (n != kUsualDimensions) {
    return {"bins", ToString(n),
            "the header says " + ToString(n) + " bins in a file of " + size + "; a MERL file has " +
                ToString(kUsualDimensions) +
                " bins, or others with 8 or 4 "
                "bytes for each and channel"};
  }
  if (bytes.size() < file_size) {
    return {"bytes", length, "truncated: " + size + "; " + expected + "; get it once more"};
  }
  return {"bytes", length,
          std::to_string(bytes.size() - file_size) + " bytes too many: " + size + "; " + expected};
}

// --- phi_d over a full circle ---

// The mean of |a - b| / (a + b) over values of a plane that stand `apart` bins of phi_d from each
// other.
double DifferenceAt(const std::vector<double>& plane, int phis, int apart) {
  double sum = 0;
  int count = 0;
  for (size_t row = 0; row < plane.size(); row += phis) {
    for (int p = 0; p + apart < phis; ++p) {
      const double a = plane[row + p], b = plane[row + p + apart];
      if (!(a >= 0 && b >= 0 && a + b > 0)) continue;
      sum += std::abs(a - b) / (a + b);
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

// Whether phi_d goes round once, and not only from 0 to 180 degrees, as reciprocity allows: values
// half a circle apart are those of exchanged directions, and are more alike than those of a
// quarter.
bool IsFullCircle(const BrdfTable& table) {
  const int phis = table.grid.phi_d;
  if (DimensionsOf(table.grid) == kUsualDimensions || phis % 4 != 0) return false;
  const double half = DifferenceAt(table.stored[1], phis, phis / 2);
  return 2 * half < DifferenceAt(table.stored[1], phis, phis / 4);
}

// Takes the means of exchanged directions, or the one that was measured.
void FoldFullCircle(BrdfTable* table) {
  const int phis = table->grid.phi_d, folded_phis = phis / 2;
  for (std::vector<double>& plane : table->stored) {
    std::vector<double> folded;
    folded.reserve(plane.size() / 2);
    for (size_t row = 0; row < plane.size(); row += phis) {
      for (int p = 0; p < folded_phis; ++p) {
        const double a = plane[row + p], b = plane[row + p + folded_phis];
        folded.push_back(a >= 0 && b >= 0 ? (a + b) / 2 : std::max(a, b));
      }
    }
    plane = std::move(folded);
  }
  table->grid.phi_d = folded_phis;
}

// The table, and a note on how it is written if that is not as MERL's are.
struct ReadTable {
  BrdfTable table;
  std::string note = {};
};

ReadTable ReadLayout(std::string_view bytes, const std::string& source) {
  const std::optional<MerlLayout> layout = LayoutOf(bytes);
  if (!layout) {
    const MerlDefect defect = DefectOf(bytes);
    throw ErrorIn(ErrorKind::kFormat, source, defect.problem).About(defect.key, defect.value);
  }
  ReadTable read = {.table = {source, layout->grid, {}}};
  const char* data = bytes.data() + kHeaderSize;
  for (std::vector<double>& plane : read.table.stored) {
    plane.resize(layout->grid.size());
    if (layout->is_float || layout->big_endian) {
      for (int k = 0; k < layout->grid.size(); ++k) plane[k] = layout->Number(data, k);
    } else {
      std::memcpy(plane.data(), data, PlaneSize(layout->grid));
    }
    data += layout->NumberSize() * plane.size();
  }
  const auto say = [&](bool is_so, const std::string& what) {
    if (is_so) read.note += (read.note.empty() ? "read as: " : ", ") + what;
  };
  const Dimensions dimensions = DimensionsOf(layout->grid);
  say(dimensions != kUsualDimensions, ToString(dimensions) + " bins");
  say(layout->is_float, "float32");
  say(layout->big_endian, "big-endian numbers");
  if (IsFullCircle(read.table)) {
    FoldFullCircle(&read.table);
    say(true, "phi_d over 360 degrees, means of exchanged directions");
  }
  return read;
}

}  // namespace

BrdfTable ParseMerl(std::string_view bytes, const std::string& source) {
  return ReadLayout(bytes, source).table;
}

BrdfTable ReadMerl(const std::string& path) { return ParseMerl(ReadFile(path), path); }

void WriteMerl(const BrdfTable& table, const std::string& path,
               const BeforeRenaming& before_renaming) {
  CheckTable(table);
  if (DimensionsOf(table.grid) != kUsualDimensions) {
    throw Error(ErrorKind::kMismatch, "cannot write '" + path + "': a MERL file has " +
                                          ToString(kUsualDimensions) + " bins, this table has " +
                                          ToString(DimensionsOf(table.grid)))
        .At(path)
        .About("bins", ToString(DimensionsOf(table.grid)));
  }
  WriteFile(
      path,
      [&](std::ostream& out) {
        std::array<char, kHeaderSize> header{};
        std::memcpy(header.data(), kUsualDimensions.data(), kHeaderSize);
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
  if (bytes.size() < kHeaderSize) return false;
  return std::memcmp(bytes.data(), kUsualDimensions.data(), kHeaderSize) == 0 || LayoutOf(bytes);
}

Measurement ReadMerlMeasurement(std::string_view bytes, const std::string& source,
                                const SourceOptions& /*options*/) {
  ReadTable read = ReadLayout(bytes, source);
  Measurement measurement{
      .source = source, .kind = "MERL measurement", .table = std::move(read.table)};
  if (!read.note.empty()) measurement.notes.push_back(std::move(read.note));
  return measurement;
}

}  // namespace

MeasurementFormat MerlFormat() {
  return {.name = "merl",
          .description = "a MERL .binary file",
          .ending = ".binary",
          .is_text = false,
          .recognise = LooksLikeMerl,
          .read = ReadMerlMeasurement,
          .written_as = "MERL layout",
          .write = [](const Measurement& measurement, const std::string& path, int,
                      const BeforeRenaming& before_renaming) {
            const BrdfTable& table = TableOf(measurement);
            WriteMerl(table, path, before_renaming);
            return ValidText(CountBins(table), "bins");
          }};
}

}  // namespace trilobe
