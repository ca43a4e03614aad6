#include "io/formats/text/table_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "core/files/text_lines.h"
#include "io/formats/text/angle_names.h"
#include "io/formats/text/column_words.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

using Role = ColumnRole;

// --- Units ---------------------------------------------------------------------------------------

constexpr std::string_view kAngleUnits[] = {"degrees", "degree", "degs", "deg",  "radians",
                                            "radian",  "rad",    "gon",  "grad", "gradians"};
constexpr std::string_view kOtherUnits[] = {
    "1/sr", "sr^-1", "sr-1", "/sr",  "sr^{-1}", "%",      "percent", "db", "nm",
    "um",   "mrad",  "urad", "turn", "turns",   "arcmin", "arcsec",  "\"", "-"};
constexpr std::string_view kPerSteradianKeys[] = {"persr", "1sr", "sr1"};
constexpr std::string_view kPerSteradian[] = {"1/sr", "sr^-1", "sr-1", "/sr", "sr^{-1}"};

// --- Values --------------------------------------------------------------------------------------

constexpr std::string_view kValues[] = {"brdf",
                                        "bsdf",
                                        "bdrf",
                                        "frdb",
                                        "reflectance",
                                        "reflectivity",
                                        "refl",
                                        "rho",
                                        "reflexionsgrad",
                                        "remission",
                                        "remissionsgrad",
                                        "reflektanz",
                                        "reflectancia",
                                        "riflettanza",
                                        "bidirectionalreflectance",
                                        "value",
                                        "val",
                                        "fr",
                                        "f"};
constexpr std::string_view kReflectances[] = {
    "reflectance", "reflectivity", "refl",         "rho",         "reflexionsgrad",
    "remission",   "reflektanz",   "reflectancia", "riflettanza", "bidirectionalreflectance"};
constexpr std::string_view kSaysBrdf[] = {"brdf", "bsdf", "bdrf", "frdb"};

bool SaysReflectance(std::string_view key) {
  return std::ranges::any_of(kReflectances, [&](auto word) { return key.starts_with(word); }) &&
         std::ranges::none_of(kSaysBrdf, [&](auto word) { return key.ends_with(word); });
}

std::optional<Role> ColorRole(std::string_view word) {
  if (word == "r" || word == "red") return Role::kRed;
  if (word == "g" || word == "green") return Role::kGreen;
  if (word == "b" || word == "blue") return Role::kBlue;
  return std::nullopt;
}

std::optional<Role> ValueRole(std::string text) {
  for (const std::string_view suffix : kPerSteradianKeys) TakeSuffix(suffix, &text);
  const std::string_view key = text;
  if (IsOneOf(key, kValues)) return Role::kValue;
  for (const std::string_view word : kValues) {
    if (!key.starts_with(word)) continue;
    const std::string_view rest = key.substr(word.size());
    if (IsOneOf(rest, kValues)) return Role::kValue;  // "brdf value"
    if (const auto role = ColorRole(rest)) return role;
  }
  return ColorRole(key);
}

struct Scaled {
  std::string_view name;  // before the name of values, or behind
  bool behind;
  ValueScale scale;
};
constexpr Scaled kScaled[] = {{"log10", false, ValueScale::kLog10},
                              {"lg", false, ValueScale::kLog10},
                              {"ln", false, ValueScale::kLn},
                              {"db", true, ValueScale::kDecibels}};

// "log10brdf", "brdfdb", or "db" alone: takes the scale off the key.
ValueScale TakeScale(std::string* key) {
  if (ValueRole(*key)) return ValueScale::kLinear;  // "FRDB", in French
  for (const Scaled& scaled : kScaled) {
    std::string rest = *key;
    if (rest == scaled.name) {
      rest = "f";
    } else if (scaled.behind) {
      if (!TakeSuffix(scaled.name, &rest)) continue;
    } else {
      if (!rest.starts_with(scaled.name)) continue;
      rest.erase(0, scaled.name.size());
    }
    if (!ValueRole(rest)) continue;
    *key = std::move(rest);
    return scaled.scale;
  }
  return ValueScale::kLinear;
}

// Whether a number behind this is negative: "-", "lambda = -", but not "brdf-".
bool IsSigned(std::string_view before) {
  for (const std::string_view minus : {"-", "\u2212"}) {
    if (!before.ends_with(minus)) continue;
    before.remove_suffix(minus.size());
    return before.empty() || std::isalnum(static_cast<unsigned char>(before.back())) == 0;
  }
  return false;
}

constexpr std::string_view kWavelength[] = {
    "lambda",        "wl", "wvl", "wavelength", "wellenlange", "longueurdonde", "lunghezzadonda",
    "longituddeonda"};
constexpr std::string_view kLengths[] = {"nm", "um", "m", "micron", "microns"};
// Names of reflectance before a wavelength alone.
constexpr std::string_view kReflectanceAt[] = {"r", "band"};

