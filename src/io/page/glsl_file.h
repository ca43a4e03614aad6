#ifndef TRILOBE_IO_PAGE_GLSL_FILE_H_
#define TRILOBE_IO_PAGE_GLSL_FILE_H_

#include <string>

#include "trilobe/model/evaluate/read_model.h"

namespace trilobe {

// A model as a text of GLSL ES 3.00 (WebGL 2, and desktop GLSL 3.30): trilobe_eval, trilobe_pdf and
// trilobe_sample, and, in a comment at its end, the texture that they read. The comment at its
// beginning says how to load that. Throws Error as MakeShaderTables does.
struct GlslFile {
  std::string text;
  int width = 0, height = 0;  // of the texture
};
GlslFile FormatGlsl(const ModelFile& model, const std::string& name);

}  // namespace trilobe

#endif  // TRILOBE_IO_PAGE_GLSL_FILE_H_
