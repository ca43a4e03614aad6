#include "core/base/file_names.h"

#include <cstddef>

#include "trilobe/core/base/printable.h"

namespace trilobe {

std::string FileNameOf(std::string_view path) {
  return std::string(path.substr(path.rfind('/') + 1));
}

std::string WithoutFolders(std::string message, const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    std::string prefix = Printable(folder);
    while (prefix.ends_with('/')) prefix.pop_back();
    if (prefix.empty()) continue;
    prefix += '/';
    for (size_t at = 0; (at = message.find(prefix, at)) != std::string::npos;) {
      // A match must not be the end of another folder's name.
      if (at == 0 || std::string_view(" '\"(").find(message[at - 1]) != std::string_view::npos) {
        message.erase(at, prefix.size());
      } else {
        ++at;
      }
    }
  }
  return message;
}

}  // namespace trilobe
