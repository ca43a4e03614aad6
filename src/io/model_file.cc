#include "trilobe/io/model_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <type_traits>
#include <utility>

#include "trilobe/base/error.h"
#include "trilobe/io/file.h"

namespace trilobe {
namespace {

// Keys are looked up in a sorted map when read, where a hostile file may have millions of them, and
// written in the order in which a person wants to see them.
using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kFormat = "trilobe-model";
constexpr int kVersion = 1;
constexpr const char* kKind = "isotropic";

// A value of the file with the way to it, such as `D[2][17]`, for messages.
class Node {
 public:
  Node(const Json& json, std::string key, const std::string& source)
      : json_(json), key_(std::move(key)), source_(source) {}

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(source_ + ": key '" + key_ + "' " + problem);
  }

  bool has(const std::string& key) const { return json_.contains(key); }

  Node operator[](const std::string& key) const {
    const std::string path = key_.empty() ? key : key_ + "." + key;
    const auto found = json_.find(key);
    if (found == json_.end()) Node(json_, path, source_).Fail("is missing");
    return {*found, path, source_};
  }

  Node operator[](size_t index) const {
    return {json_[index], key_ + "[" + std::to_string(index) + "]", source_};
  }

  const Node& CheckObject() const {
    if (!json_.is_object()) Fail(std::string("must be an object, not ") + json_.type_name());
    return *this;
  }

  size_t ArraySize() const {
    if (!json_.is_array()) Fail(std::string("must be an array, not ") + json_.type_name());
    return json_.size();
  }

  void CheckArraySize(size_t size) const {
    if (ArraySize() != size) {
      Fail("must have " + std::to_string(size) + " entries, not " + std::to_string(json_.size()));
    }
  }

  double Number() const {
    if (!json_.is_number()) Fail(std::string("must be a number, not ") + json_.type_name());
    const double value = json_.get<double>();
    if (!std::isfinite(value) || value < 0) Fail("must be finite and >= 0, not " + json_.dump());
    return value;
  }

  int Integer(int max) const {
    const double value = Number();
    if (!json_.is_number_integer() || value > max) {
      Fail("must be an integer from 0 to " + std::to_string(max) + ", not " + json_.dump());
    }
    return json_.get<int>();
  }

  bool Bool() const {
    if (!json_.is_boolean()) Fail(std::string("must be true or false, not ") + json_.type_name());
    return json_.get<bool>();
  }

  std::string String() const {
    if (!json_.is_string()) Fail(std::string("must be a string, not ") + json_.type_name());
    return json_.get<std::string>();
  }

  bool is_object() const { return json_.is_object(); }

  void Numbers(std::span<double> values) const {
    CheckArraySize(values.size());
    for (size_t k = 0; k < values.size(); ++k) values[k] = (*this)[k].Number();
  }

