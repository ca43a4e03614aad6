#ifndef TRILOBE_CORE_FILES_EMBEDDED_FILE_H_
#define TRILOBE_CORE_FILES_EMBEDDED_FILE_H_

#include <string_view>

namespace trilobe {

// A file of the repository, as it was when the library was built (cmake/TrilobeEmbed.cmake).
struct EmbeddedFile {
  std::string_view name, text;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_EMBEDDED_FILE_H_
