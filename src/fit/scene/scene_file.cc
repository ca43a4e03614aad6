#include "fit/scene/scene_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

#include "core/base/names.h"
#include "core/base/text.h"
#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/fit_option.h"
#include "io/formats/source_option.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/load_model.h"

namespace trilobe {
namespace {

constexpr const char* kFormat = "trilobe-scene";
constexpr int kVersion = 1;
constexpr size_t kMaxNameSize = 100;

std::string Quoted(const std::string& text) { return "'" + text + "'"; }

// A key as a JSON pointer has it (RFC 6901).
std::string Escaped(std::string_view key) {
  std::string escaped;
  for (const char c : key) escaped += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return escaped;
}

// A value of the file, with the JSON pointer to it for messages.
class Node {
 public:
  Node(const JsonValue& json, std::string pointer, const std::string& file)
      : json_(json), pointer_(std::move(pointer)), file_(file) {}

  // Throws Error about the pointer.
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kRange,
                         std::string_view value = "") const {
    const std::string pointer = pointer_.empty() ? "/" : pointer_;
    throw ErrorIn(kind, file_, pointer + ": " + problem).About(pointer, value);
  }

  bool is_string() const { return json_.type() == Type::kString; }
  bool is_boolean() const { return json_.type() == Type::kBoolean; }
  bool is_number() const { return json_.type() == Type::kNumber; }
  bool Has(const char* key) const { return json_.Find(key) != nullptr; }
  size_t size() const { return json_.size(); }

  Node operator[](const char* key) const {
    const JsonValue* const found = json_.Find(key);
    if (found == nullptr) {
      Fail("the key '" + std::string(key) + "' is missing; add it", ErrorKind::kMissing, key);
    }
    return {*found, pointer_ + "/" + key, file_};
  }
  Node operator[](size_t index) const {
    return {json_[index], pointer_ + "/" + std::to_string(index), file_};
  }

  // Fails unless this is an object with no keys but these.
  const Node& CheckObject(const std::vector<std::string_view>& known) const {
    CheckType(Type::kObject, "an object");
    for (size_t k = 0; k < size(); ++k) {
      const std::string key = json_.key(k);
      if (std::ranges::find(known, key) != known.end()) continue;
      std::string list;
      for (const std::string_view each : known) {
        list += (list.empty() ? "" : ", ") + std::string(each);
      }
      Node(json_[k], pointer_ + "/" + Escaped(key), file_)
          .Fail("unknown key; did you mean '" + std::string(NearestName(key, known)) +
                    "'? Known here: " + list,
                ErrorKind::kUnknown, key);
    }
    return *this;
  }

  const Node& CheckArray(const std::string& what) const {
    CheckType(Type::kArray, "an array of " + what);
    return *this;
  }

  std::string String() const {
    CheckType(Type::kString, "a string");
    return json_.string();
  }

  bool Bool() const {
    CheckType(Type::kBoolean, "true or false");
    return json_.boolean();
  }

  double Number(double min, double max, const std::string& meaning) const {
    CheckType(Type::kNumber, "a number, " + meaning);
    const double value = json_.number();
    if (!(min <= value && value <= max)) {
      Fail("must be " + meaning + ", from " + Text(min, 6) +
               (std::isfinite(max) ? " to " + Text(max, 6) : " up") + ", not " + NumberText(),
           ErrorKind::kRange, NumberText());
    }
    return value;
  }

  // The number's text, as it stands in the file.
  std::string NumberText() const { return std::string(json_.number_text()); }

  // The string, which must be one of these words.
  std::string Word(const std::vector<std::string_view>& known) const {
    std::string word = String();
    if (std::ranges::find(known, word) != known.end()) return word;
    std::string list;
    for (const std::string_view each : known) {
      list += (list.empty() ? "" : " or ") + Quoted(std::string(each));
    }
    Fail("must be " + list + ", not " + Quoted(word), ErrorKind::kUnknown, word);
  }

