#include "fit/open_pbr/material_files.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/base/markup.h"
#include "core/base/text.h"
#include "trilobe/core/math/angles.h"

namespace trilobe {
namespace {

std::string ColorText(const Rgb& rgb) {
  return Text(rgb[0]) + ", " + Text(rgb[1]) + ", " + Text(rgb[2]);
}

double Rounded(double x) { return std::round(x * 1e4) / 1e4; }

// Within an attribute. XML has no other control characters, not even escaped.
std::string Escaped(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return EscapedMarkup(text);
}

std::string NameOf(const std::string& name) {
  std::string valid;
  for (const char c : name) {
    valid += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  if (valid.empty() || std::isdigit(static_cast<unsigned char>(valid.front())) != 0) {
    valid.insert(0, "material_");
  }
  return valid;
}

// An element's beginning with its attributes: <tag name="x" type="float" ...
std::string Tag(const std::string& tag,
                const std::vector<std::pair<std::string, std::string>>& attributes) {
  std::string text = "<" + tag;
  for (const auto& attribute : attributes) {
    text += " " + attribute.first + "=" + '"' + Escaped(attribute.second) + '"';
  }
  return text;
}

std::string Input(const std::string& name, const std::string& type, const std::string& value) {
  return "    " + Tag("input", {{"name", name}, {"type", type}, {"value", value}}) + " />\n";
}
std::string Linked(const std::string& name, const std::string& type, const std::string& node) {
  return "    " + Tag("input", {{"name", name}, {"type", type}, {"nodename", node}}) + " />\n";
}

// A node that makes a vector, and its inputs.
std::string Vector(const std::string& category, const std::string& name,
                   const std::string& inputs) {
  return "  " + Tag(category, {{"name", name}, {"type", "vector3"}}) + ">\n" + inputs + "  </" +
         category + ">\n";
}

}  // namespace

std::string FormatMaterialX(const OpenPbr& material, const MaterialNotes& notes) {
  const std::string name = NameOf(notes.name);
  const bool turned = material.turn != 0 && material.specular_roughness_anisotropy > 0;
  std::string out = Tag("?xml", {{"version", "1.0"}, {"encoding", "UTF-8"}}) + "?>\n" +
                    Tag("materialx", {{"version", "1.39"}, {"colorspace", "lin_rec709"}}) + ">\n";
  if (turned) {
    out += Vector("normal", name + "_normal", Input("space", "string", "world"));
    out += Vector("tangent", name + "_tangent", Input("space", "string", "world"));
    out += Vector("rotate3d", name + "_turned",
                  Linked("in", "vector3", name + "_tangent") +
                      Input("amount", "float", Text(RadiansToDegrees(material.turn))) +
                      Linked("axis", "vector3", name + "_normal"));
  }
  out += "  " +
         Tag("open_pbr_surface", {{"name", name + "_surface"},
                                  {"type", "surfaceshader"},
                                  {"doc", notes.made + "; " + notes.error + "; " + notes.lost}}) +
         ">\n";
  out += Input("base_weight", "float", "1");
  out += Input("base_color", "color3", ColorText(material.base_color));
  out += Input("base_diffuse_roughness", "float", Text(material.base_diffuse_roughness));
  out += Input("base_metalness", "float", Text(material.base_metalness));
  out += Input("specular_weight", "float", "1");
  out += Input("specular_color", "color3", ColorText(material.specular_color));
  out += Input("specular_roughness", "float", Text(material.specular_roughness));
  out += Input("specular_ior", "float", Text(material.specular_ior));
  out +=
      Input("specular_roughness_anisotropy", "float", Text(material.specular_roughness_anisotropy));
  out += Input("coat_weight", "float", Text(material.coat_weight));
  out += Input("coat_roughness", "float", Text(material.coat_roughness));
  out += Input("coat_ior", "float", Text(material.coat_ior));
  out += Input("coat_darkening", "float", "0");
  if (turned) out += Linked("geometry_tangent", "vector3", name + "_turned");
  out += "  </open_pbr_surface>\n";
  out += "  " + Tag("surfacematerial", {{"name", name}, {"type", "material"}}) + ">\n";
  out += Linked("surfaceshader", "surfaceshader", name + "_surface");
  return out + "  </surfacematerial>\n</materialx>\n";
}

std::string FormatPrincipled(const OpenPbr& material, const MaterialNotes& notes) {
  const auto color = [](const Rgb& rgb) {
    return nlohmann::ordered_json::array({Rounded(rgb[0]), Rounded(rgb[1]), Rounded(rgb[2]), 1});
  };
  // Blender's coat does not roughen what lies below. Its axes of roughness are r^2 / a and r^2 a, a
  // = sqrt(1 - 0.9 anisotropic); the ratio is what is seen, and the turn is in parts of a circle.
  const double ratio = 1 - material.specular_roughness_anisotropy;
  const double mean = std::sqrt(std::sqrt(ratio) * std::sqrt(2 / (1 + ratio * ratio)));
  nlohmann::ordered_json json;
  json["format"] = "blender-principled";
  json["name"] = notes.name;
  json["made"] = notes.made;
  json["error"] = notes.error;
  json["lost"] = notes.lost;
  json["inputs"] = {{"Base Color", color(material.base_color)},
                    {"Metallic", Rounded(material.base_metalness)},
                    {"Roughness", Rounded(std::min(RoughnessThroughCoat(material) * mean, 1.0))},
                    {"Diffuse Roughness", Rounded(material.base_diffuse_roughness)},
                    {"IOR", Rounded(material.specular_ior)},
                    {"Specular IOR Level", 0.5},
                    {"Specular Tint", color(material.specular_color)},
                    {"Anisotropic", Rounded(std::min((1 - ratio) / 0.9, 1.0))},
                    {"Anisotropic Rotation", Rounded(material.turn / (2 * kPi))},
                    {"Coat Weight", Rounded(material.coat_weight)},
                    {"Coat Roughness", Rounded(material.coat_roughness)},
                    {"Coat IOR", Rounded(material.coat_ior)}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace trilobe
