#include "trilobe/scene/scene_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "trilobe/base/error.h"
#include "trilobe/base/nearest_name.h"
#include "trilobe/io/file.h"
#include "trilobe/io/source.h"

namespace trilobe {
namespace {

using Json = nlohmann::json;

constexpr const char* kFormat = "trilobe-scene";
constexpr int kVersion = 1;
constexpr size_t kMaxNameSize = 100;

std::string Quoted(const std::string& text) { return "'" + text + "'"; }

std::string Text(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

// A value of the file, with the JSON pointer to it (RFC 6901) for messages.
class Node {
 public:
  Node(const Json& json, const std::string& file) : Node(json, Json::json_pointer(), file) {}

  [[noreturn]] void Fail(const std::string& problem) const {
    const std::string pointer = pointer_.to_string();
    throw Error(file_ + ": " + (pointer.empty() ? "/" : pointer) + ": " + problem);
  }

  bool is_string() const { return json_.is_string(); }
  bool Has(const char* key) const { return json_.contains(key); }
  size_t size() const { return json_.size(); }

  Node operator[](const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) Fail("the key '" + std::string(key) + "' is missing; add it");
    return {*found, pointer_ / key, file_};
  }
  Node operator[](size_t index) const { return {json_[index], pointer_ / index, file_}; }

  // Fails unless this is an object with no keys but these.
  const Node& CheckObject(std::initializer_list<std::string_view> known) const {
    if (!json_.is_object()) FailType("an object");
    for (const auto& item : json_.items()) {
      if (std::ranges::find(known, item.key()) != known.end()) continue;
      std::string list;
      for (const std::string_view key : known) {
        list += (list.empty() ? "" : ", ") + std::string(key);
      }
      Node(item.value(), pointer_ / item.key(), file_)
          .Fail("unknown key; did you mean '" + std::string(NearestName(item.key(), known)) +
                "'? Known here: " + list);
    }
    return *this;
  }

  const Node& CheckArray(const std::string& of) const {
    if (!json_.is_array()) FailType("an array of " + of);
    return *this;
  }

  std::string String() const {
    if (!json_.is_string()) FailType("a string");
    return json_.get<std::string>();
  }

  bool Bool() const {
    if (!json_.is_boolean()) FailType("true or false");
    return json_.get<bool>();
  }

  double Number(double min, double max, const std::string& meaning) const {
    if (!json_.is_number()) FailType("a number, " + meaning);
    const double value = json_.get<double>();
    if (!(min <= value && value <= max)) {
      Fail("must be " + meaning + ", from " + Text(min) +
           (std::isfinite(max) ? " to " + Text(max) : " up") + ", not " + json_.dump());
    }
    return value;
  }

  // One of these words.
  std::string Word(const std::vector<std::string_view>& known) const {
    std::string word = String();
    if (std::ranges::find(known, word) != known.end()) return word;
    std::string list;
    for (const std::string_view each : known) {
      list += (list.empty() ? "" : " or ") + Quoted(std::string(each));
    }
    Fail("must be " + list + ", not " + Quoted(word));
  }

 private:
  Node(const Json& json, Json::json_pointer pointer, const std::string& file)
      : json_(json), pointer_(std::move(pointer)), file_(file) {}

  [[noreturn]] void FailType(const std::string& expected) const {
    Fail("must be " + expected + ", not " + json_.type_name());
  }

  const Json& json_;
  Json::json_pointer pointer_;
  const std::string& file_;
};

// Of two members with the same key the parser keeps one, in silence.
class RepeatedKeys {
 public:
  explicit RepeatedKeys(std::string file) : file_(std::move(file)) {}

  bool operator()(int /*depth*/, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_.pop_back();
    if (event == Json::parse_event_t::key &&
        !keys_.back().insert(parsed.get<std::string>()).second) {
      throw Error(file_ + ": the key '" + parsed.get<std::string>() +
                  "' comes twice in the same object; keep one");
    }
    return true;
  }

 private:
  const std::string file_;
  std::vector<std::set<std::string>> keys_;  // of each object that is open
};

Json ParseJson(std::string_view text, const std::string& file) {
  // The parser would take a zero byte for the end of the text, and miss what follows.
  if (const size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw Error(file + ": not a scene file: byte " + std::to_string(zero) + " is zero");
  }
  try {
    return Json::parse(text, RepeatedKeys(file));
  } catch (const Json::exception& exception) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const std::string_view what = exception.what();
    const size_t end = what.find("] ");
    throw Error(file + ": not a scene file: " +
                std::string(what.substr(end == std::string_view::npos ? 0 : end + 2)));
  }
}

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
  if (node.size() == 0) node.Fail("is empty; give at least one direction");
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
    const Direction wo = {std::sin(o) * std::cos(phi), std::sin(o) * std::sin(phi), std::cos(o)};
    list.directions.push_back(ToHalfDiff({wi, wo}));
  }
  return list;
}

