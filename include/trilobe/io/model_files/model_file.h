#ifndef TRILOBE_IO_MODEL_FILES_MODEL_FILE_H_
#define TRILOBE_IO_MODEL_FILES_MODEL_FILE_H_

#include <string>

#include "trilobe/model/evaluate/read_model.h"

namespace trilobe {

// A model file as ParseModel reads it: its text, and the file. Throws Error for parameters that are
// not finite and >= 0, and if the file cannot be written.
std::string FormatModel(const ModelFile& file);
void WriteModel(const ModelFile& file, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_MODEL_FILES_MODEL_FILE_H_
