#ifndef TRILOBE_FIT_EXPORT_CONVERT_H_
#define TRILOBE_FIT_EXPORT_CONVERT_H_

#include <string>
#include <vector>

#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// How files for renderers are made.
struct ConvertOptions {
  double error = 0;          // of .bsdf: RglExportOptions::max_error, 0 to 1; 0 for its default
  bool spectral = false;     // of .bsdf: spectra in place of RGB
  std::string program = {};  // what the file says it was written by, "trilobe 0.1.0"
  std::string picture = {};  // of standard materials: draws both side by side there, if given
  AppearanceOptions appearance = {};  // by which the nearest standard material is judged
  int num_threads = 1;
};

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
