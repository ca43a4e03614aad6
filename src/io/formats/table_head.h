#ifndef TRILOBE_IO_FORMATS_TABLE_HEAD_H_
#define TRILOBE_IO_FORMATS_TABLE_HEAD_H_

#include <string>
#include <string_view>

#include "io/formats/text_table.h"

namespace trilobe {

// The head of a text table, by `columns` of SourceOptions or, without, by its header. "theta" alone
// is an angle if `theta_is_given`. Throws Error where none is found.
TableHead HeadOf(std::string_view text, const std::string& source, const std::string& columns,
                 bool theta_is_given);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TABLE_HEAD_H_
