#include "trilobe/io/model_files/terms_file.h"

#include <ostream>
#include <utility>

#include "core/files/file.h"
#include "io/model_files/model_json.h"
#include "io/model_files/stretch_json.h"
#include "model/evaluate/terms_format.h"

namespace trilobe {

std::string FormatTerms(const TermFile& file) {
  const TermModel& model = file.model;
  const TermSpec& spec = model.spec();
  OrderedJson json = {
      {"format", kTermsFormat}, {"version", kTermsVersion}, {"channels", spec.channels}};
  if (!file.wavelengths.empty()) {
    json["wavelengths"] = FiniteNumbers(file.wavelengths, "wavelengths");
  }
  json["terms"] = OrderedJson::array();
  for (int t = 0; t < static_cast<int>(spec.terms.size()); ++t) {
    const Term& term = spec.terms[t];
    OrderedJson reads = OrderedJson::array();
    for (const TermRead& read : term.reads) {
      OrderedJson entry = {
          {"table", spec.sets[read.set].name}, {"number", read.table}, {"at", SiteName(read.site)}};
      if (read.stretch.any()) entry["stretch"] = StretchToJson<OrderedJson>(read.stretch);
      reads.push_back(std::move(entry));
    }
    json["terms"].push_back({{"name", term.name},
                             {"over_cosines", term.over_cosines},
                             {"reads", std::move(reads)},
                             {"strength", FiniteNumbers(model.strength(t), "strength")}});
  }
  json["tables"] = OrderedJson::array();
  for (int set = 0; set < static_cast<int>(spec.sets.size()); ++set) {
    const TableSet& tables = spec.sets[set];
    const int channels = tables.per_channel ? spec.channels : 1;
    OrderedJson values = OrderedJson::array();
    for (int k = 0; k < tables.count * channels; ++k) {
      values.push_back(
          FiniteNumbers(model.table(set, k / channels, k % channels), tables.name.c_str()));
    }
    json["tables"].push_back({{"name", tables.name},
                              {"axis", kAxisRules[static_cast<int>(tables.axis.rule)]},
                              {"size", tables.axis.size},
                              {"count", tables.count},
                              {"per_channel", tables.per_channel},
                              {"fixed", tables.fixed},
                              {"values", std::move(values)}});
  }
  json["fit"] = ToJson(file.fit);
  return TextOf(json);
}

void WriteTerms(const TermFile& file, const std::string& path) {
  WriteFile(path, [&](std::ostream& out) { out << FormatTerms(file); });
}

}  // namespace trilobe