std::string_view BeforeNumber(std::string_view plain) {
  return plain.substr(0, std::min(plain.find_first_of("0123456789"), plain.size()));
}

// [nm] "550", "550nm", "0.55 um", "brdf_550", "lambda=550nm"; none for what is no wavelength.
std::optional<double> WavelengthIn(std::string_view plain, std::string_view unit) {
  const std::string_view before = BeforeNumber(plain);
  const std::string word = LettersAndDigits(before);
  if (IsSigned(before)) return std::nullopt;
  if (!word.empty() && !IsOneOf(word, kWavelength) && !IsOneOf(word, kReflectanceAt) &&
      !IsOneOf(word, kValues)) {
    return std::nullopt;
  }
  const std::string_view rest = plain.substr(before.size());
  double number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error != std::errc()) return std::nullopt;
  const std::string_view after = Trimmed(rest.substr(end - rest.data()));
  if (after.empty() == unit.empty() && !after.empty()) return std::nullopt;
  const std::string_view in = after.empty() ? unit : after;
  const bool micrometres = in == "um" || in == "micron" || in == "microns" ||
                           (in.empty() && number < 10 && rest.find('.') != std::string_view::npos);
  if (!micrometres && !in.empty() && in != "nm") return std::nullopt;
  const double wavelength = micrometres ? 1000 * number : number;
  if (!(wavelength >= 200 && wavelength <= 20000)) return std::nullopt;
  return wavelength;
}

void SetRole(const std::string& plain, TableColumn* column) {
  if (const auto wavelength = WavelengthIn(Trimmed(plain), column->unit)) {
    column->role = Role::kBand;
    column->wavelength = *wavelength;
    const std::string word = LettersAndDigits(BeforeNumber(plain));
    column->is_reflectance = IsOneOf(word, kReflectanceAt) || SaysReflectance(word);
    return;
  }
  std::string key = LettersAndDigits(plain);
  column->scale = TakeScale(&key);
  std::string wavelength = key;
  for (const std::string_view unit : kLengths) {
    if (IsOneOf(key, kWavelength) || !TakeSuffix(unit, &wavelength)) continue;
    if (!IsOneOf(wavelength, kWavelength)) wavelength = key;
    if (wavelength != key) column->unit = unit;
    if (wavelength != key) break;
  }
  if (IsOneOf(wavelength, kWavelength)) {
    column->role = Role::kWavelength;
  } else if (const auto value = ValueRole(key)) {
    column->role = *value;
    for (const std::string_view suffix : kPerSteradianKeys) {
      column->per_steradian |= key.ends_with(suffix);
    }
    column->is_reflectance = !column->per_steradian && SaysReflectance(key);
  } else {
    std::string name(Trimmed(plain));
    for (const std::string_view unit : kAngleUnits) {
      if (!TakeSuffix(unit, &key)) continue;
      if (!TakeSuffix(unit, &name)) name = key;
      column->unit = unit;
      break;
    }
    const AngleName angle = AngleNamed(name).value_or(AngleName{.role = Role::kOther});
    column->role = angle.role;
    column->from_horizon = angle.from_horizon;
    column->is_difference = angle.is_difference;
    column->is_word = angle.is_word;
  }
}

}  // namespace

TableColumn ColumnNamed(std::string_view name) {
  TableColumn column{.name = std::string(name)};
  column.is_usual_name = std::ranges::find(kUsualNames, name) != std::end(kUsualNames);
  std::string plain = Plain(name);
  const std::string whole = plain, bracket = TakeBracket(&plain);
  if (const auto unit = UnitIn(bracket)) {
    column.unit = *unit;
    column.per_steradian = IsOneOf(*unit, kPerSteradian);
  } else if (!bracket.empty()) {  // "theta (incident)" and "r (red)"
    SetRole(whole, &column);
    if (column.role != Role::kOther) return column;
  }
  SetRole(plain, &column);
  if (column.unit == "db") column.scale = ValueScale::kDecibels;
  return column;
}

