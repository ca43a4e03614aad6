#ifndef TRILOBE_IO_PAGE_GLSL_FILE_H_
#define TRILOBE_IO_PAGE_GLSL_FILE_H_

#include <string>
#include <vector>

#include "trilobe/model/evaluate/read_model.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A model as the shaders of web/ read it: the form in macros and constants, the numbers in a
// texture of four floats a texel, kShaderWidth texels a row, which texelFetch reads. Tables are
// beside each other, four in a texel, so that one fetch serves four lobes:
//   D, F       [entry][group of 4 tables]
//   G          the same, or, of a spline, [node][group][value, bend] as CatmullRom::Piece has
//              them, with one more table, the cosines
//   rings      angles of a polar axis [degrees], four in a texel
// and of the sampling the tables of Bsdf, number after number.
inline constexpr int kShaderWidth = 256;
struct ShaderTables {
  std::string preamble;       // what stands before web/bsdf.glsl
  std::vector<float> texels;  // [rows * kShaderWidth * 4]
  bool sampled = false;       // whether the tables of web/sample.glsl are among them

  int rows() const { return static_cast<int>(texels.size()) / (4 * kShaderWidth); }
};

// Throws Error for a model whose parameters are not finite and >= 0, or too large for floats.
ShaderTables MakeShaderTables(const FactorModel& model, bool sampled);

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
