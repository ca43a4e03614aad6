#include "io/formats/model_json.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "core/base/file_names.h"
#include "core/base/text.h"
#include "model/model_format.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

void Print(const OrderedJson& json, const std::string& indent, std::string* text) {
  const bool nested = json.is_object() ||
                      (json.is_array() && std::ranges::any_of(json, &OrderedJson::is_structured));
  if (!nested || json.empty()) {
    *text += json.dump();
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

OrderedJson FiniteNumbers(std::span<const double> values, const char* key) {
  for (const double value : values) {
    if (!std::isfinite(value) || value < 0) {
      throw Error(ErrorKind::kData, "cannot store the model: '" + std::string(key) +
                                        "' has the entry " + std::to_string(value) +
                                        "; all must be finite and >= 0")
          .About(key, value);
    }
  }
  return OrderedJson(std::vector<double>(values.begin(), values.end()));
}

OrderedJson ToJson(FitInfo fit) {
  OrderedJson json = OrderedJson::object();
  fit.source = ValidUtf8(FileNameOf(fit.source));
  fit.init = ValidUtf8(FileNameOf(fit.init));
  VisitFitInfo(&fit, [&](const char* key, const auto* value) {
    if constexpr (std::is_same_v<decltype(value), const double*>) {
      if (!std::isfinite(*value)) return;  // JSON cannot say it: unknown
    }
    json[key] = *value;
  });
  return json;
}

std::string TextOf(const OrderedJson& json) {
  std::string text;
  Print(json, "", &text);
  return text + "\n";
}

}  // namespace trilobe
