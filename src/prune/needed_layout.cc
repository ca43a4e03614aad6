#include "prune/needed_layout.h"

#include <vector>

namespace trilobe {
namespace {

std::vector<int> NeededEntries(std::span<const double> table, std::span<const double> coverage,
                               bool drop_equal) {
  std::vector<int> observed;
  for (int k = 0; k < static_cast<int>(table.size()); ++k) {
    if (coverage[k] > 0) observed.push_back(k);
  }
  if (observed.empty()) observed.push_back(0);
  if (!drop_equal) return observed;
  std::vector<int> needed;
  for (size_t i = 0; i < observed.size(); ++i) {
    const bool like_previous = i == 0 || table[observed[i]] == table[observed[i - 1]];
    const bool like_next = i + 1 == observed.size() || table[observed[i]] == table[observed[i + 1]];
    // At an end of the table the inner end of the run serves all of it.
    if (!like_previous || !like_next) needed.push_back(observed[i]);
  }
  if (needed.empty()) needed.push_back(observed.front());
  return needed;
}

}  // namespace

TableLayout NeededLayout(const FactorModel& model, std::span<const double> coverage,
                         const ThinnedFactors& may_thin, bool drop_equal) {
  const ModelSpec& spec = model.spec();
  TableLayout layout = TableLayout::Full(spec);
  for (const Factor factor : kFactors) {
    if (!may_thin[static_cast<int>(factor)]) continue;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = model.table(factor, t);
      layout.of(factor, t) = NeededEntries(
          table, coverage.subspan(model.TableOffset(factor, t), table.size()), drop_equal);
    }
  }
  return layout;
}

}  // namespace trilobe
