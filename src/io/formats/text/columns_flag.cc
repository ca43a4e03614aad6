#include "io/formats/text/columns_flag.h"

#include <algorithm>
#include <iterator>

#include "io/formats/text/column_words.h"

namespace trilobe {

// A flag as a shell takes it.
std::string Quotable(const std::string& flag) {
  const bool is_plain = flag.find_first_of(" \t'\"()[]|&;*$<>#`\\") == std::string::npos;
  return is_plain                               ? flag
         : flag.find('\'') == std::string::npos ? "'" + flag + "'"
                                                : "\"" + flag + "\"";
}

std::string KeyOf(const TableColumn& column) {
  const std::string plain = Plain(column.name);
  return LettersAndDigits(std::string_view{plain}.substr(0, plain.find_first_of("[(")));
}

std::string ColumnsFlagWith(const std::vector<TableColumn>& columns,
                            const std::vector<std::string>& words) {
  std::vector<ColumnRole> named;
  // The first column of a role, by the name that --columns has for it.
  const auto name_of = [&](const TableColumn& column) -> std::string {
    ColumnRole role = column.role;
    if (role == ColumnRole::kTheta) role = ColumnRole::kThetaO;
    if (role == ColumnRole::kPhi) role = ColumnRole::kPhiO;
    const bool is_known = role == ColumnRole::kWavelength || role == ColumnRole::kFromMirror ||
                          role == ColumnRole::kPhase || role <= ColumnRole::kPhiO;
    const bool is_other = role != column.role && std::ranges::any_of(columns, [&](const auto& of) {
                            return of.role == role;  // "phi" beside "phi_o"
                          });
    if (!is_known || is_other || std::ranges::find(named, role) != named.end()) return "-";
    named.push_back(role);
    const std::string unit = column.unit.starts_with("rad") || column.unit.starts_with("g") ||
                                     column.unit == "um" || column.unit == "m"
                                 ? "_" + column.unit
                                 : "";
    if (role == ColumnRole::kWavelength) return "wavelength" + unit;
    if (role == ColumnRole::kFromMirror) return "from_mirror" + unit;
    if (role == ColumnRole::kPhase) return "phase" + unit;
    if (!column.from_horizon) return kUsualNames[static_cast<int>(role)] + unit;
    return (role == ColumnRole::kThetaI ? "elevation_i" : "elevation_o") + unit;
  };
  std::string text = "--columns=";
  for (size_t k = 0; k < columns.size(); ++k) {
    text += k > 0 ? "," : "";
    text += words[k].empty() ? name_of(columns[k]) : words[k];
  }
  return text;
}

std::string ColumnsFlag(const std::vector<TableColumn>& columns, size_t as_f,
                        std::string_view value) {
  std::vector<std::string> words(columns.size());
  if (as_f < words.size()) words[as_f] = value;
  return ColumnsFlagWith(columns, words);
}

std::string ExampleColumns(size_t count) {
  constexpr const char* kExamples[] = {"theta_o,f", "theta_i,theta_o,f", "theta_i,theta_o,phi_o,f",
                                       "theta_i,phi_i,theta_o,phi_o,f",
                                       "theta_i,theta_o,phi_o,r,g,b"};
  constexpr size_t kFewest = 2;
  if (count >= kFewest && count - kFewest < std::size(kExamples)) return kExamples[count - kFewest];
  constexpr size_t kUsual = std::size(kUsualNames), kMostShown = 20;
  std::string text = kUsualColumns;
  for (size_t k = kUsual; k < std::min(count, kMostShown); ++k) text += ",-";
  return text;
}

}  // namespace trilobe
