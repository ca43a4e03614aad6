#ifndef TRILOBE_IO_FORMATS_MODEL_FILE_H_
#define TRILOBE_IO_FORMATS_MODEL_FILE_H_

#include <string>

#include "trilobe/model/read_model.h"

namespace trilobe {

// The text of a model file as ParseModel reads it, and the file itself. Both throw Error for
// parameters that are not finite and >= 0, WriteModel also if the file cannot be written.
std::string FormatModel(const ModelFile& file);
void WriteModel(const ModelFile& file, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_MODEL_FILE_H_
