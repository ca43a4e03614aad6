#include "io/formats/text/repeated_rows.h"

#include <algorithm>
#include <utility>

#include "io/formats/text/column_words.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

// Polarisations of light and detector: f is half the sum of all four, and not their mean.
constexpr std::string_view kCrossed[] = {"ss", "sp", "ps", "pp", "hh", "hv", "vh", "vv"};

bool IsCrossedKind(const std::string& kind) { return IsOneOf(Plain(kind), kCrossed); }

}  // namespace

void RepeatedRows::Add(std::string_view kind, Row row) {
  const size_t number = std::ranges::find(kinds_, kind) - kinds_.begin();
  if (number == kinds_.size() && number <= kMostKinds) kinds_.emplace_back(kind);
  const auto& [place, is_new] = places_.try_emplace(
      {row.at.theta_i, row.at.phi_i, row.at.theta_o, row.at.phi_o, row.wavelength}, alike_.size());
  if (is_new) alike_.emplace_back();
  std::vector<size_t>& alike = alike_[place->second];
  is_twice_ |= std::ranges::any_of(alike, [&](size_t j) { return kind_of_rows_[j] == number; });
  alike.push_back(rows_.size());
  kind_of_rows_.push_back(number);
  rows_.push_back(std::move(row));
}

bool RepeatedRows::IsRepeated() const {
  if (is_twice_ || kinds_.size() < 2 || kinds_.size() > kMostKinds) return false;
  if (std::ranges::any_of(kinds_, IsCrossedKind) && !IsCrossed()) return false;
  return 2 * static_cast<size_t>(incomplete()) <= alike_.size();
}

bool RepeatedRows::IsCrossed() const {
  return kinds_.size() == 4 && std::ranges::all_of(kinds_, IsCrossedKind);
}

std::vector<RepeatedRows::Row> RepeatedRows::Means() const {
  if (!IsRepeated()) return rows_;
  std::vector<Row> means;
  for (const std::vector<size_t>& alike : alike_) {
    if (alike.size() < kinds_.size()) continue;
    Row mean = rows_[alike[0]];
    for (size_t k = 0; k < mean.values.size(); ++k) {
      double sum = 0;
      for (const size_t j : alike) sum += rows_[j].values[k];
      mean.values[k] = sum / (IsCrossed() ? 2 : static_cast<double>(alike.size()));
    }
    means.push_back(std::move(mean));
  }
  return means;
}

int RepeatedRows::incomplete() const {
  return static_cast<int>(std::ranges::count_if(
      alike_, [&](const auto& alike) { return alike.size() < kinds_.size(); }));
}

std::string RepeatedRows::Kinds() const {
  constexpr size_t kMost = 8;
  std::string text;
  for (size_t k = 0; k < std::min(kinds_.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + Printable(kinds_[k]);
  }
  return text + (kinds_.size() > kMost ? ", ..." : "");
}

}  // namespace trilobe
