#include "fit/export/open_pbr.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
namespace {

constexpr int kCosines = 16;  // of albedos: (k + 1/2) / 16

// Fresnel reflectance of an interface for unpolarised light from outside.
double DielectricFresnel(double cosine, double ior) {
  const double sin2 = 1 - cosine * cosine;
  const double below = std::sqrt(std::max(ior * ior - sin2, 0.0));
  const double across = (cosine - below) / (cosine + below);
  const double along = (ior * ior * cosine - below) / (ior * ior * cosine + below);
  return (across * across + along * along) / 2;
}

// Schlick's from f0 to 1, times `tint` at the angle whose cosine is 1/7 (Kutz et al. 2021).
double MetalFresnel(double cosine, double f0, double tint) {
  constexpr double kCosine = 1.0 / 7;
  const auto fifth = [](double x) { return x * x * x * x * x; };
  const auto schlick = [&](double c) { return f0 + (1 - f0) * fifth(1 - c); };
  const double lack =
      schlick(kCosine) * (1 - tint) / (kCosine * fifth(1 - kCosine) * (1 - kCosine));
  return std::max(schlick(cosine) - lack * cosine * fifth(1 - cosine) * (1 - cosine), 0.0);
}

// EON: of a color c it is single c + again c^2 / (1 - c (1 - average)).
struct Diffuse {
  double single = 0, again = 0, average = 1;

  double Value(double color) const {
    return single * color + again * color * color / (1 - color * (1 - average));
  }
};
Diffuse DiffuseAt(double roughness, const DirectionPair& pair) {
  constexpr double kSingle = 0.5 - 2 / (3 * kPi), kAverage = 2.0 / 3 - 28 / (15 * kPi);
  const double cos_i = pair.wi[2], cos_o = pair.wo[2];
  if (!(roughness > 0)) return {.single = 1 / kPi};
  const double s = Dot(pair.wi, pair.wo) - cos_i * cos_o;
  const double ratio = s > 0 ? s / std::max(cos_i, cos_o) : s;
  const double a = 1 / (1 + kSingle * roughness);
  const auto albedo = [&](double cosine) {
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    const double g = sine * (std::acos(std::min(cosine, 1.0)) - sine * cosine) +
                     2.0 / 3 * (sine / cosine * (1 - sine * sine * sine) - sine);
    return a * (1 + roughness * g / kPi);
  };
  const double average = a * (1 + kAverage * roughness);
  const double lost = std::max(1 - average, 1e-9);
  return {.single = a * (1 + roughness * ratio) / kPi,
          .again = average / kPi * (1 - albedo(cos_i)) * (1 - albedo(cos_o)) / lost,
          .average = average};
}

std::string ColorText(const Rgb& rgb) {
  return Text(rgb[0]) + ", " + Text(rgb[1]) + ", " + Text(rgb[2]);
}

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

double OpenPbrBrdf::At(const std::vector<double>& table, double cosine) {
  const double x = std::clamp(cosine * kCosines - 0.5, 0.0, kCosines - 1.0);
  const int k = std::min(static_cast<int>(x), kCosines - 2);
  return table[k] + (x - k) * (table[k + 1] - table[k]);
}

// Integrates over half vectors drawn from the visible ones (Heitz 2018), whose weights are
// F G2 / G1, the mean over both axes.
void OpenPbrBrdf::Ggx::SetTables() {
  constexpr int kAcross = 8, kAround = 6;
  const double alpha = std::sqrt(alpha_x * alpha_y), alpha2 = alpha * alpha;
  whole.assign(kCosines, 0.0);
  dielectric.assign(kCosines, 0.0);
  for (int k = 0; k < kCosines; ++k) {
    const double cosine = (k + 0.5) / kCosines, sine = std::sqrt(1 - cosine * cosine);
    // The hemisphere of configurations: wo stretched, and an orthogonal frame about it.
    const double length = std::hypot(alpha * sine, cosine);
    const Direction v = {alpha * sine / length, 0, cosine / length};
    const Direction across = {0, 1, 0}, along = {v[2], 0, -v[0]};
    for (int j = 0; j < kAcross * kAround; ++j) {
      const int ring = j / kAround, step = j % kAround;
      const double r = std::sqrt((ring + 0.5) / kAcross);
      const double phi = 2 * kPi * (step + 0.5) / kAround;
      const double t1 = r * std::cos(phi), s = 0.5 * (1 + v[2]);
      const double t2 = (1 - s) * std::sqrt(1 - t1 * t1) + s * r * std::sin(phi);
      const double t3 = std::sqrt(std::max(1 - t1 * t1 - t2 * t2, 0.0));
      Direction h{};
      for (int axis = 0; axis < 3; ++axis) {
        h[axis] = t1 * across[axis] - t2 * along[axis] + t3 * v[axis];
      }
      h[0] *= alpha;
      h[1] *= alpha;
      h[2] = std::max(h[2], 1e-9);
      const double h_length = std::hypot(h[0], h[1], h[2]);
      for (double& x : h) x /= h_length;
      const double cos_d = sine * h[0] + cosine * h[2];
      const double cos_i = 2 * cos_d * h[2] - cosine;
      if (!(cos_i > 0) || !(cos_d > 0)) continue;
      const auto lambda = [&](double c) {
        return (std::sqrt(1 + alpha2 * (1 - c * c) / (c * c)) - 1) / 2;
      };
      const double weight = (1 + lambda(cosine)) / (1 + lambda(cosine) + lambda(cos_i));
      whole[k] += weight / (kAcross * kAround);
      dielectric[k] += weight * DielectricFresnel(cos_d, ior) / (kAcross * kAround);
    }
  }
}

double OpenPbrBrdf::Ggx::Value(const DirectionPair& pair, const Direction& half) const {
  const double x = half[0] / alpha_x, y = half[1] / alpha_y;
  const double q = x * x + y * y + half[2] * half[2];
  const double d = 1 / (kPi * alpha_x * alpha_y * q * q);
  const auto lambda = [&](const Direction& w) {
    const double wx = alpha_x * w[0], wy = alpha_y * w[1];
    return (std::sqrt(1 + (wx * wx + wy * wy) / (w[2] * w[2])) - 1) / 2;
  };
  return d / (1 + lambda(pair.wi) + lambda(pair.wo)) / (4 * pair.wi[2] * pair.wo[2]);
}

TangentFrame ToTangentFrame(const DirectionPair& pair, double cos_turn, double sin_turn) {
  const auto turned = [&](const Direction& w) {
    return Direction{cos_turn * w[0] + sin_turn * w[1], cos_turn * w[1] - sin_turn * w[0], w[2]};
  };
  const DirectionPair at = {turned(pair.wi), turned(pair.wo)};
  Direction half = {at.wi[0] + at.wo[0], at.wi[1] + at.wo[1], at.wi[2] + at.wo[2]};
  const double length = std::hypot(half[0], half[1], half[2]);
  for (double& x : half) x /= length;
  return {at, half};
}

double RoughnessThroughCoat(const OpenPbr& parameters) {
  const double base = std::pow(parameters.specular_roughness, 4);
  const double through =
      std::pow(std::min(base + 2 * std::pow(parameters.coat_roughness, 4), 1.0), 0.25);
  return parameters.specular_roughness +
         parameters.coat_weight * (through - parameters.specular_roughness);
}

OpenPbrBrdf::OpenPbrBrdf(const OpenPbr& parameters)
    : parameters_(parameters),
      cos_turn_(std::cos(parameters.turn)),
      sin_turn_(std::sin(parameters.turn)) {
  const double roughness = RoughnessThroughCoat(parameters);
  constexpr double kLeast = 1e-4;
  const double anisotropy = 1 - parameters.specular_roughness_anisotropy;
  specular_.alpha_x =
      std::max(roughness * roughness * std::sqrt(2 / (1 + anisotropy * anisotropy)), kLeast);
  specular_.alpha_y = std::max(anisotropy * specular_.alpha_x, kLeast);
  specular_.ior = parameters.specular_ior;
  specular_.SetTables();
  coat_.alpha_x = coat_.alpha_y =
      std::max(parameters.coat_roughness * parameters.coat_roughness, kLeast);
  coat_.ior = parameters.coat_ior;
  coat_.SetTables();
}

Rgb OpenPbrBrdf::operator()(const DirectionPair& pair) const {
  if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) return {};
  const auto [at, half] = ToTangentFrame(pair, cos_turn_, sin_turn_);
  const double cos_d = std::clamp(Dot(at.wi, half), 0.0, 1.0), cos_o = at.wo[2];