DirectionHistogram ReadHistogram(const Node& node, const std::string& scene_file) {
  const std::string path = Beside(scene_file, node.String());
  try {
    return ParseHistogram(ReadFile(path), path);
  } catch (const Error& error) {
    node.Fail(error.what());
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
  node.CheckObject({"relative_rise", "psnr_drop_db", "bytes", "seconds"});
  if (node.size() != 1) {
    node.Fail("must have exactly one of relative_rise, psnr_drop_db, bytes, seconds");
  }
  using Unit = SceneBudget::Unit;
  if (node.Has("relative_rise")) {
    return {Unit::kRelativeRise,
            node["relative_rise"].Number(-1, 1e6, "a fraction of E, 0.01 for 1 %")};
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

// What a material may have of its own, and a scene for all materials that have not.
void ReadLimits(const Node& node, const std::string& scene_file, SceneMaterial* material) {
  if (node.Has("directions")) material->directions = ReadDirections(node["directions"], scene_file);
  if (node.Has("channels")) {
    material->channels = node["channels"].Word({"rgb", "luminance"}) == "rgb"
                             ? SceneChannels::kRgb
                             : SceneChannels::kLuminance;
  }
  if (node.Has("budget")) material->budget = ReadBudget(node["budget"]);
  if (node.Has("leave_out")) ReadReductions(node["leave_out"], &material->reductions);
}

std::string ReadName(const Node& node) {
  std::string name = node.String();
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  if (name.empty() || name.size() > kMaxNameSize || name.front() == '.' ||
      name.find('/') != std::string::npos || std::ranges::any_of(name, is_control)) {
    node.Fail("is the name of a file, too: 1 to " + std::to_string(kMaxNameSize) +
              " bytes, no '/', no control character, no '.' in front");
  }
  // NAME.json is written beside plan.json; some file systems take Plan for plan.
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (lower == "plan") node.Fail("is kept for plan.json; give the material another name");
  return name;
}

std::string ReadSource(const Node& node, const std::string& scene_file) {
  std::string source = node.String();
  if (IsSynthetic(source)) {
    try {
      SynthMaterialOf(source);
    } catch (const Error& error) {
      node.Fail(error.what());
    }
    return source;
  }
  source = Beside(scene_file, source);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored)) {
    node.Fail("there is no file " + Quoted(source) +
              "; give a path relative to the scene file, or synth:NAME");
  }
  return source;
}

SceneMaterial ReadMaterial(const Node& node, const std::string& scene_file,
                           const SceneMaterial& defaults) {
  node.CheckObject({"name", "source", "directions", "channels", "budget", "leave_out"});
  SceneMaterial material = defaults;
  material.name = ReadName(node["name"]);
  material.source = ReadSource(node["source"], scene_file);
  ReadLimits(node, scene_file, &material);
  return material;
}

}  // namespace

Scene ParseScene(std::string_view text, const std::string& path) {
  const Json json = ParseJson(text, path);
  const Node root(json, path);
  root.CheckObject(
      {"format", "version", "directions", "channels", "budget", "leave_out", "materials"});
  root["format"].Word({kFormat});
  root["version"].Number(kVersion, kVersion, "the version of the format that this program reads");
  SceneMaterial defaults;
  ReadLimits(root, path, &defaults);
  const Node materials = root["materials"];
  materials.CheckArray("materials");
  if (materials.size() == 0) materials.Fail("is empty; give at least one material");
  Scene scene{path, {}};
  std::set<std::string> names;
  for (size_t k = 0; k < materials.size(); ++k) {
    scene.materials.push_back(ReadMaterial(materials[k], path, defaults));
    const std::string& name = scene.materials.back().name;
    if (!names.insert(name).second) {
      materials[k]["name"].Fail(Quoted(name) +
                                " is the name of another material; give each its own");
    }
  }
  return scene;
}

std::vector<std::string> FilesOf(const Scene& scene) {
  std::vector<std::string> files = {scene.path};
  for (const SceneMaterial& material : scene.materials) {
    if (!IsSynthetic(material.source)) files.push_back(material.source);
    const auto* const histogram = std::get_if<DirectionHistogram>(&material.directions);
    if (histogram != nullptr) files.push_back(histogram->source);
  }
  return files;
}

Scene ReadScene(const std::string& path) { return ParseScene(ReadFile(path), path); }

}  // namespace trilobe
