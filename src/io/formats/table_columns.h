#ifndef TRILOBE_IO_FORMATS_TABLE_COLUMNS_H_
#define TRILOBE_IO_FORMATS_TABLE_COLUMNS_H_

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/text_lines.h"

namespace trilobe {

// Meaning of a column of a text table. The angles come first, as in ColumnLayout::angles.
enum class ColumnRole {
  kThetaI,
  kPhiI,
  kThetaO,
  kPhiO,
  kRed,
  kGreen,
  kBlue,
  kValue,       // for all channels
  kBand,        // the value at a wavelength
  kWavelength,  // of the row
  kTheta,       // of a direction that the name does not say
  kFromMirror,  // theta_o - theta_i in the plane of incidence, > 0 away from the normal
  kPhi,
  kOther
};

// Scale of the numbers in a column of values: f itself, 10 lg f, lg f or ln f.
enum class ValueScale { kLinear, kDecibels, kLog10, kLn };

// A column by its name: "theta_i", "Theta_i [deg]", "incidence angle (rad)", "red", "550nm".
struct TableColumn {
  std::string name;  // as in the file
  ColumnRole role = ColumnRole::kOther;
  std::string unit = {};  // as the name says it, in lower case
  double wavelength = 0;  // [nm] of kBand
  ValueScale scale = ValueScale::kLinear;
  bool is_usual_name = false;  // "theta_i", "r", as the library writes it
};
TableColumn ColumnNamed(std::string_view name);

// Unit of an angle [rad]; degrees if it has none, nothing for other units.
std::optional<double> RadiansIn(std::string_view unit);

// "deg", "(rad)", "1/sr": a unit, without its brackets; none for other text.
std::optional<std::string> UnitIn(std::string_view cell);

inline constexpr const char* kUsualColumns = "theta_i,phi_i,theta_o,phi_o,r,g,b";
inline constexpr int kAngles = 4;

// Positions of the angles and values in a row.
struct ColumnLayout {
  std::vector<TableColumn> columns;
  std::array<std::optional<size_t>, kAngles> angles = {};  // theta_i, phi_i, theta_o, phi_o
  std::array<double, kAngles> units = {};                  // [rad] of the angles
  bool from_mirror = false;                                // theta_o is counted from there
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
// out,
// "'std', 'time'".
std::vector<std::string> RenamedColumns(const ColumnLayout& layout);
std::string LeftOutColumns(const ColumnLayout& layout);

// Which angles have a value for all rows, and need no column.
struct GivenAngles {
  bool theta_i = false, theta_o = false;
};

// The layout of columns that the line of `lines` names; columns of wavelengths before others of
// values if `prefers_bands`. Angles may be missing if they are given, phi_i if it is 0, and both
// azimuths in measurements in the plane of incidence. Throws Error, with the line, if the columns
// do not tell the angles or values.
ColumnLayout LayoutOf(const TextLines& lines, const std::vector<TableColumn>& columns,
                      const GivenAngles& given, bool prefers_bands = false);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TABLE_COLUMNS_H_
