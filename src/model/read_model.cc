#include "trilobe/model/read_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/files/json_value.h"
#include "model/json_node.h"
#include "model/model_format.h"
#include "model/read_fit_info.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/stretch.h"

namespace trilobe {
namespace {

using Node = JsonNode;

TableSharing& Sharing(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->D : factor == Factor::kF ? spec->F : spec->G;
}

Axis& AxisOf(Factor factor, ModelSpec* spec) {
  return factor == Factor::kD ? spec->d_axis : factor == Factor::kF ? spec->f_axis : spec->g_axis;
}

// The tables of a factor in order, from their nest of lobes and channels.
std::vector<Node> TableNodes(const Node& nest, const TableSharing& sharing, int lobes,
                             size_t channels = kChannels) {
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
  if (sharing.per_channel) unfold(channels);
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
  const int version = root["version"].Integer(kSpectralVersion);
  if (version == kSpectralVersion && !root.has("stretch")) return;
  if (version < kStretchedVersion) {
    if (!root.has("stretch")) return;
    root["stretch"].Fail("needs \"version\": " + std::to_string(kStretchedVersion) +
                         ", as readers of version " + std::to_string(kModelVersion) +
                         " leave it out");
  }
  const Node node = root["stretch"];
  if (spec->anisotropic()) node.Fail("is for isotropic models", ErrorKind::kConflict);
  const auto read = [](const Node& table) {
    table.CheckObject();
    return Stretch{.along = table["along"].Exponent(), .across = table["across"].Exponent()};
  };
  if (node.is_object()) {  // that of all lobes
    spec->stretches = read(node);
    return;
  }
  if (!node.is_array()) node.Fail("must be an object, or a list of one a lobe", ErrorKind::kFormat);
  node.CheckArraySize(spec->lobes);
  std::vector<Stretch> of_lobes;
  for (int m = 0; m < spec->lobes; ++m) of_lobes.push_back(read(node[m]));
  spec->stretches = Stretches(of_lobes);
  if (spec->stretches.several() && !spec->D.per_lobe) {
    node.Fail("must be one for all lobes, since they share D", ErrorKind::kConflict);
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
    throw ErrorIn(ErrorKind::kRange, root.source(),
                  std::string("key 'theta_nodes' and 'phi_nodes' make tables ") +
                      FactorName(factor) + " of " + std::to_string(axis.size) +
                      " entries; they need 4 to " + std::to_string(kMaxTableSize))
        .About("theta_nodes", axis.size);
  }
  return axis;
}

void CheckPolarTable(const Node& table, const Axis& axis) {
  if (table.is_object()) {
    if (static_cast<int>(TableEntries(table)) != axis.size) {
      table["size"].Fail("must be " + std::to_string(axis.size) + ", as there are nodes",
                         ErrorKind::kMismatch);
    }
    return;
  }
  table.CheckArraySize(axis.theta.size());
  for (size_t a = 0; a < axis.theta.size(); ++a) table[a].CheckArraySize(axis.phi_nodes);
}

// The model's spec, with limits checked before any allocation. `channels`: 3, or the bands of a
// spectral model.
ModelSpec ReadSpec(const Node& root, size_t channels = kChannels) {
  ModelSpec spec;
  spec.lobes = root["lobes"].Integer(kMaxLobes);
  ReadSharing(root, &spec);
  const bool anisotropic = root["kind"].String() == kAnisotropicKind;
  for (const Factor factor : kFactors) {
    const std::vector<Node> tables =
        TableNodes(root[FactorName(factor)], spec.sharing(factor), spec.lobes, channels);
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
        table["size"].Fail("must be " + std::to_string(size) + ", as in the first table",
                           ErrorKind::kMismatch);
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
  if (nodes.ArraySize() == 0) nodes.Fail("must have at least one entry", ErrorKind::kRange, "0");
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
      root["s"][m].Fail("must have as many entries as the others", ErrorKind::kMismatch);
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

// --- Spectral models -----------------------------------------------------------------------------

std::vector<double> ReadWavelengths(const Node& root) {
  const Node list = root["wavelengths"];
  if (list.ArraySize() < 1 || list.ArraySize() > SpectralModel::kMaxBands) {
    list.Fail("must have 1 to " + std::to_string(SpectralModel::kMaxBands) + " entries, not " +
              std::to_string(list.ArraySize()));
  }
  std::vector<double> wavelengths(list.ArraySize());
  list.Numbers(wavelengths);
  return wavelengths;
}

SpectralModel ReadBands(const Node& root) {
  std::vector<double> wavelengths = ReadWavelengths(root);
  const size_t bands = wavelengths.size();
  const ModelSpec spec = ReadSpec(root, bands);
  const auto read = [&] {
    try {
      return SpectralModel(spec, std::move(wavelengths));
    } catch (const Error& error) {
      throw error.WithMessage(root.source() + ": " + error.what()).At(root.source());
    }
  };
  SpectralModel model = read();
  root["d"].Numbers(model.d());
  root["s"].CheckArraySize(spec.lobes);
  for (int m = 0; m < spec.lobes; ++m) root["s"][m].Numbers(model.s(m));
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    const std::vector<Node> tables =
        TableNodes(root[FactorName(factor)], spec.sharing(factor), spec.lobes, bands);
    for (int k = 0; k < static_cast<int>(tables.size()); ++k) {
      ReadTable(tables[k], spec.axis(factor), model.table(factor, k));
    }
  }
  const std::vector<Node> F = TableNodes(root["F"], spec.F, spec.lobes, bands);
  const size_t per_lobe = spec.F.per_channel ? bands : 1;
  for (size_t k = 0; k < F.size(); ++k) {
    F[k].Numbers(model.F(static_cast<int>(k / per_lobe), static_cast<int>(k % per_lobe)));
  }
  return model;
}

// Entries of F that no sample reads are the same in all bands.
std::vector<bool> ReadUnobserved(const Node& root, const ModelSpec& spec, const FactorModel& rgb) {
  std::vector<bool> unobserved(rgb.spec().num_parameters(), false);
  if (!root.has("unobserved")) return unobserved;
  const Node node = root["unobserved"].CheckObject();
  for (const Factor factor : kFactors) {
    const Node lists = node[FactorName(factor)];
    const int count = spec.sharing(factor).per_lobe ? spec.lobes : std::min(spec.lobes, 1);
    lists.CheckArraySize(count);
    for (int m = 0; m < spec.lobes; ++m) {
      const Node list = lists[count == 1 ? 0 : m];
      for (size_t k = 0; k < list.ArraySize(); ++k) {
        const int entry = list[k].Integer(spec.table_size(factor) - 1);
        for (int c = 0; c < kChannels; ++c) {
          unobserved[rgb.TableOffset(factor, rgb.spec().table(factor, m, c)) + entry] = true;
        }
      }
    }
  }
  return unobserved;
}

constexpr const char* kNotAModel = "not a model file";

}  // namespace

ModelFile ParseModel(std::string_view text, const std::string& source) {
  const JsonValue json = JsonValue::Parse(text, source, kNotAModel);
  if (json.type() != JsonValue::Type::kObject) {
    throw ErrorIn(ErrorKind::kFormat, source,
                  kNotAModel + std::string(": it must be a JSON object, not ") + json.type_name());
  }
  const Node root(json, "", source);
  if (const std::string format = root["format"].String(); format != kModelFormat) {
    root["format"].Fail("must be \"" + std::string(kModelFormat) + "\"", ErrorKind::kFormat,
                        format);
  }
  if (const int version = root["version"].Integer(std::numeric_limits<int>::max());
      version < kModelVersion || version > kSpectralVersion) {
    root["version"].Fail("is " + std::to_string(version) + "; this program reads versions " +
                             std::to_string(kModelVersion) + " to " +
                             std::to_string(kSpectralVersion) +
                             (version > kSpectralVersion ? "; update it" : ""),
                         ErrorKind::kUnsupported, std::to_string(version));
  }
  const std::string kind = root["kind"].String();
  if (kind != kIsotropicKind && kind != kAnisotropicKind) {
    root["kind"].Fail("must be \"" + std::string(kIsotropicKind) + "\" or \"" + kAnisotropicKind +
                          "\", the kinds this program reads",
                      ErrorKind::kUnknown, kind);
  }
  ModelFile file;
  if (root["version"].Integer(kSpectralVersion) == kSpectralVersion) {
    file.spectral = ReadBands(root);
    file.model = file.spectral->ToRgb();
    file.unobserved = ReadUnobserved(root, file.spectral->spec(), file.model);
  } else {
    ReadNumbers(root, &file);
    file.unobserved = ReadUnobserved(root, file.model);
  }
  file.fit = ReadFitInfo(root);
  return file;
}

ModelFile ReadModel(const std::string& path) {
  return ParseModel(ReadJsonText(path, kNotAModel), path);
}

}  // namespace trilobe
