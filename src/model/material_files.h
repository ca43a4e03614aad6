#ifndef TRILOBE_MODEL_MATERIAL_FILES_H_
#define TRILOBE_MODEL_MATERIAL_FILES_H_

#include <span>

#include "core/files/embedded_file.h"

namespace trilobe {

// The files in materials/: one model file each, and materials.json, which describes them.
std::span<const EmbeddedFile> MaterialFiles();

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MATERIAL_FILES_H_
