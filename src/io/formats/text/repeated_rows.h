#ifndef TRILOBE_IO_FORMATS_TEXT_REPEATED_ROWS_H_
#define TRILOBE_IO_FORMATS_TEXT_REPEATED_ROWS_H_

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// Rows of a table that has a column whose cells are the kinds of rows, "s" and "p".
class RepeatedRows {
 public:
  struct Row {
    SphericalAngles at;
    double wavelength = 0;  // [nm], or 0
    std::vector<double> values;
  };
  void Add(std::string_view kind, Row row);

  // Whether no kind is there twice for the same directions, and half of these or more have all.
  bool IsRepeated() const;
  // Whether they are the polarisations of light and detector, all four: f is half their sum.
  bool IsCrossed() const;
  // Where it is so, the means, or half the sums, at directions that have all kinds, in the order of
  // their first rows; else the rows as they are.
  std::vector<Row> Means() const;
  int incomplete() const;     // the number of directions that lack a kind
  std::string Kinds() const;  // "s, p"

 private:
  static constexpr size_t kMostKinds = 64;

  std::vector<std::string> kinds_;  // up to one more than those
  std::vector<Row> rows_;
  // The numbers of the rows at each pair of directions and wavelength, and where these stand.
  std::vector<std::vector<size_t>> alike_;
  std::map<std::array<double, 5>, size_t> places_;
  std::vector<size_t> kind_of_rows_;
  bool is_twice_ = false;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_REPEATED_ROWS_H_
