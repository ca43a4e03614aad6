#ifndef TRILOBE_IO_PICTURES_WEB_FILES_H_
#define TRILOBE_IO_PICTURES_WEB_FILES_H_

#include <span>

#include "core/files/embedded_file.h"

namespace trilobe {

// The files of web/.
std::span<const EmbeddedFile> WebFiles();

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_WEB_FILES_H_
