#ifndef TRILOBE_IO_MODEL_FILES_TERMS_FILE_H_
#define TRILOBE_IO_MODEL_FILES_TERMS_FILE_H_

#include <string>

#include "trilobe/model/evaluate/read_terms.h"

namespace trilobe {

// The file as ReadTerms reads it back, bit for bit. Throws Error for numbers that are not finite
// and >= 0.
std::string FormatTerms(const TermFile& file);

// Throws Error, and leaves no file, if it cannot be written.
void WriteTerms(const TermFile& file, const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_MODEL_FILES_TERMS_FILE_H_