  // 1 + F0 (1 - E) / E, E what is reflected where F is 1.
  const auto again = [&](const Ggx& ggx, double f0) {
    const double whole = std::clamp(At(ggx.whole, cos_o), 0.05, 1.0);
    return 1 + f0 * (1 - whole) / whole;
  };
  const auto f0_of = [](double ior) { return (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1)); };

  const OpenPbr& p = parameters_;
  const double specular = specular_.Value(at, half);
  const double f0 = f0_of(p.specular_ior), specular_again = again(specular_, f0);
  const double dielectric = specular * DielectricFresnel(cos_d, p.specular_ior) * specular_again;
  const double below_specular = 1 - std::min(At(specular_.dielectric, cos_o) * specular_again, 1.0);
  double coat = 0, below_coat = 1;
  if (p.coat_weight > 0) {
    const double coat_again = again(coat_, f0_of(p.coat_ior));
    coat =
        p.coat_weight * coat_.Value(at, half) * DielectricFresnel(cos_d, p.coat_ior) * coat_again;
    below_coat = 1 - p.coat_weight * std::min(At(coat_.dielectric, cos_o) * coat_again, 1.0);
  }
  const Diffuse diffuse = DiffuseAt(p.base_diffuse_roughness, at);
  Rgb value{};
  for (int c = 0; c < kChannels; ++c) {
    const double metal = specular * MetalFresnel(cos_d, p.base_color[c], p.specular_color[c]) *
                         again(specular_, p.base_color[c]);
    const double glossy =
        p.specular_color[c] * dielectric + below_specular * diffuse.Value(p.base_color[c]);
    value[c] = coat + below_coat * (glossy + p.base_metalness * (metal - glossy));
  }
  return value;
}

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
  return JsonText(json, 2) + "\n";
}

}  // namespace trilobe
