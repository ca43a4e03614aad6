#include "fit/export/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "io/pictures/document.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
namespace {

constexpr double kLeastAlpha = 1e-4;

double Fifth(double x) { return x * x * x * x * x; }

// D V of GGX with two roughnesses: D / (4 cos cos) times the height-correlated Smith term.
double GgxValue(const DirectionPair& pair, const Direction& half, double alpha_t, double alpha_b) {
  const double x = half[0] / alpha_t, y = half[1] / alpha_b;
  const double q = x * x + y * y + half[2] * half[2];
  const double d = 1 / (kPi * alpha_t * alpha_b * q * q);
  const auto length = [&](const Direction& w) {
    return std::hypot(alpha_t * w[0], alpha_b * w[1], w[2]);
  };
  return d * 0.5 / (pair.wo[2] * length(pair.wi) + pair.wi[2] * length(pair.wo));
}

using Json = nlohmann::ordered_json;

// Numbers of a sphere's mesh, as glTF stores them.
struct Sphere {
  std::vector<float> positions, tangents, places;  // the normals are the positions
  std::vector<uint16_t> triangles;
};

Sphere MakeSphere() {
  constexpr int kAround = 64, kDown = 32;
  Sphere sphere;
  for (int j = 0; j <= kDown; ++j) {
    for (int i = 0; i <= kAround; ++i) {
      const double u = 1.0 * i / kAround, v = 1.0 * j / kDown;
      const double phi = 2 * kPi * u, theta = kPi * v;
      const double sine = std::sin(theta);
      for (const double x : {sine * std::sin(phi), std::cos(theta), sine * std::cos(phi)}) {
        sphere.positions.push_back(static_cast<float>(x));
      }
      for (const double x : {std::cos(phi), 0.0, -std::sin(phi), 1.0}) {
        sphere.tangents.push_back(static_cast<float>(x));
      }
      for (const double x : {u, v}) sphere.places.push_back(static_cast<float>(x));
      if (i == kAround || j == kDown) continue;
      const auto at = [&](int across, int down) {
        return static_cast<uint16_t>((j + down) * (kAround + 1) + i + across);
      };
      if (j > 0) {
        for (const uint16_t corner : {at(0, 0), at(0, 1), at(1, 0)}) {
          sphere.triangles.push_back(corner);
        }
      }
      if (j < kDown - 1) {
        for (const uint16_t corner : {at(1, 0), at(0, 1), at(1, 1)}) {
          sphere.triangles.push_back(corner);
        }
      }
    }
  }
  return sphere;
}

// The buffer of a document, and views of it.
class Buffer {
 public:
  // Adds numbers, `width` to an element; returns the number of their accessor.
  template <typename Number>
  int Add(const std::vector<Number>& numbers, int width, bool is_index) {
    constexpr int kFloat = 5126, kUnsignedShort = 5123;  // of OpenGL
    constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
    constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const size_t size = numbers.size() * sizeof(Number);
    views_.push_back({{"buffer", 0},
                      {"byteOffset", bytes_.size()},
                      {"byteLength", size},
                      {"target", is_index ? kElementArrayBuffer : kArrayBuffer}});
    Json accessor = {{"bufferView", views_.size() - 1},
                     {"componentType", is_index ? kUnsignedShort : kFloat},
                     {"count", numbers.size() / static_cast<size_t>(width)},
                     {"type", kTypes[width - 1]}};
    if (width == 3) {  // of a unit sphere
      accessor["min"] = {-1, -1, -1};
      accessor["max"] = {1, 1, 1};
    }
    accessors_.push_back(std::move(accessor));
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), size);
    while (bytes_.size() % 4 != 0) bytes_ += '\0';
    return static_cast<int>(accessors_.size()) - 1;
  }

  void PutInto(Json* document) const {
    (*document)["buffers"] =
        Json::array({{{"byteLength", bytes_.size()},
                      {"uri", "data:application/octet-stream;base64," + Base64(bytes_)}}});
    (*document)["bufferViews"] = views_;
    (*document)["accessors"] = accessors_;
  }

 private:
  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

Json ColorOf(const Rgb& rgb) { return {Rounded(rgb[0]), Rounded(rgb[1]), Rounded(rgb[2])}; }

bool IsWhite(const Rgb& rgb) {
  return std::ranges::all_of(rgb, [](double x) { return Rounded(x) == 1; });
}

// Only what differs from glTF's defaults.
Json ExtensionsOf(const OpenPbr& material) {
  Json extensions = Json::object();
  constexpr double kUsualIor = 1.5;
  const bool is_metal = Rounded(material.base_metalness) == 1;
  if (!is_metal && Rounded(material.specular_ior) != kUsualIor) {
    extensions["KHR_materials_ior"] = {{"ior", Rounded(material.specular_ior)}};
  }
  if (!is_metal && !IsWhite(material.specular_color)) {
    extensions["KHR_materials_specular"] = {
        {"specularColorFactor", ColorOf(material.specular_color)}};
  }
  if (Rounded(material.coat_weight) > 0) {
    extensions["KHR_materials_clearcoat"] = {
        {"clearcoatFactor", Rounded(material.coat_weight)},
        {"clearcoatRoughnessFactor", Rounded(material.coat_roughness)}};
  }
  if (Rounded(material.specular_roughness_anisotropy) > 0) {
    extensions["KHR_materials_anisotropy"] = {
        {"anisotropyStrength", Rounded(material.specular_roughness_anisotropy)},
        {"anisotropyRotation", Rounded(material.turn)}};
  }
  return extensions;
}

}  // namespace

