#include "trilobe/io/formats/model_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "core/files/file.h"
#include "io/formats/model_json.h"
#include "io/formats/stretch_json.h"
#include "model/model_format.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Tables in the order of their numbers, nested as the file has them: a list a lobe, or a list of
// lists where channels differ.
OrderedJson Nest(const std::vector<OrderedJson>& tables, const TableSharing& sharing, int lobes,
                 size_t all_channels = kChannels) {
  if (lobes == 0) return OrderedJson::array();
  OrderedJson nest = OrderedJson::array();
  const size_t channels = sharing.per_channel ? all_channels : 1;
  for (size_t begin = 0; begin < tables.size(); begin += channels) {
    const std::vector<OrderedJson> group(tables.begin() + begin, tables.begin() + begin + channels);
    nest.push_back(sharing.per_channel ? OrderedJson(group) : group[0]);
  }
  return sharing.per_lobe ? nest : nest[0];
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
    const Axis& axis = spec.axis(factor);
    if (nodes.size() == table.size() && axis.polar()) {
      numbers = OrderedJson::array();
      for (size_t begin = 0; begin < table.size(); begin += axis.phi_nodes) {
        numbers.push_back(FiniteNumbers(table.subspan(begin, axis.phi_nodes), FactorName(factor)));
      }
    }
    if (nodes.size() < table.size()) {
      numbers = {{"size", table.size()}, {"nodes", nodes}, {"values", std::move(numbers)}};
    }
    tables.push_back(std::move(numbers));
  }
  return Nest(tables, spec.sharing(factor), spec.lobes);
}

// A list a table; of a spectral model, a list a lobe, or one of all lobes, as bands do not differ.
OrderedJson UnobservedToJson(const ModelFile& file, Factor factor) {
  const ModelSpec& spec = file.model.spec();
  std::vector<int> tables(spec.num_tables(factor));
  std::iota(tables.begin(), tables.end(), 0);
  if (file.spectral) {
    const bool per_lobe = file.spectral->spec().sharing(factor).per_lobe;
    tables.resize(per_lobe ? spec.lobes : std::min(spec.lobes, 1));
    for (size_t m = 0; m < tables.size(); ++m) {
      tables[m] = spec.table(factor, static_cast<int>(m), 0);
    }
  }
  OrderedJson lists = OrderedJson::array();
  for (const int table : tables) {
    OrderedJson list = OrderedJson::array();
    for (int entry = 0; entry < spec.table_size(factor); ++entry) {
      if (file.unobserved[file.model.TableOffset(factor, table) + entry]) list.push_back(entry);
    }
    lists.push_back(std::move(list));
  }
  return lists;
}

void AddBands(const SpectralModel& model, OrderedJson* json) {
  (*json)["wavelengths"] = FiniteNumbers(model.wavelengths(), "wavelengths");
  (*json)["d"] = FiniteNumbers(model.d(), "d");
  (*json)["s"] = OrderedJson::array();
  for (int m = 0; m < model.spec().lobes; ++m) {
    (*json)["s"].push_back(FiniteNumbers(model.s(m), "s"));
  }
}

OrderedJson BandsOfF(const SpectralModel& model) {
  const ModelSpec& spec = model.spec();
  const int bands = spec.F.per_channel ? model.bands() : 1;
  std::vector<OrderedJson> tables;
  for (int m = 0; m < (spec.F.per_lobe ? spec.lobes : std::min(spec.lobes, 1)); ++m) {
    for (int l = 0; l < bands; ++l) tables.push_back(FiniteNumbers(model.F(m, l), "F"));
  }
  return Nest(tables, spec.F, spec.lobes, bands);
}

}  // namespace

std::string FormatModel(const ModelFile& file) {
  const FactorModel& model = file.spectral ? file.spectral->shared() : file.model;
  const ModelSpec& spec = model.spec();
  OrderedJson json;
  json["format"] = kModelFormat;
  json["version"] = file.spectral          ? kSpectralVersion
                    : spec.stretches.any() ? kStretchedVersion
                                           : kModelVersion;
  json["kind"] = spec.anisotropic() ? kAnisotropicKind : kIsotropicKind;
  json["lobes"] = spec.lobes;
  for (const Factor factor : kFactors) {
    const auto [per_lobe, per_channel] = spec.sharing(factor);
    json["sharing"][FactorName(factor)] = {{"per_lobe", per_lobe}, {"per_channel", per_channel}};
  }
  if (spec.anisotropic()) {
    for (const Factor factor : {Factor::kD, Factor::kG}) {
      const Axis& axis = spec.axis(factor);
      if (!axis.polar()) {
        throw Error(ErrorKind::kUnsupported,
                    "cannot store a model that is anisotropic in part only")
            .About("anisotropic");
      }
      std::vector<double> phi(axis.phi_nodes);
      for (int b = 0; b < axis.phi_nodes; ++b) phi[b] = 360.0 * b / axis.phi_nodes;
      json["theta_nodes"][FactorName(factor)] = axis.theta;
      json["phi_nodes"][FactorName(factor)] = std::move(phi);
    }
  }
  if (spec.stretches.any()) json["stretch"] = StretchesToJson<OrderedJson>(spec);
  const TableLayout layout = file.layout.value_or(TableLayout::Full(spec));
  CheckLayout(layout, spec);
  if (file.spectral) {
    AddBands(*file.spectral, &json);
  } else {
    json["d"] = ChannelsToJson(model.d(), layout.coloured_d, "d");
    json["s"] = OrderedJson::array();
    for (int m = 0; m < spec.lobes; ++m) {
      json["s"].push_back(ChannelsToJson(model.s(m), layout.coloured_s, "s"));
    }
  }
  for (const Factor factor : kFactors) {
    if (file.spectral && factor == Factor::kF) {
      json["F"] = BandsOfF(*file.spectral);
    } else {
      json[FactorName(factor)] = TablesToJson(model, layout, factor);
    }
  }
  if (!file.unobserved.empty()) {
    for (const Factor factor : kFactors) {
      json["unobserved"][FactorName(factor)] = UnobservedToJson(file, factor);
    }
  }
  json["fit"] = ToJson(file.fit);
  return TextOf(json);
}

void WriteModel(const ModelFile& file, const std::string& path) {
  WriteFile(path, [&](std::ostream& out) { out << FormatModel(file); });
}

}  // namespace trilobe
