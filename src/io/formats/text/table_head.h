#ifndef TRILOBE_IO_FORMATS_TEXT_TABLE_HEAD_H_
#define TRILOBE_IO_FORMATS_TEXT_TABLE_HEAD_H_

#include <string>
#include <string_view>
#include <vector>

#include "io/formats/text/text_table.h"

namespace trilobe {

// The head of a text table, by `columns` of SourceOptions or, without, by its header: `columns`
// names all columns in their order, "theta_i,-,f", or some of the header, "theta_i=Angle,f=Value".
// "theta" alone is an angle if `theta_is_given`. Throws Error where none is found.
TableHead HeadOf(std::string_view text, const std::string& source, const std::string& columns,
                 bool theta_is_given);

// Its columns, whose line is that of `header`. Throws Error, with the line, if `columns` names what
// the header has not or has twice.
std::vector<TableColumn> ColumnsOf(const TableHead& head, const TextLines& header,
                                   const std::string& columns);

// Throws Error if `columns` calls a column what means nothing.
void CheckNames(const std::string& columns);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_TABLE_HEAD_H_
