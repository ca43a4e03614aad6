#include "io/formats/table_head.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/files/text_lines.h"
#include "io/formats/table_columns.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

TableHead HeadOf(std::string_view text, const std::string& source, const std::string& columns,
                 bool theta_is_given) {
  TableHead head{.lines = TextLines(text, source)};
  if (!columns.empty()) {
    std::vector<std::string> names;
    for (const std::string_view name : SplitCells(columns)) names.emplace_back(name);
    head = TableHeadBy(names, text, source);
  } else if (auto found = FindTableHead(text, source, theta_is_given)) {
    head = *std::move(found);
  } else if (auto other = FindTableHead(text, source, /*theta_is_given=*/true)) {
    head = *std::move(other);  // the layout says what is missing
  } else {
    if (!head.lines.Next()) {
      throw Error(source + ": the file is empty; a table begins with a header row, as " +
                  kUsualColumns);
    }
    while (head.lines.line().starts_with('%') && head.lines.Next()) {
    }
    if (LooksLikeRow(head.lines.line(), 2)) {
      head.lines.Fail(std::string("no header row names the columns; --columns=") + kUsualColumns +
                      " names them, - those to leave out, and --columns=theta_o/phi_o the rows and "
                      "columns of a matrix");
    }
    head.names = NamesOfFirstLine(head.lines.line());
  }
  return head;
}

}  // namespace trilobe