GltfBrdf::GltfBrdf(const OpenPbr& parameters)
    : parameters_(parameters),
      cos_turn_(std::cos(parameters.turn)),
      sin_turn_(std::sin(parameters.turn)) {
  const double alpha = std::max(std::pow(parameters.specular_roughness, 2), kLeastAlpha);
  const double strength = parameters.specular_roughness_anisotropy;
  alpha_t_ = alpha + (1 - alpha) * strength * strength;
  alpha_b_ = alpha;
  alpha_coat_ = std::max(std::pow(parameters.coat_roughness, 2), kLeastAlpha);
  f0_ = std::pow((parameters.specular_ior - 1) / (parameters.specular_ior + 1), 2);
}

Rgb GltfBrdf::operator()(const DirectionPair& pair) const {
  if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) return {};
  const auto [at, half] = ToTangentFrame(pair, cos_turn_, sin_turn_);
  const double rise = Fifth(1 - std::clamp(Dot(at.wi, half), 0.0, 1.0));

  const OpenPbr& p = parameters_;
  const double specular = GgxValue(at, half, alpha_t_, alpha_b_);
  Rgb dielectric{};
  double most = 0;
  for (int c = 0; c < kChannels; ++c) {
    const double f0 = std::min(f0_ * p.specular_color[c], 1.0);
    dielectric[c] = f0 + (1 - f0) * rise;
    most = std::max(most, dielectric[c]);
  }
  double coat = 0, below_coat = 1;
  if (p.coat_weight > 0) {
    constexpr double kF0 = 0.04;
    const double share = p.coat_weight * (kF0 + (1 - kF0) * Fifth(1 - at.wo[2]));
    coat = share * GgxValue(at, half, alpha_coat_, alpha_coat_);
    below_coat = 1 - share;
  }
  Rgb value{};
  for (int c = 0; c < kChannels; ++c) {
    const double color = p.base_color[c];
    const double metal = specular * (color + (1 - color) * rise);
    const double plastic = (1 - most) * color / kPi + dielectric[c] * specular;
    value[c] = coat + below_coat * (plastic + p.base_metalness * (metal - plastic));
  }
  return value;
}

std::string FormatGltf(const OpenPbr& material, const MaterialNotes& notes) {
  const Json extensions = ExtensionsOf(material);
  Json base_color = ColorOf(material.base_color);
  base_color.push_back(1);
  Json shown = {{"name", notes.name},
                {"pbrMetallicRoughness",
                 {{"baseColorFactor", base_color},
                  {"metallicFactor", Rounded(material.base_metalness)},
                  {"roughnessFactor", Rounded(material.specular_roughness)}}}};
  if (!extensions.empty()) shown["extensions"] = extensions;
  shown["extras"] = {{"made", notes.made}, {"error", notes.error}, {"lost", notes.lost}};

  Json document = {{"asset", {{"version", "2.0"}, {"generator", notes.made}}}};
  if (!extensions.empty()) {
    Json used = Json::array();
    for (auto at = extensions.begin(); at != extensions.end(); ++at) used.push_back(at.key());
    document["extensionsUsed"] = used;
  }
  const Sphere sphere = MakeSphere();
  Buffer buffer;
  const int positions = buffer.Add(sphere.positions, 3, /*is_index=*/false);
  const int tangents = buffer.Add(sphere.tangents, 4, /*is_index=*/false);
  const int places = buffer.Add(sphere.places, 2, /*is_index=*/false);
  const int triangles = buffer.Add(sphere.triangles, 1, /*is_index=*/true);
  document["scene"] = 0;
  document["scenes"] = Json::array({{{"nodes", {0}}}});
  document["nodes"] = Json::array({{{"mesh", 0}, {"name", notes.name}}});
  document["meshes"] = Json::array({{{"primitives", Json::array({{{"attributes",
                                                                   {{"POSITION", positions},
                                                                    {"NORMAL", positions},
                                                                    {"TANGENT", tangents},
                                                                    {"TEXCOORD_0", places}}},
                                                                  {"indices", triangles},
                                                                  {"material", 0}}})}}});
  document["materials"] = Json::array({shown});
  buffer.PutInto(&document);
  return JsonText(document, 2) + "\n";
}

std::string EngineText(const OpenPbr& material) {
  const auto color = [](const Rgb& rgb) {
    return Text(rgb[0], 3) + ", " + Text(rgb[1], 3) + ", " + Text(rgb[2], 3);
  };
  std::string text = "metallic " + Text(Rounded(material.base_metalness), 3) + ", roughness " +
                     Text(material.specular_roughness, 3) + " (GGX alpha " +
                     Text(std::pow(material.specular_roughness, 2), 3) + "), base colour " +
                     color(material.base_color);
  const Json extensions = ExtensionsOf(material);
  for (const Json& values : extensions) {
    for (const auto& [key, value] : values.items()) text += ", " + key + " " + value.dump();
  }
  return text;
}

}  // namespace trilobe
