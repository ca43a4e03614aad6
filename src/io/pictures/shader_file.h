#ifndef TRILOBE_IO_PICTURES_SHADER_FILE_H_
#define TRILOBE_IO_PICTURES_SHADER_FILE_H_

#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/read_model.h"

namespace trilobe {

// A model for the shaders of web/: macros and constants define its form, and a texture of four
// floats per texel and kShaderWidth texels per row holds its numbers, for texelFetch. A texel holds
// four tables, so that one fetch serves four lobes:
//   D, F       [entry][group of 4 tables]
//   G          the same, or, of a spline, [node][group][value, bend] as in CatmullRom::Piece,
//              with one more table, the cosines
//   rings      angles of a polar axis [degrees], four per texel
// For sampling, the tables of Bsdf follow, number after number.
inline constexpr int kShaderWidth = 256;
struct ShaderTables {
  std::string preamble;       // goes before web/bsdf.glsl
  std::vector<float> texels;  // [rows * kShaderWidth * 4]
  bool sampled = false;       // includes the tables of web/sample.glsl

  int rows() const { return static_cast<int>(texels.size()) / (4 * kShaderWidth); }
};

// Throws Error for a model whose parameters are not finite and >= 0, or too large for floats.
ShaderTables MakeShaderTables(const FactorModel& model, bool sampled);

// Language of a shader's file: GLSL ES 3.00 (WebGL 2, and desktop GLSL 3.30), or HLSL of shader
// model 4 or newer.
enum class ShaderLanguage { kGlsl, kHlsl };

// A model as functions of a shader: trilobe_eval, trilobe_pdf and trilobe_sample. A comment at the
// end holds their texture; the comment at the beginning says how to load it. Throws Error as
// MakeShaderTables does.
struct ShaderFile {
  std::string text;
  int width = 0, height = 0;  // of the texture
};
ShaderFile FormatShader(const ModelFile& model, const std::string& name, ShaderLanguage language);

}  // namespace trilobe

#endif  // TRILOBE_IO_PICTURES_SHADER_FILE_H_
