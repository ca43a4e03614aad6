#ifndef TRILOBE_FIT_EXPORT_STANDARD_FILE_H_
#define TRILOBE_FIT_EXPORT_STANDARD_FILE_H_

#include <string>
#include <vector>

#include "trilobe/fit/export/convert_options.h"
#include "trilobe/io/model_files/model_file.h"

namespace trilobe {

// Writes the nearest material of renderers that have no other to a model. Returns lines as
// WriteForRenderer does.
std::vector<std::string> WriteStandard(const ModelFile& file, const std::string& source,
                                       const std::string& path, const ConvertOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_STANDARD_FILE_H_
