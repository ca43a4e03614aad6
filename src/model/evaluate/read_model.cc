#include "trilobe/model/evaluate/read_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/files/json_value.h"
#include "model/evaluate/model_format.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/stretch.h"

namespace trilobe {
namespace {

// A value of the file with its path, such as `D[2][17]`, for messages.
class Node {
 public:
  Node(const JsonValue& json, std::string key, const std::string& source)
      : json_(json), key_(std::move(key)), source_(source) {}

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(source_ + ": key '" + key_ + "' " + problem);
  }

  bool has(const std::string& key) const { return json_.Find(key) != nullptr; }
  bool is_object() const { return json_.type() == Type::kObject; }
  bool is_array() const { return json_.type() == Type::kArray; }

  Node operator[](const std::string& key) const {
    const std::string path = key_.empty() ? key : key_ + "." + key;
    const JsonValue* const found = json_.Find(key);
    if (found == nullptr) Node(json_, path, source_).Fail("is missing");
    return {*found, path, source_};
  }

  Node operator[](size_t index) const {
    return {json_[index], key_ + "[" + std::to_string(index) + "]", source_};
  }

  const std::string& source() const { return source_; }

  const Node& CheckObject() const {
    CheckType(Type::kObject, "an object");
    return *this;
  }

  size_t ArraySize() const {
    CheckType(Type::kArray, "an array");
    return json_.size();
  }

  void CheckArraySize(size_t size) const {
    if (ArraySize() != size) {
      Fail("must have " + std::to_string(size) + " entries, not " + std::to_string(ArraySize()));
    }
  }

  double Number() const {
    CheckType(Type::kNumber, "a number");
    if (json_.number() < 0) Fail("must be finite and >= 0, not " + NumberText());
    return json_.number();
  }

  double Exponent() const {
    CheckType(Type::kNumber, "a number");
    if (!(std::abs(json_.number()) <= kMaxStretch)) {
      Fail("must be from -2 to 2, not " + NumberText());
    }
    return json_.number();
  }

  int Integer(int max) const {
    const double value = Number();
    if (value != std::floor(value) || value > max) {
      Fail("must be an integer from 0 to " + std::to_string(max) + ", not " + NumberText());
    }
    return static_cast<int>(value);
  }

  bool Bool() const {
    CheckType(Type::kBoolean, "true or false");
    return json_.boolean();
  }

  std::string String() const {
    CheckType(Type::kString, "a string");
    return json_.string();
  }

  void Numbers(std::span<double> values) const {
    CheckArraySize(values.size());
    for (size_t k = 0; k < values.size(); ++k) values[k] = (*this)[k].Number();
  }

 private:
  using Type = JsonValue::Type;

  void CheckType(Type type, const std::string& expected) const {
    if (json_.type() != type) Fail("must be " + expected + ", not " + json_.type_name());
  }
  std::string NumberText() const { return std::string(json_.number_text()); }

