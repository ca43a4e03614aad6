#ifndef TRILOBE_VIEW_WEB_FILES_H_
#define TRILOBE_VIEW_WEB_FILES_H_

#include <span>
#include <string_view>

namespace trilobe {

// A file of web/, as it was when the program was built (cmake/TrilobeEmbed.cmake).
struct WebFile {
  std::string_view name, text;
};
std::span<const WebFile> WebFiles();

// Its text. Throws Error where there is none of this name.
std::string_view WebText(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_VIEW_WEB_FILES_H_
