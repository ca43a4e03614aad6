#include "io/formats/text/kind_columns.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "io/formats/text/column_words.h"
#include "io/formats/text/columns_flag.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

constexpr size_t kMostKinds = 64, kMostShown = 8;

constexpr std::string_view kRepetitions[] = {
    "sample",      "sampleid", "specimen", "repeat", "repetition", "replicate", "run",  "trial",
    "measurement", "spot",     "scan",     "rep",    "probe",      "material",  "batch"};
// Polarisations of light and detector: f is half the sum of all four, and not their mean.
constexpr std::string_view kCrossed[] = {"ss", "sp", "ps", "pp", "hh", "hv", "vh", "vv"};
constexpr std::string_view kPolarised[] = {"s", "p", "te", "tm", "h", "v"};

bool IsOfPolarisation(const TableColumn& column) { return KeyOf(column).starts_with("pol"); }
bool HasKnownName(const TableColumn& column) {
  return IsOfPolarisation(column) || IsOneOf(KeyOf(column), kRepetitions);
}

// Whether kinds are no names, and no numbers of repetitions, 1, 2, 3, as those of angles.
bool AreQuantities(const std::vector<std::string>& kinds) {
  std::vector<double> numbers;
  for (const std::string& kind : kinds) {
    const std::optional<double> number = ToNumber(kind);
    if (!number) return false;
    numbers.push_back(*number);
  }
  std::ranges::sort(numbers);
  const bool counts = std::abs(numbers.front()) <= 1 &&
                      numbers.back() - numbers.front() == static_cast<double>(kinds.size() - 1);
  return !(counts && numbers.front() == std::floor(numbers.front()));
}

std::string Listed(const std::vector<std::string>& kinds) {
  std::string text;
  for (size_t k = 0; k < std::min(kinds.size(), kMostShown); ++k) {
    text += (k > 0 ? ", " : "") + Printable(kinds[k]);
  }
  return text + (kinds.size() > kMostShown ? ", ..." : "");
}

}  // namespace

KindColumns::KindColumns(const ColumnLayout& layout, const std::vector<size_t>& chosen)
    : layout_(layout) {
  constexpr size_t kMostColumns = 16;
  std::vector<size_t> of_polarisations;
  for (const size_t k : layout.left_out) {
    const TableColumn& column = layout.columns[k];
    if (std::ranges::find(chosen, k) != chosen.end() || column.is_by_flag) continue;
    if (candidates_.size() < kMostColumns || HasKnownName(column)) candidates_.push_back({{k}});
    if (IsOfPolarisation(column)) of_polarisations.push_back(k);
  }
  std::stable_partition(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
    return HasKnownName(layout_.columns[candidate.columns[0]]);
  });
  if (of_polarisations.size() == 2) candidates_.push_back({of_polarisations});
}

std::string KindColumns::KindOf(const TextLines& lines, const std::vector<size_t>& columns,
                                TableRow* row) {
  std::string kind;
  for (const size_t k : columns) kind += row->Cell(lines, k);
  return kind;
}

bool KindColumns::MayTell() const {
  return std::ranges::any_of(candidates_, [](const Candidate& candidate) {
    return !candidate.has_many && !candidate.is_twice;
  });
}

void KindColumns::Add(const TextLines& lines, const SphericalAngles& at, double wavelength,
                      TableRow* row) {
  ++num_rows_;
  const size_t place =
      places_.try_emplace({at.theta_i, at.phi_i, at.theta_o, at.phi_o, wavelength}, places_.size())
          .first->second;
  for (Candidate& candidate : candidates_) {
    if (candidate.has_many) continue;
    const std::string kind = KindOf(lines, candidate.columns, row);
    const size_t number = std::ranges::find(candidate.kinds, kind) - candidate.kinds.begin();
    if (number == candidate.kinds.size()) candidate.kinds.push_back(kind);
    candidate.has_many = candidate.kinds.size() > kMostKinds;
    if (!candidate.is_twice) candidate.is_twice = !candidate.seen.insert({place, number}).second;
  }
}

// The kinds are few, none is there twice for the same directions, and half of these or more have
// all.
bool KindColumns::Tells(const Candidate& candidate) const {
  const size_t count = candidate.kinds.size();
  if (candidate.is_twice || candidate.has_many || count < 2) return false;
  const auto is_crossed = [](const std::string& kind) { return IsOneOf(Plain(kind), kCrossed); };
  if (std::ranges::any_of(candidate.kinds, is_crossed) &&
      (count != 4 || !std::ranges::all_of(candidate.kinds, is_crossed))) {
    return false;
  }
  std::vector<size_t> found(places_.size());
  for (const auto& [place, kind] : candidate.seen) ++found[place];
  return 2 * std::ranges::count(found, count) >= std::ssize(found);
}

std::string KindColumns::Names(const Candidate& candidate) const {
  std::string text;
  for (const size_t k : candidate.columns) {
    text += (text.empty() ? "'" : "' and '") + Printable(layout_.columns[k].name);
  }
  return text + "'";
}

std::vector<size_t> KindColumns::Found(const TextLines& header) const {
  for (const Candidate& candidate : candidates_) {
    if (!Tells(candidate)) continue;
    const TableColumn& column = layout_.columns[candidate.columns[0]];
    if (HasKnownName(column) || !AreQuantities(candidate.kinds)) return candidate.columns;
    header.Fail("rows of the same directions differ by column " + Names(candidate) + " (" +
                    Listed(candidate.kinds) + "), which is not read; if it is an azimuth, type " +
                    Quotable("--columns=phi_o=" + column.name) + ", if a wavelength, " +
                    Quotable("--columns=wavelength=" + column.name) + ", and else " +
                    Quotable("--rows=" + column.name + "=" + candidate.kinds[0]) +
                    " to read some of them",
                ErrorKind::kUnsupported, "rows", column.name);
  }
  return {};
}

std::vector<std::string> KindColumns::Notes() const {
  std::vector<std::string> notes;
  for (const Candidate& candidate : candidates_) {
    const TableColumn& column = layout_.columns[candidate.columns[0]];
    const bool is_few = !candidate.has_many && 2 * candidate.kinds.size() <= num_rows_;
    const bool tells = std::ranges::any_of(candidates_, [&](const Candidate& other) {
      return std::ranges::find(other.columns, candidate.columns[0]) != other.columns.end() &&
             Tells(other);
    });
    if (!HasKnownName(column) || candidate.columns.size() > 1 || tells || !is_few) continue;
    const bool is_polarised = IsOfPolarisation(column);
    const std::string name = Printable(column.name), first = Printable(candidate.kinds[0]);
    if (candidate.kinds.size() > 1) {
      notes.push_back("column '" + name + "' has " + Listed(candidate.kinds) +
                      ", which are read as one; " + Quotable("--rows=" + name + "=" + first) +
                      " reads one");
    } else if (is_polarised &&
               (IsOneOf(Plain(first), kPolarised) || IsOneOf(Plain(first), kCrossed))) {
      notes.push_back("column '" + name + "' is " + first +
                      " in all rows: light of one polarisation; f of light that is not polarised "
                      "is the mean over s and p");
    }
  }
  return notes;
}

}  // namespace trilobe