  const JsonValue& json_;
  std::string key_;
  const std::string& source_;
};

TableSharing& Sharing(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->D : factor == Factor::kF ? spec->F : spec->G;
}

Axis& AxisOf(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->d_axis : factor == Factor::kF ? spec->f_axis : spec->g_axis;
}

// The tables of a factor in order, from their nest of lobes and channels.
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
  // Without lobes there are no tables, and the nest is [] at its first level.
  if (sharing.per_lobe || lobes == 0) unfold(lobes);
  if (sharing.per_channel) unfold(kChannels);
  return nodes;
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

// Members that readers of version 1 do not know.
void ReadStretch(const Node& root, ModelSpec* spec) {
  if (root["version"].Integer(kStretchedVersion) != kStretchedVersion) {
    if (!root.has("stretch")) return;
    root["stretch"].Fail("needs \"version\": " + std::to_string(kStretchedVersion) +
                         ", as readers of version " + std::to_string(kModelVersion) +
                         " leave it out");
  }
  const Node node = root["stretch"];
  if (spec->anisotropic()) node.Fail("is for isotropic models");
  const auto read = [](const Node& table) {
    table.CheckObject();
    return Stretch{.along = table["along"].Exponent(), .across = table["across"].Exponent()};
  };
  if (node.is_object()) {  // that of all lobes
    spec->stretches = read(node);
    return;
  }
  if (!node.is_array()) node.Fail("must be an object, or a list of one a lobe");
  node.CheckArraySize(spec->lobes);
  std::vector<Stretch> of_lobes;
  for (int m = 0; m < spec->lobes; ++m) of_lobes.push_back(read(node[m]));
  spec->stretches = Stretches(of_lobes);
  if (spec->stretches.several() && !spec->D.per_lobe) {
    node.Fail("must be one for all lobes, since they share D");
  }
}

// Number of entries of a table: listed ones or, for a table of nodes, its "size".
size_t TableEntries(const Node& table) {
  if (!table.is_object()) return table.ArraySize();
  return table["size"].Integer(kMaxTableSize);
}

// The nodes of D or G of an anisotropic model: as in the file, or UTIA's.
Axis ReadPolarAxis(const Node& root, Factor factor) {
  Axis axis = Axis::Utia();
  if (root.has("theta_nodes")) {
    const Node list = root["theta_nodes"].CheckObject()[FactorName(factor)];
    if (list.ArraySize() < 1 || list.ArraySize() > 90) list.Fail("must have 1 to 90 entries");
    axis.theta.resize(list.ArraySize());
    list.Numbers(axis.theta);
    for (size_t k = 0; k < axis.theta.size(); ++k) {
      if (!(axis.theta[k] < 90 && (k == 0 || axis.theta[k] > axis.theta[k - 1]))) {
        list[k].Fail("must be above the one before it, and below 90 degrees");
      }
    }
  }
  if (root.has("phi_nodes")) {
    const Node list = root["phi_nodes"].CheckObject()[FactorName(factor)];
    if (list.ArraySize() < 1 || list.ArraySize() > 720) list.Fail("must have 1 to 720 entries");
    axis.phi_nodes = static_cast<int>(list.ArraySize());
    for (int k = 0; k < axis.phi_nodes; ++k) {
      if (std::abs(list[k].Number() - 360.0 * k / axis.phi_nodes) > 1e-6) {
        list[k].Fail("must be " + std::to_string(360.0 * k / axis.phi_nodes) +
                     ": azimuths are evenly spaced from 0");
      }
    }
  }
  axis.size = static_cast<int>(axis.theta.size()) * axis.phi_nodes;
  if (axis.size < 4 || axis.size > kMaxTableSize) {
    throw Error(root.source() + ": key 'theta_nodes' and 'phi_nodes' make tables " +
                FactorName(factor) + " of " + std::to_string(axis.size) +
                " entries; they need 4 to " + std::to_string(kMaxTableSize));
  }
  return axis;
}

void CheckPolarTable(const Node& table, const Axis& axis) {
  if (table.is_object()) {
    if (static_cast<int>(TableEntries(table)) != axis.size) {
      table["size"].Fail("must be " + std::to_string(axis.size) + ", as there are nodes");
    }
    return;
  }
  table.CheckArraySize(axis.theta.size());
  for (size_t a = 0; a < axis.theta.size(); ++a) table[a].CheckArraySize(axis.phi_nodes);
}

// The model's spec, with limits checked before any allocation.
ModelSpec ReadSpec(const Node& root) {
  ModelSpec spec;
  spec.lobes = root["lobes"].Integer(kMaxLobes);
  ReadSharing(root, &spec);
  const bool anisotropic = root["kind"].String() == kAnisotropicKind;
  for (const Factor factor : kFactors) {
    const std::vector<Node> tables =
        TableNodes(root[FactorName(factor)], spec.sharing(factor), spec.lobes);
    if (anisotropic && factor != Factor::kF) {
      AxisOf(factor, &spec) = ReadPolarAxis(root, factor);
      for (const Node& table : tables) CheckPolarTable(table, spec.axis(factor));
      continue;
    }
    if (tables.empty()) continue;
    const size_t size = TableEntries(tables[0]);
    if (size < 4 || size > kMaxBins) {
      tables[0].Fail("must have at least 4 and at most " + std::to_string(kMaxBins) +
                     " entries, not " + std::to_string(size));
    }
    for (const Node& table : tables) {
      if (!table.is_object()) {
        table.CheckArraySize(size);
      } else if (TableEntries(table) != size) {
        table["size"].Fail("must be " + std::to_string(size) + ", as in the first table");
      }
    }
    AxisOf(factor, &spec).size = static_cast<int>(size);
  }
  ReadStretch(root, &spec);
  return spec;
}

// One number per channel, or one for all.
bool ReadChannels(const Node& node, std::span<double> values) {
  const bool coloured = node.ArraySize() != 1;
  node.Numbers(coloured ? values : values.first(1));
  return coloured;
}

// Reads the nodes of a table and stores their values in its entries.
std::vector<int> ReadTable(const Node& node, const Axis& axis, std::span<double> table) {
  std::vector<int> entries;
  if (!node.is_object()) {
    if (axis.polar()) {
      const size_t phi_nodes = axis.phi_nodes;
      for (size_t a = 0; a < axis.theta.size(); ++a) {
        node[a].Numbers(table.subspan(a * phi_nodes, phi_nodes));
      }
    } else {
      node.Numbers(table);
    }
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
      layout.of(factor, k) = ReadTable(tables[k], spec.axis(factor), model.table(factor, k));
    }
  }
  if (layout == TableLayout::Full(spec)) return;
  ExpandStored(layout, &model);
  file->layout = std::move(layout);
}

