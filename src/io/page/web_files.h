#ifndef TRILOBE_IO_PAGE_WEB_FILES_H_
#define TRILOBE_IO_PAGE_WEB_FILES_H_

#include <span>
#include <string_view>

#include "core/files/embedded_file.h"

namespace trilobe {

// The files of web/.
std::span<const EmbeddedFile> WebFiles();

// The text of one. Throws Error where there is none of this name.
std::string_view WebText(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_WEB_FILES_H_
