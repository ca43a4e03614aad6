#ifndef TRILOBE_IO_FORMATS_FOREIGN_FILE_H_
#define TRILOBE_IO_FORMATS_FOREIGN_FILE_H_

#include <string>
#include <string_view>

namespace trilobe {

// What a file is that people have in the place of a measurement and no reader takes, and what to
// do: "a workbook; save it as CSV, ...". By its bytes, and where these may be several things by the
// ending of its name. "" for others.
std::string ForeignFile(std::string_view bytes, const std::string& name);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_FOREIGN_FILE_H_
