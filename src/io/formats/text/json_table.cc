#include <algorithm>
#include <string>
#include <vector>

#include "core/files/json_value.h"
#include "io/formats/text/table_columns.h"
#include "io/formats/text/table_reader.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/measurement_format.h"

namespace trilobe {
namespace {

using Type = JsonValue::Type;

bool NamesTheta(std::string_view name) {
  const ColumnRole role = ColumnNamed(name).role;
  return role == ColumnRole::kThetaI || role == ColumnRole::kThetaO;
}

// {"theta_i": [10, 10], "theta_o": [0, 5], "brdf": [0.1, 0.2]}, with other keys beside them: a key
// of the outermost object that names an angle, and a list behind it, within the first bytes.
bool LooksLikeColumns(std::string_view text) {
  constexpr size_t kLookedAt = 1 << 16;
  text = text.substr(0, kLookedAt);
  int depth = 0;
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (c != '"') continue;
    const size_t close = text.find('"', at + 1);
    if (close == std::string_view::npos) return false;
    const size_t after = text.find_first_not_of(" \t\r\n:", close + 1);
    const bool has_list = after != std::string_view::npos && text[after] == '[';
    if (depth == 1 && has_list && NamesTheta(text.substr(at + 1, close - at - 1))) return true;
    at = close;
  }
  return false;
}

// Its columns as lines of a text table, in the order of the file.
std::string Rows(const JsonValue& columns, const std::string& source) {
  std::vector<size_t> listed;
  for (size_t k = 0; columns.type() == Type::kObject && k < columns.size(); ++k) {
    if (columns[k].type() == Type::kArray) listed.push_back(k);
  }
  if (listed.empty()) {
    throw ErrorIn(ErrorKind::kMissing, source,
                  "this is JSON without lists of columns in its outermost object; make it "
                  "{\"theta_i\": [...], \"theta_o\": [...], \"brdf\": [...]}")
        .About("columns");
  }
  std::string text;
  for (const size_t k : listed) {
    std::string name = columns.key(k);
    std::ranges::replace_if(
        name, [](char c) { return c == '"' || c == '\n' || c == '\r'; }, ' ');
    text += (text.empty() ? "\"" : ",\"") + name + "\"";
  }
  text += "\n";
  const size_t count = columns[listed.front()].size();
  for (const size_t k : listed) {
    if (columns[k].size() == count) continue;
    throw ErrorIn(ErrorKind::kMismatch, source,
                  "'" + columns.key(k) + "' lists " + std::to_string(columns[k].size()) +
                      " values, and '" + columns.key(listed.front()) + "' " +
                      std::to_string(count) + "; columns are of one length")
        .About(columns.key(k), columns[k].size());
  }
  for (size_t row = 0; row < count; ++row) {
    for (const size_t k : listed) {
      const JsonValue& value = columns[k][row];
      if (k != listed.front()) text += ",";
      if (value.type() == Type::kNumber) text += value.number_text();
    }
    text += "\n";
  }
  return text;
}

Measurement ReadColumns(std::string_view text, const std::string& source,
                        const SourceOptions& options) {
  // A row of values takes 56 bytes each.
  constexpr JsonLimits kLimits = {.bytes = size_t{1} << 26, .values = size_t{1} << 22};
  const JsonValue columns = JsonValue::Parse(text, source, "", kLimits);
  Measurement measurement = ReadTextTable(Rows(columns, source), source, options);
  measurement.kind = "JSON file of scattered samples";
  return measurement;
}

}  // namespace

MeasurementFormat JsonTableFormat() {
  return {.name = "json",
          .description = "a .json file of columns",
          .ending = ".json",
          .is_text = true,
          .is_json = true,
          .recognise = LooksLikeColumns,
          .read = ReadColumns};
}

}  // namespace trilobe
