#ifndef TRILOBE_FIT_EXPORT_CONVERT_H_
#define TRILOBE_FIT_EXPORT_CONVERT_H_

#include <functional>
#include <string>
#include <vector>

#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Options of WriteForRenderer.
struct ConvertOptions {
  double error = 0;          // for .bsdf: largest median error, 0 to 1; 0 for the default
  bool spectral = false;     // for .bsdf: spectra instead of RGB
  std::string program = {};  // program named in the file, "trilobe 0.1.0"
  std::string picture = {};  // for standard materials: PNG of both side by side; empty: none
  AppearanceOptions appearance = {};  // of the spheres that judge standard materials
  int num_threads = 1;
  // Called when a stage begins that may take seconds, with what it does.
  std::function<void(const std::string&)> on_stage = [](const std::string&) {};
};

// Whether the path has the extension of a renderer's file: .bsdf (RGL tensor file), .zemax.bsdf
// (OpticStudio's table), .xml (Klems matrices of Radiance and WINDOW), .xompt (OpenMATERIAL 3D),
// .glsl, .hlsl, .mtlx (MaterialX), .principled.json (Blender's Principled BSDF), .gltf or .usda.
bool IsForRenderer(const std::string& path);
// Whether it is .bsdf and not .zemax.bsdf.
bool IsTensorFile(const std::string& path);
// Whether ConvertOptions::error counts: .bsdf and .zemax.bsdf.
bool TakesError(const std::string& path);
// Whether the extension is .mtlx, .principled.json, .gltf or .usda, which hold the nearest standard
// material.
bool IsStandardMaterial(const std::string& path);

// Writes a model or a measurement in the format of the path's extension. Returns lines that say
// what was written and its error. A measurement is fitted first, which takes seconds: .bsdf,
// .xml and .xompt files hold the measured values, and the model's where nothing was measured;
// .mtlx, .principled.json, .gltf and .usda are nearest to the model. `source` names the model in
// messages. Throws Error, also for a measurement to .glsl or .hlsl, for an anisotropic one to
// .xompt, and if the file cannot be written.
std::vector<std::string> WriteForRenderer(const ModelFile& file, const std::string& source,
                                          const std::string& path, const ConvertOptions& options);
std::vector<std::string> WriteForRenderer(const Measurement& measurement, const std::string& path,
                                          const ConvertOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_CONVERT_H_
