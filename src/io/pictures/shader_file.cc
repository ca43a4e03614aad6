#include "io/pictures/shader_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iomanip>
#include <limits>
#include <locale>
#include <regex>
#include <span>
#include <sstream>
#include <utility>

#include "core/base/file_names.h"
#include "io/pictures/document.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {
namespace {

float ToFloat(double x) {
  if (!(std::abs(x) <= std::numeric_limits<float>::max())) {
    throw Error(ErrorKind::kData,
                "the model's values overflow a shader's numbers; its factors are too large")
        .About("model", "overflow");
  }
  return static_cast<float>(x);
}

class Packer {
 public:
  explicit Packer(const FactorModel& model) : model_(model), spec_(model.spec()) {
    text_.imbue(std::locale::classic());
    text_ << std::setprecision(std::numeric_limits<float>::max_digits10) << std::showpoint;
  }

  ShaderTables Pack(bool sampled) {
    Define("TB_LOBES", spec_.lobes);
    if (spec_.lobes > 0) {
      for (const Factor factor : kFactors) AddFactor(factor);
      AddStretches();
    }
    WriteConstants();
    ShaderTables tables;
    if (sampled) AddSampling();
    tables.sampled = sampled;
    tables.texels = std::move(texels_);
    const size_t row = size_t{4} * kShaderWidth;
    tables.texels.resize((tables.texels.size() + row - 1) / row * row);
    if (tables.texels.empty()) tables.texels.resize(row);
    tables.preamble = text_.str();
    return tables;
  }

 private:
  void Define(const std::string& name, int value) {
    text_ << "#define " << name << ' ' << value << '\n';
  }

  int NextTexel() const { return static_cast<int>(texels_.size() / 4); }
  void FillTexel() { texels_.resize((texels_.size() + 3) / 4 * 4); }

  // Four tables in a texel, entry by entry.
  void AddTables(const std::vector<std::vector<double>>& tables, int groups) {
    const size_t size = tables.front().size();
    for (size_t e = 0; e < size; ++e) {
      for (size_t t = 0; t < size_t{4} * groups; ++t) {
        texels_.push_back(t < tables.size() ? ToFloat(tables[t][e]) : 0.0F);
      }
    }
  }

  // Values and bends by turns, and the cosines after the last table.
  void AddSplines(std::vector<std::vector<double>> tables, int groups) {
    const CatmullRom spline(spec_.g_axis.size);
    std::vector<double>& cosines = tables.emplace_back();
    for (int k = 0; k < spline.nodes(); ++k) cosines.push_back(std::cos(spline.NodeAngle(k)));
    std::vector<std::vector<double>> bends;
    for (const std::vector<double>& table : tables) {
      std::vector<double>& bend = bends.emplace_back();
      for (const CatmullRom::Piece& piece : spline.Pieces(table)) bend.push_back(piece.a0);
      bend.push_back(0);
    }
    for (int k = 0; k < spline.nodes(); ++k) {
      for (int g = 0; g < groups; ++g) {
        for (const auto* const columns : {&tables, &bends}) {
          for (size_t t = size_t{4} * g; t < size_t{4} * (g + 1); ++t) {
            texels_.push_back(t < columns->size() ? ToFloat((*columns)[t][k]) : 0.0F);
          }
        }
      }
    }
  }