namespace {

// Polarisations of the light and of the detector, or of one of them. All of a set must be there.
constexpr std::array<std::string_view, 4> kPolarisations[] = {
    {"ss", "sp", "ps", "pp"}, {"hh", "hv", "vh", "vv"}, {"s", "p", "", ""}, {"te", "tm", "", ""}};

// By which IsCalled compares.
std::string CalledKey(std::string_view name) {
  std::string plain = Plain(name);
  TakeBracket(&plain);
  std::string key = LettersAndDigits(plain);
  for (const std::string_view unit : kAngleUnits) TakeSuffix(unit, &key);
  return key;
}

// The first column of each key: a line of text may have a hundred thousand cells.
using ColumnsByKey = std::map<std::string, size_t, std::less<>>;

// Marks "f_ss", "f_sp", "f_ps" and "f_pp", or "BRDF_s" and "BRDF_p", if nothing else is a value.
void MarkPolarised(const ColumnsByKey& by_key, std::vector<TableColumn>* columns) {
  const auto is_value = [](const TableColumn& column) {
    return column.role >= Role::kRed && column.role <= Role::kBand;
  };
  if (std::ranges::any_of(*columns, is_value)) return;
  for (const auto& set : kPolarisations) {
    std::vector<std::string_view> prefixes(std::begin(kValues), std::end(kValues));
    prefixes.emplace_back("r");
    if (set[0].size() > 1) prefixes.emplace_back("");
    for (const std::string_view prefix : prefixes) {
      std::vector<TableColumn*> found;
      for (const std::string_view polarisation : set) {
        if (polarisation.empty()) continue;
        const auto at = by_key.find(std::string(prefix).append(polarisation));
        if (at == by_key.end()) continue;
        TableColumn& column = (*columns)[at->second];
        if (column.role == Role::kOther) found.push_back(&column);
      }
      if (found.size() != static_cast<size_t>(4 - std::ranges::count(set, ""))) continue;
      for (TableColumn* const column : found) {
        column->role = Role::kPolarised;
        column->is_reflectance =
            !column->per_steradian && (prefix == "r" || SaysReflectance(prefix));
      }
      return;
    }
  }
}

// Names that are known beside one another.
class NamedTogether {
 public:
  NamedTogether(const ColumnsByKey& by_key, std::vector<TableColumn>* columns)
      : by_key_(by_key), columns_(*columns) {}

  void Mark() {
    if (HasTheta()) return MarkBands();
    // The first direction is that of the light: "theta1" and "theta2".
    if (Both("theta1", "theta2", Role::kThetaI, Role::kThetaO)) {
      Both("phi1", "phi2", Role::kPhiI, Role::kPhiO);
      return;
    }
    // The incidence, the emission and the phase of photometry, and no index and error of others.
    if (!Both("i", "e", Role::kThetaI, Role::kThetaO)) return;
    TableColumn* const alpha = Called("alpha");
    TableColumn* const phase = alpha != nullptr ? alpha : Called("g");
    const bool is_green = phase != alpha && (Has(Role::kRed) || Has(Role::kBlue));
    if (phase != nullptr && !is_green) phase->role = Role::kPhase;
  }

 private:
  TableColumn* Called(std::string_view name) {
    const auto found = by_key_.find(name);
    return found == by_key_.end() ? nullptr : &columns_[found->second];
  }

  bool Has(Role role) const {
    return std::ranges::find(columns_, role, &TableColumn::role) != columns_.end();
  }
  bool HasTheta() const { return Has(Role::kThetaI) || Has(Role::kThetaO) || Has(Role::kTheta); }

  bool Both(std::string_view first, std::string_view second, Role of_first, Role of_second) {
    TableColumn *const one = Called(first), *const other = Called(second);
    if (one == nullptr || other == nullptr) return false;
    one->role = of_first;
    other->role = of_second;
    return true;
  }

  // Numbers of wavelengths beside angles of the sun are reflectances of satellites.
  void MarkBands() {
    const bool of_sun = std::ranges::any_of(columns_, [](const TableColumn& column) {
      const std::string key = LettersAndDigits(Plain(column.name));
      return column.role == Role::kThetaI &&
             (key.starts_with("sza") || key.starts_with("sun") || key.starts_with("sol"));
    });
    if (!of_sun) return;
    for (TableColumn& column : columns_) {
      const bool is_number = column.name.find_first_not_of("0123456789.") == std::string::npos;
      if (column.role == Role::kBand && is_number) column.is_reflectance = true;
    }
  }

  const ColumnsByKey& by_key_;
  std::vector<TableColumn>& columns_;
};

}  // namespace

std::vector<TableColumn> ColumnsNamed(const std::vector<std::string>& names) {
  std::vector<TableColumn> columns;
  for (const std::string& name : names) columns.push_back(ColumnNamed(name));
  ColumnsByKey by_key;
  for (size_t k = 0; k < names.size(); ++k) by_key.try_emplace(CalledKey(names[k]), k);
  MarkPolarised(by_key, &columns);
  NamedTogether(by_key, &columns).Mark();
  return columns;
}

bool IsCalled(std::string_view name, std::string_view usual) {
  return CalledKey(name) == LettersAndDigits(usual);
}

std::optional<double> RadiansIn(std::string_view unit) {
  if (unit.empty() || unit.starts_with("deg")) return kPi / 180;
  if (unit.starts_with("gon") || unit.starts_with("grad")) return kPi / 200;
  if (unit.starts_with("rad")) return 1;
  return std::nullopt;
}

std::optional<std::string> UnitIn(std::string_view cell) {
  std::string plain = Plain(Trimmed(cell));
  if (plain.size() > 2 && (plain.front() == '[' || plain.front() == '(')) {
    plain = plain.substr(1, plain.size() - 2);
  }
  if (IsOneOf(plain, kAngleUnits) || IsOneOf(plain, kOtherUnits)) return plain;
  return std::nullopt;
}

}  // namespace trilobe