 private:
  const Json& json_;
  std::string key_;
  const std::string& source_;
};

TableSharing& Sharing(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->D : factor == Factor::kF ? spec->F : spec->G;
}

int& TableSize(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->d_bins : factor == Factor::kF ? spec->f_bins : spec->g_nodes;
}

// The tables of one factor in the order of their numbers, out of their nest of lobes and channels.
std::vector<Node> TableNodes(const Node& nest, const TableSharing& sharing, int lobes) {
  std::vector<Node> nodes = {nest};
  const auto unfold = [&nodes](size_t size) {
    std::vector<Node> inner;
    for (const Node& node : nodes) {
      node.CheckArraySize(size);
      for (size_t k = 0; k < size; ++k) inner.push_back(node[k]);
    }
    nodes = std::move(inner);
  };
  // Without a lobe there is no table, and the nest is [] at whichever level comes first.
  if (sharing.per_lobe || lobes == 0) unfold(lobes);
  if (sharing.per_channel) unfold(kChannels);
  return nodes;
}

// The inverse: tables by their numbers, nested.
OrderedJson Nest(const std::vector<OrderedJson>& tables, const TableSharing& sharing, int lobes) {
  if (lobes == 0) return OrderedJson::array();
  OrderedJson nest = OrderedJson::array();
  const size_t channels = sharing.per_channel ? kChannels : 1;
  for (size_t begin = 0; begin < tables.size(); begin += channels) {
    const std::vector<OrderedJson> group(tables.begin() + begin, tables.begin() + begin + channels);
    nest.push_back(sharing.per_channel ? OrderedJson(group) : group[0]);
  }
  return sharing.per_lobe ? nest : nest[0];
}

void ReadSharing(const Node& root, ModelSpec* spec) {
  if (!root.has("sharing")) return;
  const Node node = root["sharing"].CheckObject();
  for (const Factor factor : kFactors) {
    const Node entry = node[FactorName(factor)].CheckObject();
    Sharing(factor, spec) = {.per_lobe = entry["per_lobe"].Bool(),
                             .per_channel = entry["per_channel"].Bool()};
  }
}

// Entries of a table: those that the file lists, or, where it lists nodes, as many as it says.
size_t TableEntries(const Node& table) {
  if (!table.is_object()) return table.ArraySize();
  return table["size"].Integer(kMaxTableSize);
}

// The shape of the model, bounded before anything is allocated.
ModelSpec ReadSpec(const Node& root) {
  ModelSpec spec;
  spec.lobes = root["lobes"].Integer(kMaxLobes);
  ReadSharing(root, &spec);
  for (const Factor factor : kFactors) {
    const std::vector<Node> tables =
        TableNodes(root[FactorName(factor)], spec.sharing(factor), spec.lobes);
    if (tables.empty()) continue;
    const size_t size = TableEntries(tables[0]);
    if (size < 4 || size > kMaxTableSize) {
      tables[0].Fail("must have at least 4 and at most " + std::to_string(kMaxTableSize) +
                     " entries, not " + std::to_string(size));
    }
    for (const Node& table : tables) {
      if (!table.is_object()) {
        table.CheckArraySize(size);
      } else if (TableEntries(table) != size) {
        table["size"].Fail("must be " + std::to_string(size) + ", as in the first table");
      }
    }
    TableSize(factor, &spec) = static_cast<int>(size);
  }
  return spec;
}

// A number for each channel, or one for all.
bool ReadChannels(const Node& node, std::span<double> values) {
  const bool coloured = node.ArraySize() != 1;
  node.Numbers(coloured ? values : values.first(1));
  return coloured;
}

// The nodes of a table, whose numbers go to their entries.
std::vector<int> ReadTable(const Node& node, std::span<double> table) {
  std::vector<int> entries;
  if (!node.is_object()) {
    node.Numbers(table);
    for (size_t k = 0; k < table.size(); ++k) entries.push_back(static_cast<int>(k));
    return entries;
  }
  const Node nodes = node["nodes"], values = node["values"];
  if (nodes.ArraySize() == 0) nodes.Fail("must have at least one entry");
  values.CheckArraySize(nodes.ArraySize());
  for (size_t k = 0; k < nodes.ArraySize(); ++k) {
    const int entry = nodes[k].Integer(static_cast<int>(table.size()) - 1);
    if (k > 0 && entry <= entries.back()) nodes[k].Fail("must be above the one before it");
    entries.push_back(entry);
    table[entry] = values[k].Number();
  }
  return entries;
}

// Sets file->model, and the layout of a compact file.
void ReadNumbers(const Node& root, ModelFile* file) {
  FactorModel& model = file->model = FactorModel(ReadSpec(root));
  const ModelSpec& spec = model.spec();
  TableLayout layout = TableLayout::Full(spec);
  layout.coloured_d = ReadChannels(root["d"], model.d());
  root["s"].CheckArraySize(spec.lobes);
  for (int m = 0; m < spec.lobes; ++m) {
    const bool coloured = ReadChannels(root["s"][m], model.s(m));
    if (m > 0 && coloured != layout.coloured_s) {
      root["s"][m].Fail("must have as many entries as the others");
    }
    layout.coloured_s = coloured;
  }
  for (const Factor factor : kFactors) {
    const std::vector<Node> tables =
        TableNodes(root[FactorName(factor)], spec.sharing(factor), spec.lobes);
    for (int k = 0; k < static_cast<int>(tables.size()); ++k) {
      layout.of(factor, k) = ReadTable(tables[k], model.table(factor, k));
    }
  }
  if (layout == TableLayout::Full(spec)) return;
  ExpandStored(layout, &model);
  file->layout = std::move(layout);
}

std::vector<bool> ReadDead(const Node& root, const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  std::vector<bool> dead(spec.num_parameters(), false);
  if (!root.has("dead")) return dead;
  const Node node = root["dead"].CheckObject();
  for (const Factor factor : kFactors) {
    const Node lists = node[FactorName(factor)];
    lists.CheckArraySize(spec.num_tables(factor));
    for (int table = 0; table < spec.num_tables(factor); ++table) {
      const Node list = lists[table];
      for (size_t k = 0; k < list.ArraySize(); ++k) {
        const int entry = list[k].Integer(spec.table_size(factor) - 1);
        dead[model.TableOffset(factor, table) + entry] = true;
      }
    }
  }
  return dead;
}

// Calls visit(key, member) for every member: the one list that reading and writing share.
template <typename Info, typename Visitor>
void VisitFitInfo(Info* fit, const Visitor& visit) {
  visit("solver", &fit->solver);
  visit("init", &fit->init);
  visit("weighting", &fit->weighting);
  visit("objective", &fit->objective);
  visit("initial_objective", &fit->initial_objective);
  visit("stop_reason", &fit->stop_reason);
  visit("iterations", &fit->iterations);
  visit("seconds", &fit->seconds);
  visit("threads", &fit->threads);
  visit("source", &fit->source);
  visit("valid_samples", &fit->valid_samples);
  visit("program", &fit->program);
  visit("date", &fit->date);
}

void Read(const Node& node, std::string* value) { *value = node.String(); }
void Read(const Node& node, double* value) { *value = node.Number(); }
void Read(const Node& node, int* value) { *value = node.Integer(std::numeric_limits<int>::max()); }

// What a file does not say stays unknown.
FitInfo ReadFitInfo(const Node& root) {
  FitInfo fit;
  if (!root.has("fit")) return fit;
  const Node node = root["fit"].CheckObject();
  VisitFitInfo(&fit, [&](const std::string& key, auto* value) {
    if (node.has(key)) Read(node[key], value);
  });
  return fit;
}

Json ParseJson(std::string_view text, const std::string& source) {
  // The parser would take a zero byte for the end of the text, and miss what follows.
  if (const size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw Error(source + ": not a model file: byte " + std::to_string(zero) + " is zero");
  }
  try {
    return Json::parse(text);
  } catch (const Json::exception& exception) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    const std::string_view what = exception.what();
    const size_t end = what.find("] ");
    throw Error(source + ": not a model file: " +
                std::string(what.substr(end == std::string_view::npos ? 0 : end + 2)));
  }
}