  void AddFactor(Factor factor) {
    const std::string name = std::string("TB_") + FactorName(factor);
    const Axis& axis = spec_.axis(factor);
    const int count = spec_.num_tables(factor);
    const bool spline = axis.rule == Axis::Rule::kSpline;
    const int groups = (count + (spline ? 1 : 0) + 3) / 4;
    std::vector<std::vector<double>> tables;
    for (int t = 0; t < count; ++t) {
      const std::span<const double> table = model_.table(factor, t);
      tables.emplace_back(table.begin(), table.end());
    }
    Define(name + "_TABLES", count);
    Define(name + "_GROUPS", groups);
    Define(name + "_PER_LOBE", spec_.sharing(factor).per_lobe ? 1 : 0);
    Define(name + "_PER_CHANNEL", spec_.sharing(factor).per_channel ? 1 : 0);
    Define(name + "_SIZE", axis.size);
    Define(name + "_PHIS", axis.polar() ? axis.phi_nodes : 0);
    if (factor == Factor::kD) Define(name + "_ROOT", axis.rule == Axis::Rule::kRootTheta ? 1 : 0);
    Define(name + "_BASE", NextTexel());
    if (spline) {
      AddSplines(tables, groups);
    } else {
      AddTables(tables, groups);
    }
    if (!axis.polar()) return;
    Define(name + "_RINGS", static_cast<int>(axis.theta.size()));
    Define(name + "_RINGS_BASE", NextTexel());
    for (const double theta : axis.theta) texels_.push_back(ToFloat(theta));
    while (texels_.size() % 4 != 0) texels_.push_back(1e9F);
  }

  void AddStretches() {
    const std::vector<Stretch>& stretches = spec_.stretches.distinct();
    const int count = spec_.stretches.any() ? static_cast<int>(stretches.size()) : 0;
    Define("TB_STRETCHES", count);
    if (count == 0) return;
    WriteArray("vec2", "trilobe_stretch", count, [&](int k) {
      text_ << "vec2(" << stretches[k].along << ", " << stretches[k].across << ')';
    });
    const int tables = spec_.num_tables(Factor::kD);
    WriteArray("int", "trilobe_stretch_of", tables,
               [&](int k) { text_ << spec_.StretchOfTable(k); });
  }

  // A constant array, as GLSL has it.
  void WriteArray(const std::string& type, const std::string& name, int size,
                  const std::function<void(int)>& write_entry) {
    text_ << "const " << type << ' ' << name << '[' << size << "] = " << type << '[' << size
          << "](";
    for (int k = 0; k < size; ++k) {
      if (k > 0) text_ << ", ";
      write_entry(k);
    }
    text_ << ");\n";
  }

  void WriteColour(std::span<const double> rgb) {
    text_ << "vec3(";
    for (int c = 0; c < kChannels; ++c) text_ << (c > 0 ? ", " : "") << ToFloat(rgb[c]);
    text_ << ')';
  }

  void WriteConstants() {
    text_ << "const vec3 trilobe_diffuse = ";
    WriteColour(model_.d());
    text_ << ";\n";
    if (spec_.lobes == 0) return;
    WriteArray("vec3", "trilobe_specular", spec_.lobes, [&](int m) { WriteColour(model_.s(m)); });
  }

  void AddNumbers(const std::string& name, const std::vector<float>& numbers) {
    Define(name, NextTexel());
    texels_.insert(texels_.end(), numbers.begin(), numbers.end());
    FillTexel();
  }

  void AddSampling() {
    const Bsdf<float> bsdf(model_);
    const HalfVectorTable<float>& table = bsdf.half_vectors();
    Define("TB_THETAS_I", static_cast<int>(table.theta_i().size()));
    Define("TB_PHIS_I", table.num_phi_i());
    Define("TB_ROWS", static_cast<int>(table.y().size()));
    Define("TB_S", table.num_s());
    AddNumbers("TB_THETA_I_BASE", table.theta_i());
    AddNumbers("TB_Y_BASE", table.y());
    AddNumbers("TB_OF_ROW_BASE", table.of_row());
    AddNumbers("TB_CUMULATED_BASE", table.cumulated());
    AddNumbers("TB_VALUES_BASE", table.values());
  }

  const FactorModel& model_;
  const ModelSpec& spec_;
  std::ostringstream text_;
  std::vector<float> texels_;
};

}  // namespace

ShaderTables MakeShaderTables(const FactorModel& model, bool sampled) {
  CheckParameters(model);
  return Packer(model).Pack(sampled);
}

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