 private:
  using Type = JsonValue::Type;

  void CheckType(Type type, const std::string& expected) const {
    if (json_.type() != type) {
      Fail("must be " + expected + ", not " + json_.type_name(), ErrorKind::kFormat,
           json_.type_name());
    }
  }

  const JsonValue& json_;
  std::string pointer_;
  const std::string& file_;
};

constexpr const char* kNotAScene = "not a scene file";

std::string Beside(const std::string& scene_file, const std::string& path) {
  return (std::filesystem::path(scene_file).parent_path() / path).string();
}

DirectionRanges::Range ReadRange(const Node& node) {
  const auto degrees = [&](size_t index) {
    return node[index].Number(0, 90, "a polar angle in degrees");
  };
  node.CheckArray("two angles");
  if (node.size() != 2) node.Fail("must have two angles, the smallest and the largest, in degrees");
  const double min = degrees(0), max = degrees(1);
  if (min > max) node.Fail("must begin with the smaller angle; exchange the two");
  return {DegreesToRadians(min), DegreesToRadians(max)};
}

DirectionList ReadList(const Node& node) {
  node.CheckArray("directions");
  if (node.size() == 0) node.Fail("is empty; give at least one direction", ErrorKind::kMissing);
  DirectionList list;
  for (size_t k = 0; k < node.size(); ++k) {
    const Node entry = node[k].CheckObject({"theta_i", "theta_o", "phi"});
    // At 90 degrees there is no reflection, and the two directions may be opposite.
    const auto polar = [&](const char* key) {
      return DegreesToRadians(entry[key].Number(0, 89.99, "a polar angle in degrees"));
    };
    const double i = polar("theta_i"), o = polar("theta_o");
    const double phi = DegreesToRadians(
        entry["phi"].Number(-360, 360, "an azimuth in degrees, that of o less that of i"));
    const Direction wi = {std::sin(i), 0, std::cos(i)};
    const Direction wo = ToDirection({o, phi});
    list.directions.push_back(ToHalfDiff({wi, wo}));
  }
  return list;
}

DirectionHistogram ReadHistogram(const Node& node, const std::string& scene_file) {
  const std::string path = Beside(scene_file, node.String());
  try {
    return ParseHistogram(ReadFile(path), path);
  } catch (const Error& error) {
    node.Fail(error.what(), error.kind(), error.facts().value);
  }
}

SceneDirections ReadDirections(const Node& node, const std::string& scene_file) {
  if (node.is_string()) {
    node.Word({"all"});
    return AllDirections();
  }
  node.CheckObject({"theta_i", "theta_o", "list", "histogram"});
  const bool ranges = node.Has("theta_i") || node.Has("theta_o");
  if (int{ranges} + int{node.Has("list")} + int{node.Has("histogram")} != 1) {
    node.Fail("must have one of: theta_i and theta_o, list, histogram; or be \"all\"");
  }
  if (node.Has("list")) return ReadList(node["list"]);
  if (node.Has("histogram")) return ReadHistogram(node["histogram"], scene_file);
  DirectionRanges both;
  if (node.Has("theta_i")) both.theta_i = ReadRange(node["theta_i"]);
  if (node.Has("theta_o")) both.theta_o = ReadRange(node["theta_o"]);
  return both;
}

SceneBudget ReadBudget(const Node& node) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  node.CheckObject(
      {"mean_delta_e", "sphere_psnr_db", "relative_rise", "psnr_drop_db", "bytes", "seconds"});
  if (node.size() != 1) {
    node.Fail(
        "must have exactly one of mean_delta_e, sphere_psnr_db, relative_rise, psnr_drop_db, "
        "bytes, seconds");
  }
  using Unit = SceneBudget::Unit;
  if (node.Has("relative_rise")) {
    return {Unit::kRelativeRise,
            node["relative_rise"].Number(-1, 1e6, "a fraction of E, 0.01 for 1 %")};
  }
  if (node.Has("mean_delta_e")) {
    return {Unit::kMeanDeltaE, node["mean_delta_e"].Number(0, 100, "a mean difference in CIELAB")};
  }
  if (node.Has("sphere_psnr_db")) {
    return {Unit::kSpherePsnr, node["sphere_psnr_db"].Number(0, 1e3, "decibels")};
  }
  if (node.Has("psnr_drop_db")) {
    return {Unit::kPsnrDrop, node["psnr_drop_db"].Number(-1e3, 1e3, "decibels")};
  }
  if (node.Has("bytes")) return {Unit::kBytes, node["bytes"].Number(8, kInfinity, "bytes")};
  return {Unit::kSeconds, node["seconds"].Number(0, kInfinity, "seconds")};
}

