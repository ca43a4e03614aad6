#include "io/formats/text/phase_column.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace trilobe {

void MarkPhase(const FirstRows& rows, std::vector<TableColumn>* columns) {
  const auto called = [&](const char* name) {
    return std::ranges::find_if(
        *columns, [&](const TableColumn& column) { return IsCalled(column.name, name); });
  };
  const auto incidence = called("i"), emission = called("e"), phi = called("phi");
  if (incidence == columns->end() || emission == columns->end() || phi == columns->end()) return;
  if (incidence->role != ColumnRole::kThetaI || phi->role != ColumnRole::kPhi) return;
  const auto numbers = [&](auto column) { return rows.Column(column - columns->begin()); };
  const std::vector<std::optional<double>> i = numbers(incidence), e = numbers(emission),
                                           g = numbers(phi);
  constexpr double kRounding = 0.1, kZero = 1e-9;  // degrees
  std::set<double> at_zero;                        // the other angles
  for (size_t k = 0; k < i.size(); ++k) {
    if (!i[k] || !e[k] || !g[k]) continue;
    const double a = std::abs(*i[k]), b = std::abs(*e[k]), between = std::abs(*g[k]);
    if (between < std::abs(a - b) - kRounding || between > a + b + kRounding) return;
    if (std::min(a, b) < kZero && std::max(a, b) > 1) at_zero.insert(std::max(a, b));
  }
  if (at_zero.size() > 1) phi->role = ColumnRole::kPhase;
}

}  // namespace trilobe