// GLSL that keeps to what both have, as HLSL.
std::string AsHlsl(const std::string& glsl) {
  using Change = std::pair<std::regex, const char*>;
  static const std::array<Change, 6> kChanges = {
      Change(R"(texelFetch\(trilobe_tables, ivec2\((.*?), (.*?)\), 0\))",
             "trilobe_tables.Load(int3($1, $2, 0))"),
      Change(R"(\n(const \w+ \w+\[\d+\] = )\w+\[\d+\]\((.*)\);)", "\n$1{$2};"),
      Change(R"(\nconst )", "\nstatic const "),
      Change(R"(\bvec([234])\b)", "float$1"),
      Change(R"(\bivec([234])\b)", "int$1"),
      Change(R"(\bmix\b)", "lerp"),
  };
  std::string text = glsl;
  for (const auto& [what, by] : kChanges) text = std::regex_replace(text, what, by);
  return text;
}

constexpr const char* kLoadingInJavaScript =
    "// In JavaScript, `source` being the text of this file:\n"
    "//   const data = /tables RGBA32F (\\d+) x (\\d+)\\n([^*]*)\\*\\//.exec(source);\n"
    "//   const bytes = Uint8Array.from(atob(data[3].replace(/\\s/g, '')), c => c.charCodeAt(0));\n"
    "//   gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, +data[1], +data[2], 0, gl.RGBA, gl.FLOAT,\n"
    "//                 new Float32Array(bytes.buffer));\n";

}  // namespace

ShaderFile FormatShader(const ModelFile& model, const std::string& name, ShaderLanguage language) {
  const bool hlsl = language == ShaderLanguage::kHlsl;
  const ShaderTables tables = MakeShaderTables(model.model, /*sampled=*/true);
  std::string printable = Printable(FileNameOf(name));
  for (char& c : printable) {
    if (c == '*' || c == '/' || c == '\\') c = c == '/' ? '|' : ' ';  // nothing ends a comment
  }
  std::ostringstream code;
  code
      << "// It gives, for unit vectors away from the surface, z along the normal:\n"
      << "//   vec3 trilobe_eval(vec3 wi, vec3 wo)           the BRDF [1/sr], without a cosine\n"
      << "//   float trilobe_pdf(vec3 wi, vec3 wo)           the density of trilobe_sample [1/sr]\n"
      << "//   vec3 trilobe_sample(vec3 wi, vec2 u, out float pdf, out vec3 weight)\n"
      << "//     a direction wo, and weight = f cos theta_o / pdf\n"
      << "// trilobe_tables is a texture of " << kShaderWidth << " x " << tables.rows()
      << " texels of four floats ("
      << (hlsl ? "DXGI_FORMAT_R32G32B32A32_FLOAT" : "RGBA32F, NEAREST")
      << "),\n// without levels. Its numbers are in the comment at the end: little-endian float32 "
         "in "
         "base64, row by row.\n"
      << (hlsl ? "Texture2D<float4> trilobe_tables;\n"
               : std::string(kLoadingInJavaScript) + "uniform highp sampler2D trilobe_tables;\n")
      << tables.preamble << '\n'
      << WebText("bsdf.glsl") << '\n'
      << WebText("sample.glsl");
  std::ostringstream text;
  text << "// " << printable << ": a model of Trilobe, for "
       << (hlsl ? "HLSL of shader model 4 or newer.\n"
                : "GLSL ES 3.00. Include it after\n"
                  "//   precision highp float; precision highp sampler2D;\n")
       << (hlsl ? AsHlsl(code.str()) : code.str()) << "\n/* tables RGBA32F " << kShaderWidth
       << " x " << tables.rows() << '\n'
       << Base64(LittleEndian(tables.texels), 120) << "\n*/\n";
  return {text.str(), kShaderWidth, tables.rows()};
}

}  // namespace trilobe
