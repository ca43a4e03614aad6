#include "trilobe/model/evaluate/read_terms.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "core/files/json_value.h"
#include "model/evaluate/json_node.h"
#include "model/evaluate/read_fit_info.h"
#include "model/evaluate/terms_format.h"
#include "model/spectral/spectral_color.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

std::string NotTerms(const std::string& source) { return source + ": not a model of terms"; }

// The place of a word in a list of names, with `name` of each.
template <typename Names, typename NameOf>
int Choice(const JsonNode& node, const Names& names, const NameOf& name_of) {
  const std::string word = node.String();
  std::string known;
  int k = 0;
  for (const auto& name : names) {
    if (word == name_of(name)) return k;
    known += std::string(known.empty() ? "\"" : ", \"") + name_of(name) + "\"";
    ++k;
  }
  node.Fail("must be one of " + known);
}

TermRead ReadRead(const JsonNode& node, const std::vector<TableSet>& sets) {
  node.CheckObject();
  TermRead read{.set = Choice(node["table"], sets, [](const TableSet& set) { return set.name; }),
                .table = node["number"].Integer(kMaxTerms),
                .site = kSites[Choice(node["at"], kSites, SiteName)]};
  if (node.has("stretch")) {
    const JsonNode stretch = node["stretch"].CheckObject();
    read.stretch = {.along = stretch["along"].Exponent(), .across = stretch["across"].Exponent()};
  }
  return read;
}

TermSpec ReadTermSpec(const JsonNode& root) {
  TermSpec spec;
  spec.channels = root["channels"].Integer(kMaxTermChannels);
  const JsonNode sets = root["tables"], terms = root["terms"];
  for (size_t k = 0; k < sets.ArraySize(); ++k) {
    const JsonNode node = sets[k].CheckObject();
    TableSet set;
    set.name = node["name"].String();
    set.axis.rule = static_cast<Axis::Rule>(
        Choice(node["axis"], kAxisRules, [](const char* name) { return name; }));
    set.axis.size = node["size"].Integer(kMaxBins);
    set.count = node["count"].Integer(kMaxTerms);
    set.per_channel = node["per_channel"].Bool();
    set.fixed = node["fixed"].Bool();
    spec.sets.push_back(std::move(set));
  }
  for (size_t t = 0; t < terms.ArraySize(); ++t) {
    const JsonNode node = terms[t].CheckObject();
    Term term{
        .name = node["name"].String(), .reads = {}, .over_cosines = node["over_cosines"].Bool()};
    for (size_t r = 0; r < node["reads"].ArraySize(); ++r) {
      term.reads.push_back(ReadRead(node["reads"][r], spec.sets));
    }
    spec.terms.push_back(std::move(term));
  }
  return spec;
}

}  // namespace

TermFile ParseTerms(std::string_view text, const std::string& source) {
  const JsonValue json = JsonValue::Parse(text, NotTerms(source));
  if (json.type() != JsonValue::Type::kObject) {
    throw Error(NotTerms(source) + ": it must be a JSON object, not " + json.type_name());
  }
  const JsonNode root(json, "", source);
  if (root["format"].String() != kTermsFormat) {
    root["format"].Fail("must be \"" + std::string(kTermsFormat) + "\"");
  }
  if (const double version = root["version"].Number(); version != kTermsVersion) {
    root["version"].Fail("must be " + std::to_string(kTermsVersion) + "; update this program");
  }
  const auto model_of = [&] {
    try {
      return TermModel(ReadTermSpec(root));
    } catch (const Error& error) {
      if (std::string(error.what()).starts_with(source)) throw;
      throw Error(source + ": " + error.what());
    }
  };
  TermFile file{.model = model_of()};
  TermModel& model = file.model;
  const TermSpec& spec = model.spec();
  for (int t = 0; t < static_cast<int>(spec.terms.size()); ++t) {
    root["terms"][t]["strength"].Numbers(model.strength(t));
  }
  for (int set = 0; set < static_cast<int>(spec.sets.size()); ++set) {
    const TableSet& tables = spec.sets[set];
    const JsonNode values = root["tables"][set]["values"];
    const int channels = tables.per_channel ? spec.channels : 1;
    values.CheckArraySize(static_cast<size_t>(tables.count) * channels);
    for (int k = 0; k < tables.count * channels; ++k) {
      values[k].Numbers(model.table(set, k / channels, k % channels));
    }
  }
  if (root.has("wavelengths")) {
    file.wavelengths.resize(spec.channels);
    root["wavelengths"].Numbers(file.wavelengths);
    SpectralColor::OfBands(file.wavelengths, source);  // its error
  } else if (spec.channels != kChannels) {
    root["channels"].Fail("must be 3 where there are no \"wavelengths\"");
  }
  file.fit = ReadFitInfo(root);
  return file;
}

TermFile ReadTerms(const std::string& path) {
  return ParseTerms(ReadJsonText(path, NotTerms(path)), path);
}

std::function<Rgb(const HalfDiffAngles&)> RgbOf(const TermFile& file) {
  const auto model = std::make_shared<const TermModel>(file.model);
  const auto reader = std::make_shared<const TermReader>(model->spec());
  std::shared_ptr<const SpectralColor> color;
  if (!file.wavelengths.empty()) {
    color = std::make_shared<const SpectralColor>(
        SpectralColor::OfBands(file.wavelengths, "a model of terms"));
  }
  return [model, reader, color](const HalfDiffAngles& angles) -> Rgb {
    std::vector<double> rho(model->spec().channels);
    UnclampedValues(*model, *reader, reader->StencilsAt(angles), rho);
    if (color == nullptr) return AtLeastZero({rho[0], rho[1], rho[2]});
    for (double& value : rho) value = std::max(value, 0.0);
    return AtLeastZero((*color)(rho));
  };
}

}  // namespace trilobe
