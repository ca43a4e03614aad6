#include "io/page/glsl_file.h"

#include <bit>
#include <cstdint>
#include <sstream>

#include "io/page/base64.h"
#include "io/page/shader_tables.h"
#include "io/page/web_files.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

std::string LittleEndian(const std::vector<float>& numbers) {
  std::string bytes;
  bytes.reserve(4 * numbers.size());
  for (const float x : numbers) {
    const auto bits = std::bit_cast<uint32_t>(x);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xFF);
  }
  return bytes;
}

}  // namespace

GlslFile FormatGlsl(const ModelFile& model, const std::string& name) {
  const ShaderTables tables = MakeShaderTables(model.model, /*sampled=*/true);
  std::string printable = Printable(name);
  for (char& c : printable) {
    if (c == '*' || c == '/' || c == '\\') c = c == '/' ? '|' : ' ';  // nothing ends a comment
  }
  std::ostringstream text;
  text
      << "// " << printable << ": a model of Trilobe, for GLSL ES 3.00. Include it after\n"
      << "//   precision highp float; precision highp sampler2D;\n"
      << "// It gives, for unit vectors away from the surface, z along the normal:\n"
      << "//   vec3 trilobe_eval(vec3 wi, vec3 wo)           the BRDF [1/sr], without a cosine\n"
      << "//   float trilobe_pdf(vec3 wi, vec3 wo)           the density of trilobe_sample [1/sr]\n"
      << "//   vec3 trilobe_sample(vec3 wi, vec2 u, out float pdf, out vec3 weight)\n"
      << "//     a direction wo, and weight = f cos theta_o / pdf\n"
      << "// trilobe_tables is a texture of " << kShaderWidth << " x " << tables.rows()
      << " texels of four floats (RGBA32F), without filter\n"
      << "// (NEAREST) and levels. Its numbers are in the comment at the end: little-endian "
         "float32 in\n"
      << "// base64, row by row. In JavaScript, `source` being the text of this file:\n"
      << "//   const data = /tables RGBA32F (\\d+) x (\\d+)\\n([^*]*)\\*\\//.exec(source);\n"
      << "//   const bytes = Uint8Array.from(atob(data[3].replace(/\\s/g, '')), c => "
         "c.charCodeAt(0));\n"
      << "//   gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, +data[1], +data[2], 0, gl.RGBA, "
         "gl.FLOAT,\n"
      << "//                 new Float32Array(bytes.buffer));\n"
      << "uniform highp sampler2D trilobe_tables;\n"
      << tables.preamble << '\n'
      << WebText("bsdf.glsl") << '\n'
      << WebText("sample.glsl") << "\n/* tables RGBA32F " << kShaderWidth << " x " << tables.rows()
      << '\n'
      << Base64(LittleEndian(tables.texels), 120) << "\n*/\n";
  return {text.str(), kShaderWidth, tables.rows()};
}

}  // namespace trilobe
