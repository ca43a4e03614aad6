#ifndef TRILOBE_FIT_EXPORT_CONVERT_OPTIONS_H_
#define TRILOBE_FIT_EXPORT_CONVERT_OPTIONS_H_

#include <string>

#include "trilobe/model/appearance/appearance.h"

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

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_CONVERT_OPTIONS_H_
