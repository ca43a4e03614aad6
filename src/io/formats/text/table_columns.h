#ifndef TRILOBE_IO_FORMATS_TEXT_TABLE_COLUMNS_H_
#define TRILOBE_IO_FORMATS_TEXT_TABLE_COLUMNS_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/text/column_role.h"

namespace trilobe {

// Scale of the numbers in a column of values: f itself, 10 lg f, lg f or ln f.
enum class ValueScale { kLinear, kDecibels, kLog10, kLn };

// A column by its name: "theta_i", "Theta_i [deg]", "incidence angle (rad)", "red", "550nm".
struct TableColumn {
  std::string name;  // as in the file
  ColumnRole role = ColumnRole::kOther;
  std::string unit = {};  // as the name says it, in lower case
  double wavelength = 0;  // [nm] of kBand
  ValueScale scale = ValueScale::kLinear;
  bool is_usual_name = false;   // "theta_i", "r", as the library writes it
  bool from_horizon = false;    // "sun elevation": 90 degrees minus theta
  bool is_difference = false;   // "relative azimuth": phi_o minus phi_i
  bool is_word = false;         // "detector": an angle, if no other column is that
  bool is_by_flag = false;      // --columns says what it holds, or leaves it out
  bool per_steradian = false;   // the name says so
  bool is_reflectance = false;  // "reflectance", "band_865": pi f, as most mean it, or f
};
TableColumn ColumnNamed(std::string_view name);

// Columns that stand beside one another, by which "i", "e" and "g" are known, and "f_s" and "f_p".
std::vector<TableColumn> ColumnsNamed(const std::vector<std::string>& names);

// Whether a name is this one but for case, punctuation and units of angles.
bool IsCalled(std::string_view name, std::string_view usual);

// Unit of an angle [rad]; degrees if it has none, nothing for other units.
std::optional<double> RadiansIn(std::string_view unit);

// "deg", "(rad)", "1/sr": a unit, without its brackets; none for other text.
std::optional<std::string> UnitIn(std::string_view cell);

inline constexpr const char* kUsualNames[] = {"theta_i", "phi_i", "theta_o", "phi_o",
                                              "r",       "g",     "b"};
inline constexpr const char* kUsualColumns = "theta_i,phi_i,theta_o,phi_o,r,g,b";

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TABLE_COLUMNS_H_
