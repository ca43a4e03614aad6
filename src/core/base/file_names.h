#ifndef TRILOBE_CORE_BASE_FILE_NAMES_H_
#define TRILOBE_CORE_BASE_FILE_NAMES_H_

#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// The last part of a path, without its folders, which may name a person: what a file that is meant
// to be sent says of another one.
std::string FileNameOf(std::string_view path);

// A message without these folders before the names of files in it.
std::string WithoutFolders(std::string message, const std::vector<std::string>& folders);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_FILE_NAMES_H_
