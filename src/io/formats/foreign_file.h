#ifndef TRILOBE_IO_FORMATS_FOREIGN_FILE_H_
#define TRILOBE_IO_FORMATS_FOREIGN_FILE_H_

#include <string>
#include <string_view>

namespace trilobe {

// Name of a kind of file that no reader takes, though people have it in the place of a measurement,
// with advice: "a workbook; save it as CSV, ...". Known by its bytes and, if these fit several
// kinds, by the ending of its name. "" for others.
std::string ForeignFile(std::string_view bytes, const std::string& name);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_FOREIGN_FILE_H_
