#ifndef TRILOBE_FIT_EXPORT_CONVERT_H_
#define TRILOBE_FIT_EXPORT_CONVERT_H_

#include <string>
#include <vector>

#include "trilobe/fit/export/convert_options.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Whether the path ends as one of these files does: .bsdf (RGL tensor file), .glsl, .mtlx
// (MaterialX) and .principled.json (Blender's Principled BSDF).
bool IsForRenderer(const std::string& path);
// Whether it is one of the latter two, which have the nearest material of fixed closures.
bool IsStandardMaterial(const std::string& path);

// Writes a model, or a measurement, by the ending of the path. Returns lines that say what was
// written, and how far off it is. Of a measurement, a model is fitted for that, which takes
// seconds: a .bsdf file has the values that were measured, and the model's where nothing was; .mtlx
// and .principled.json have what is nearest to the model. `source` is what messages call the model.
// Throws Error, also for a measurement to .glsl, and where the file cannot be written.
std::vector<std::string> WriteForRenderer(const ModelFile& file, const std::string& source,
                                          const std::string& path, const ConvertOptions& options);
std::vector<std::string> WriteForRenderer(const Measurement& measurement, const std::string& path,
                                          const ConvertOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_CONVERT_H_