void ReadReductions(const Node& node, SceneReductions* reductions) {
  node.CheckObject({"lobes", "colour", "shadowing", "tables", "samples"});
  const auto read = [&](const char* key, bool* on) {
    if (node.Has(key)) *on = node[key].Bool();
  };
  read("lobes", &reductions->lobes);
  read("colour", &reductions->colour);
  read("shadowing", &reductions->shadowing);
  read("tables", &reductions->tables);
  read("samples", &reductions->samples);
}

// The text that a flag would have.
std::string FlagText(const Node& node) {
  if (node.is_boolean()) return node.Bool() ? "true" : "false";
  return node.is_number() ? node.NumberText() : node.String();
}

// Takes those options of a table of rows that the node has. Throws Error about the option where its
// text or `check` does.
template <typename Options, typename Row>
void ReadOptionsOf(const Node& node, const std::vector<Row>& rows, void (*check)(const Options&),
                   std::map<std::string, std::string>* options) {
  for (const Row& option : rows) {
    if (!node.Has(option.name.c_str())) continue;
    const Node value = node[option.name.c_str()];
    try {
      Options tried;
      option.set(FlagText(value), &tried);
      check(tried);
    } catch (const Error& error) {
      value.Fail(error.what(), error.kind(), error.facts().value);
    }
    (*options)[option.name] = FlagText(value);
  }
}

void ReadOptions(const Node& node, std::map<std::string, std::string>* options) {
  std::vector<std::string_view> known;
  for (const SourceOption& option : AllSourceOptions()) known.push_back(option.name);
  for (const FitOption& option : AllFitOptions()) {
    if (option.of_scenes) known.push_back(option.name);
  }
  node.CheckObject(known);
  ReadOptionsOf(node, AllSourceOptions(), CheckSourceOptions, options);
  ReadOptionsOf(node, AllFitOptions(), CheckFitOptions, options);
}

// Reads members that a material may have of its own, and a scene for all materials without.
void ReadLimits(const Node& node, const std::string& scene_file, SceneMaterial* material) {
  if (node.Has("directions")) material->directions = ReadDirections(node["directions"], scene_file);
  if (node.Has("channels")) {
    material->channels = node["channels"].Word({"rgb", "luminance"}) == "rgb"
                             ? SceneChannels::kRgb
                             : SceneChannels::kLuminance;
  }
  if (node.Has("budget")) material->budget = ReadBudget(node["budget"]);
  if (node.Has("leave_out")) ReadReductions(node["leave_out"], &material->reductions);
  if (node.Has("options")) ReadOptions(node["options"], &material->options);
}