OrderedJson FiniteNumbers(std::span<const double> values, const char* key) {
  for (const double value : values) {
    if (!std::isfinite(value) || value < 0) {
      throw Error("cannot store the model: '" + std::string(key) + "' has the entry " +
                  std::to_string(value) + "; all must be finite and >= 0");
    }
  }
  return OrderedJson(std::vector<double>(values.begin(), values.end()));
}

// The first alone where it stands for all.
OrderedJson ChannelsToJson(std::span<const double> values, bool coloured, const char* key) {
  return FiniteNumbers(coloured ? values : values.first(1), key);
}

OrderedJson TablesToJson(const FactorModel& model, const TableLayout& layout, Factor factor) {
  const ModelSpec& spec = model.spec();
  std::vector<OrderedJson> tables;
  for (int k = 0; k < spec.num_tables(factor); ++k) {
    const std::span<const double> table = model.table(factor, k);
    const std::vector<int>& nodes = layout.of(factor, k);
    std::vector<double> values;
    for (const int entry : nodes) values.push_back(table[entry]);
    OrderedJson numbers = FiniteNumbers(values, FactorName(factor));
    if (nodes.size() < table.size()) {
      numbers = {{"size", table.size()}, {"nodes", nodes}, {"values", std::move(numbers)}};
    }
    tables.push_back(std::move(numbers));
  }
  return Nest(tables, spec.sharing(factor), spec.lobes);
}

