#include "fit/export/usd_material.h"

#include <cctype>
#include <sstream>

#include "core/base/text.h"

namespace trilobe {
namespace {

// A name that USD takes: letters, digits and underscores, no digit first.
std::string Identifier(const std::string& name) {
  std::string identifier;
  for (const unsigned char c : name) {
    identifier += std::isalnum(c) != 0 && c < 0x80 ? static_cast<char>(c) : '_';
  }
  const bool begins = !identifier.empty() && std::isdigit(identifier.front()) == 0;
  return begins ? identifier : "_" + identifier;
}

// A string of several lines. Quotes and backslashes are escaped.
std::string Quoted(const std::string& text) {
  std::string quoted = R"(""")";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + R"(""")";
}

}  // namespace

std::string FormatUsd(const OpenPbr& material, const MaterialNotes& notes) {
  const std::string name = Identifier(notes.name);
  const auto number = [](double x) { return Text(Rounded(x), 6); };
  const Rgb& color = material.base_color;
  std::ostringstream out;
  out << "#usda 1.0\n(\n    doc = "
      << Quoted(ValidUtf8(notes.made + "\n" + notes.error + "\n" + notes.lost)) << "\n"
      << "    defaultPrim = \"World\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
      << "def Xform \"World\"\n{\n"
      << "    def Sphere \"Sphere\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    "
         ")\n"
      << "    {\n        float3[] extent = [(-1, -1, -1), (1, 1, 1)]\n        double radius = 1\n"
      << "        rel material:binding = </World/Looks/" << name << ">\n    }\n\n"
      << "    def Scope \"Looks\"\n    {\n"
      << "        def Material \"" << name << "\"\n        {\n"
      << "            token outputs:surface.connect = </World/Looks/" << name
      << "/Surface.outputs:surface>\n\n"
      << "            def Shader \"Surface\"\n            {\n"
      << "                uniform token info:id = \"UsdPreviewSurface\"\n"
      << "                color3f inputs:diffuseColor = (" << number(color[0]) << ", "
      << number(color[1]) << ", " << number(color[2]) << ")\n";
  // A metal has its F0 from the colour.
  if (Rounded(material.base_metalness) < 1) {
    out << "                float inputs:ior = " << number(material.specular_ior) << "\n";
  }
  out << "                float inputs:metallic = " << number(material.base_metalness) << "\n"
      << "                float inputs:roughness = " << number(material.specular_roughness) << "\n"
      << "                token outputs:surface\n            }\n        }\n    }\n}\n";
  return out.str();
}

}  // namespace trilobe
