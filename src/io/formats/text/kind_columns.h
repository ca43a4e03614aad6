#ifndef TRILOBE_IO_FORMATS_TEXT_KIND_COLUMNS_H_
#define TRILOBE_IO_FORMATS_TEXT_KIND_COLUMNS_H_

#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/text/column_layout.h"
#include "io/formats/text/table_row.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// Which columns that are not read tell rows of the same directions apart: their cells always differ
// between such rows, and are of few kinds, "A" and "B".
class KindColumns {
 public:
  // Looks at the columns of `layout` that are not read, but for those that rows are chosen by and
  // those that a flag leaves out.
  KindColumns(const ColumnLayout& layout, const std::vector<size_t>& chosen);

  // Whether a further row could tell more.
  bool MayTell() const;
  void Add(const TextLines& lines, const SphericalAngles& at, double wavelength, TableRow* row);

  // The column, or the two of the polarisations of light and detector; empty if none tells. Throws
  // Error, with the line of `header`, if one does whose numbers may be an angle or a wavelength.
  std::vector<size_t> Found(const TextLines& header) const;
  // Notes on columns of samples or polarisations that tell no rows apart, as others may do.
  std::vector<std::string> Notes() const;

  // The kind of a row by such columns.
  static std::string KindOf(const TextLines& lines, const std::vector<size_t>& columns,
                            TableRow* row);

 private:
  struct Candidate {
    std::vector<size_t> columns;
    std::vector<std::string> kinds = {};
    std::set<std::pair<size_t, size_t>> seen = {};  // places and kinds
    bool is_twice = false, has_many = false;
  };
  bool Tells(const Candidate& candidate) const;
  std::string Names(const Candidate& candidate) const;

  const ColumnLayout& layout_;
  std::vector<Candidate> candidates_;  // those of known names first
  std::map<std::array<double, 5>, size_t> places_;
  size_t num_rows_ = 0;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_KIND_COLUMNS_H_