OrderedJson DeadToJson(const ModelFile& file, Factor factor) {
  const ModelSpec& spec = file.model.spec();
  OrderedJson lists = OrderedJson::array();
  for (int table = 0; table < spec.num_tables(factor); ++table) {
    OrderedJson list = OrderedJson::array();
    for (int entry = 0; entry < spec.table_size(factor); ++entry) {
      if (file.dead[file.model.TableOffset(factor, table) + entry]) list.push_back(entry);
    }
    lists.push_back(std::move(list));
  }
  return lists;
}

// Indented by two, but arrays of numbers each on one line.
void Print(const OrderedJson& json, const std::string& indent, std::string* text) {
  const bool nested = json.is_object() ||
                      (json.is_array() && std::ranges::any_of(json, &OrderedJson::is_structured));
  if (!nested || json.empty()) {
    // A source name need not be UTF-8, but JSON must.
    *text += json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
    return;
  }
  *text += json.is_object() ? "{" : "[";
  const char* separator = "\n";
  for (const auto& [key, value] : json.items()) {
    *text += separator + indent + "  ";
    if (json.is_object()) *text += OrderedJson(key).dump() + ": ";
    Print(value, indent + "  ", text);
    separator = ",\n";
  }
  *text += "\n" + indent + (json.is_object() ? "}" : "]");
}

}  // namespace

bool LooksLikeModel(std::string_view bytes) {
  const size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{' &&
         bytes.substr(0, 64).find('\0') == std::string_view::npos;
}

ModelFile ParseModel(std::string_view text, const std::string& source) {
  const Json json = ParseJson(text, source);
  if (!json.is_object()) {
    throw Error(source + ": not a model file: it must be a JSON object, not " + json.type_name());
  }
  const Node root(json, "", source);
  if (const std::string format = root["format"].String(); format != kFormat) {
    root["format"].Fail("must be \"" + std::string(kFormat) + "\"");
  }
  if (const int version = root["version"].Integer(std::numeric_limits<int>::max());
      version != kVersion) {
    root["version"].Fail("is " + std::to_string(version) + "; this program reads version " +
                         std::to_string(kVersion) + (version > kVersion ? "; update it" : ""));
  }
  if (root["kind"].String() != kKind) {
    root["kind"].Fail("must be \"" + std::string(kKind) + "\", the only kind this program reads");
  }
  ModelFile file;
  ReadNumbers(root, &file);
  file.dead = ReadDead(root, file.model);
  file.fit = ReadFitInfo(root);
  return file;
}

ModelFile ReadModel(const std::string& path) { return ParseModel(ReadFile(path), path); }

std::string FormatModel(const ModelFile& file) {
  const FactorModel& model = file.model;
  const ModelSpec& spec = model.spec();
  OrderedJson json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["kind"] = kKind;
  json["lobes"] = spec.lobes;
  for (const Factor factor : kFactors) {
    const auto [per_lobe, per_channel] = spec.sharing(factor);
    json["sharing"][FactorName(factor)] = {{"per_lobe", per_lobe}, {"per_channel", per_channel}};
  }
  const TableLayout layout = file.layout.value_or(TableLayout::Full(spec));
  CheckLayout(layout, spec);
  json["d"] = ChannelsToJson(model.d(), layout.coloured_d, "d");
  json["s"] = OrderedJson::array();
  for (int m = 0; m < spec.lobes; ++m) {
    json["s"].push_back(ChannelsToJson(model.s(m), layout.coloured_s, "s"));
  }
  for (const Factor factor : kFactors) {
    json[FactorName(factor)] = TablesToJson(model, layout, factor);
  }
  if (!file.dead.empty()) {
    for (const Factor factor : kFactors) {
      json["dead"][FactorName(factor)] = DeadToJson(file, factor);
    }
  }
  json["fit"] = OrderedJson::object();
  VisitFitInfo(&file.fit, [&](const char* key, const auto* value) {
    if constexpr (std::is_same_v<decltype(value), const double*>) {
      if (!std::isfinite(*value)) return;  // JSON cannot say it: unknown
    }
    json["fit"][key] = *value;
  });
  std::string text;
  Print(json, "", &text);
  return text + "\n";
}

void WriteModel(const ModelFile& file, const std::string& path) {
  WriteFile(path, [&](std::ostream& out) { out << FormatModel(file); });
}

}  // namespace trilobe