std::vector<bool> ReadUnobserved(const Node& root, const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  std::vector<bool> unobserved(spec.num_parameters(), false);
  const char* const key = root.has("unobserved") ? "unobserved" : "dead";  // as it was called first
  if (!root.has(key)) return unobserved;
  const Node node = root[key].CheckObject();
  for (const Factor factor : kFactors) {
    const Node lists = node[FactorName(factor)];
    lists.CheckArraySize(spec.num_tables(factor));
    for (int table = 0; table < spec.num_tables(factor); ++table) {
      const Node list = lists[table];
      for (size_t k = 0; k < list.ArraySize(); ++k) {
        const int entry = list[k].Integer(spec.table_size(factor) - 1);
        unobserved[model.TableOffset(factor, table) + entry] = true;
      }
    }
  }
  return unobserved;
}

void Read(const Node& node, std::string* value) { *value = node.String(); }
void Read(const Node& node, double* value) { *value = node.Number(); }
void Read(const Node& node, int* value) { *value = node.Integer(std::numeric_limits<int>::max()); }

// Fields missing in the file stay unknown.
FitInfo ReadFitInfo(const Node& root) {
  FitInfo fit;
  if (!root.has("fit")) return fit;
  const Node node = root["fit"].CheckObject();
  VisitFitInfo(&fit, [&](const std::string& key, auto* value) {
    if (node.has(key)) Read(node[key], value);
  });
  return fit;
}

std::string NotAModel(const std::string& source) { return source + ": not a model file"; }

}  // namespace

ModelFile ParseModel(std::string_view text, const std::string& source) {
  const JsonValue json = JsonValue::Parse(text, NotAModel(source));
  if (json.type() != JsonValue::Type::kObject) {
    throw Error(NotAModel(source) + ": it must be a JSON object, not " + json.type_name());
  }
  const Node root(json, "", source);
  if (const std::string format = root["format"].String(); format != kModelFormat) {
    root["format"].Fail("must be \"" + std::string(kModelFormat) + "\"");
  }
  if (const int version = root["version"].Integer(std::numeric_limits<int>::max());
      version != kModelVersion && version != kStretchedVersion) {
    root["version"].Fail("is " + std::to_string(version) + "; this program reads versions " +
                         std::to_string(kModelVersion) + " and " +
                         std::to_string(kStretchedVersion) +
                         (version > kStretchedVersion ? "; update it" : ""));
  }
  const std::string kind = root["kind"].String();
  if (kind != kIsotropicKind && kind != kAnisotropicKind) {
    root["kind"].Fail("must be \"" + std::string(kIsotropicKind) + "\" or \"" + kAnisotropicKind +
                      "\", the kinds this program reads");
  }
  ModelFile file;
  ReadNumbers(root, &file);
  file.unobserved = ReadUnobserved(root, file.model);
  file.fit = ReadFitInfo(root);
  return file;
}

ModelFile ReadModel(const std::string& path) {
  return ParseModel(ReadJsonText(path, NotAModel(path)), path);
}

}  // namespace trilobe
