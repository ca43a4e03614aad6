#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMN_LAYOUT_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMN_LAYOUT_H_

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/first_rows.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {

inline constexpr int kAngles = 4;

// Positions of the angles and values in a row.
struct ColumnLayout {
  std::vector<TableColumn> columns;
  std::array<std::optional<size_t>, kAngles> angles = {};  // theta_i, phi_i, theta_o, phi_o
  std::array<double, kAngles> units = {};                  // [rad] of the angles
  std::optional<size_t> phase = {};       // angle between the directions, in the place of phi_o
  bool from_mirror = false;               // theta_o is counted from there
  bool is_polarised = false;              // half the sum of the values counts
  std::vector<size_t> values = {};        // one for all channels; R, G, B; or a spectrum
  std::vector<double> wavelengths = {};   // [nm] of a spectrum, ascending
  std::optional<size_t> wavelength = {};  // column of the wavelength of a row
  std::vector<size_t> left_out = {};      // columns that are not read

  bool HasAllAngles() const {
    return std::ranges::all_of(angles, &std::optional<size_t>::has_value);
  }
  bool HasAnglesIn(double unit) const { return std::ranges::find(units, unit) != units.end(); }
};

// For a note: which columns have other names than usual, "'aoi' as theta_i", and which are left
// out, "'std', 'time'".
std::vector<std::string> RenamedColumns(const ColumnLayout& layout);
std::string LeftOutColumns(const ColumnLayout& layout);

// What needs no column: angles that have a value for all rows, and values where directions alone
// are asked for.
struct GivenAngles {
  bool theta_i = false, theta_o = false;
  bool values = false;
};

// Whether the names leave open if values are f, or pi f as most of what is called reflectance is:
// "R" alone, too, unless --columns calls it so.
bool MayBeFactor(const ColumnLayout& layout);

// The layout of columns that the line of `lines` names; columns of wavelengths before others of
// values if `prefers_bands`. Angles may be missing if they are given, phi_i if it is 0, and both
// azimuths in measurements in the plane of incidence. Throws Error, with the line, if the columns
// do not tell the angles or values, and names those of numbers that may hold them.
ColumnLayout LayoutOf(const TextLines& lines, const std::vector<TableColumn>& columns,
                      const GivenAngles& given, const FirstRows& rows, bool prefers_bands);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMN_LAYOUT_H_
