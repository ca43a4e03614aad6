#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMNS_FLAG_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMNS_FLAG_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/text/table_columns.h"

namespace trilobe {

// "--columns=theta_i,-,theta_o,f": the columns by their usual names, and one of them as `value`.
std::string ColumnsFlag(const std::vector<TableColumn>& columns, size_t as_f,
                        std::string_view value = "f");

// The same with a word for each column, "" for that of its angle.
std::string ColumnsFlagWith(const std::vector<TableColumn>& columns,
                            const std::vector<std::string>& words);

// Names for so many columns, as an example: "theta_i,theta_o,f" of three.
std::string ExampleColumns(size_t count);

// A flag as a shell takes it, in quotes if it holds what a shell would change.
std::string Quotable(const std::string& flag);

// Letters and digits of the plain name before its last brackets, by which known names are found.
std::string KeyOf(const TableColumn& column);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMNS_FLAG_H_
