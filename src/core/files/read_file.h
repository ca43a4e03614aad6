#ifndef TRILOBE_CORE_FILES_READ_FILE_H_
#define TRILOBE_CORE_FILES_READ_FILE_H_

#include <string>

namespace trilobe {

// The bytes of a file. Throws Error: missing, a directory, unreadable, changed while read.
std::string ReadFile(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_READ_FILE_H_