std::string LowerCase(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string ReadName(const Node& node) {
  std::string name = node.String();
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  if (name.empty() || name.size() > kMaxNameSize || name.front() == '.' ||
      name.find('/') != std::string::npos || std::ranges::any_of(name, is_control)) {
    node.Fail("is the name of a file, too: 1 to " + std::to_string(kMaxNameSize) +
                  " bytes, no '/', no control character, no '.' in front",
              ErrorKind::kFormat, name);
  }
  // NAME.json is written beside plan.json; some file systems take Plan for plan.
  if (LowerCase(name) == "plan") {
    node.Fail("is kept for plan.json; give the material another name", ErrorKind::kConflict, name);
  }
  return name;
}

std::string ReadSource(const Node& node, const std::string& scene_file) {
  std::string source = node.String();
  if (IsSynthetic(source)) {
    try {
      SynthSourceOf(source);
    } catch (const Error& error) {
      node.Fail(error.what(), error.kind(), error.facts().value);
    }
    return source;
  }
  if (IsMaterial(source)) {
    try {
      MaterialText(source);
    } catch (const Error& error) {
      node.Fail(error.what(), error.kind(), error.facts().value);
    }
    return source;
  }
  source = Beside(scene_file, source);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored)) {
    node.Fail("there is no file " + Quoted(source) +
                  "; give a path relative to the scene file, synth:NAME or material:NAME",
              ErrorKind::kFile, source);
  }
  return source;
}

SceneMaterial ReadMaterial(const Node& node, const std::string& scene_file,
                           const SceneMaterial& defaults) {
  node.CheckObject({"name", "source", "directions", "channels", "budget", "leave_out", "options"});
  SceneMaterial material = defaults;
  material.name = ReadName(node["name"]);
  material.source = ReadSource(node["source"], scene_file);
  ReadLimits(node, scene_file, &material);
  return material;
}

}  // namespace

Scene ParseScene(std::string_view text, const std::string& path) {
  const JsonValue json = JsonValue::Parse(text, path, kNotAScene);
  const Node root(json, "", path);
  root.CheckObject({"format", "version", "directions", "channels", "budget", "leave_out", "options",
                    "materials"});
  root["format"].Word({kFormat});
  root["version"].Number(kVersion, kVersion, "the version of the format that this program reads");
  SceneMaterial defaults;
  ReadLimits(root, path, &defaults);
  const Node materials = root["materials"];
  materials.CheckArray("materials");
  if (materials.size() == 0) {
    materials.Fail("is empty; give at least one material", ErrorKind::kMissing);
  }
  Scene scene{path, {}};
  std::map<std::string, std::string> name_of;  // by the file, where case does not count
  for (size_t k = 0; k < materials.size(); ++k) {
    scene.materials.push_back(ReadMaterial(materials[k], path, defaults));
    const std::string& name = scene.materials.back().name;
    const auto [other, is_new] = name_of.emplace(LowerCase(name), name);
    if (is_new) continue;
    materials[k]["name"].Fail(
        Quoted(name) +
        (other->second == name ? " is the name of another material"
                               : " and " + Quoted(other->second) +
                                     ", another material, are one file where case does not count") +
        "; give each its own");
  }
  return scene;
}

std::vector<std::string> FilesOf(const Scene& scene) {
  std::vector<std::string> files = {scene.path};
  for (const SceneMaterial& material : scene.materials) {
    const std::string& source = material.source;
    if (!IsSynthetic(source) && !IsMaterial(source)) files.push_back(source);
    const auto* const histogram = std::get_if<DirectionHistogram>(&material.directions);
    if (histogram != nullptr) files.push_back(histogram->source);
  }
  return files;
}

namespace {

template <typename Row, typename Options>
Options WithOptions(const std::map<std::string, std::string>& own, const std::vector<Row>& rows,
                    Options options) {
  for (const Row& option : rows) {
    const auto text = own.find(option.name);
    if (text != own.end()) option.set(text->second, &options);
  }
  return options;
}

}  // namespace

SourceOptions WithOptionsOf(const SceneMaterial& material, SourceOptions options) {
  return WithOptions(material.options, AllSourceOptions(), std::move(options));
}

FitOptions WithOptionsOf(const SceneMaterial& material, FitOptions options) {
  return WithOptions(material.options, AllFitOptions(), std::move(options));
}

Scene ReadScene(const std::string& path) {
  CheckMayBeJson(BeginningOf(path), path, kNotAScene);
  return ParseScene(ReadJsonText(path, kNotAScene), path);
}

}  // namespace trilobe
