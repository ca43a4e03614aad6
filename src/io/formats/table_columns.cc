#include "io/formats/table_columns.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <span>
#include <utility>

#include "io/formats/column_words.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

using Role = ColumnRole;

constexpr const char* kUsualNames[] = {"theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"};

// --- Units ---------------------------------------------------------------------------------------

bool IsOneOf(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

constexpr std::string_view kAngleUnits[] = {"degrees", "degree", "degs", "deg",  "radians",
                                            "radian",  "rad",    "gon",  "grad", "gradians"};
constexpr std::string_view kOtherUnits[] = {
    "1/sr", "sr^-1", "sr-1", "/sr",  "sr^{-1}", "%",      "percent", "db", "nm",
    "um",   "mrad",  "urad", "turn", "turns",   "arcmin", "arcsec",  "\"", "-"};
constexpr std::string_view kNoBrdf[] = {"%", "percent"};

// A name in quotes for a note, in UTF-8.
std::string Quoted(std::string_view name) {
  constexpr size_t kLongest = 40;
  return std::string("'").append(Printable(name.substr(0, kLongest))).append("'");
}

// --- Angles --------------------------------------------------------------------------------------

constexpr std::string_view kThetaWords[] = {"theta", "zenith", "polar"};
constexpr std::string_view kPhiWords[] = {"phi",    "azimuthal", "azimuth", "azimut",
                                          "acimut", "azim",      "az"};
constexpr std::string_view kIncident[] = {"i",        "in",    "inc",   "incident",    "incidence",
                                          "incoming", "l",     "light", "src",         "source",
                                          "sun",      "solar", "illum", "illumination"};
constexpr std::string_view kOutgoing[] = {
    "o",          "out",      "outgoing", "r",        "refl",     "reflected",
    "reflection", "s",        "sc",       "scat",     "scatter",  "scattered",
    "scattering", "v",        "view",     "viewing",  "viewer",   "e",
    "exit",       "emission", "emergent", "obs",      "observer", "observation",
    "sensor",     "camera",   "det",      "detector", "receiver"};
// Words that need no word for an angle beside them.
constexpr std::string_view kIncidentAlone[] = {
    "inc",          "incident",   "incidence", "incoming",       "aoi",           "ti",
    "thi",          "sza",        "einfall",   "einfallswinkel", "einfallwinkel", "dincidence",
    "deincidencia", "diincidenza"};
constexpr std::string_view kOutgoingAlone[] = {"outgoing",
                                               "scatter",
                                               "scattered",
                                               "scattering",
                                               "view",
                                               "viewing",
                                               "exit",
                                               "emission",
                                               "detector",
                                               "receiver",
                                               "to",
                                               "tho",
                                               "tr",
                                               "thr",
                                               "vza",
                                               "dobservation",
                                               "deobservacion",
                                               "diosservazione",
                                               "ausfallswinkel",
                                               "ausfallwinkel",
                                               "beobachtungswinkel",
                                               "streuwinkel",
                                               "detektorwinkel"};

// "angle from specular", "theta_s - theta_spec", "off-specular angle".
constexpr std::string_view kFromMirror[] = {"fromspec",   "tospec",    "offspec",
                                            "deltaspec",  "minusspec", "aspecular",
                                            "frommirror", "tomirror",  "sthetaspec"};

// Role of a theta or phi by the rest of its name.
std::optional<Role> RoleBySide(std::string_view side, Role incident, Role outgoing, Role unsaid) {
  if (side.empty()) return unsaid;
  if (IsOneOf(side, kIncident)) return incident;
  if (IsOneOf(side, kOutgoing)) return outgoing;
  return std::nullopt;
}

std::optional<Role> RoleByWords(std::string_view key, std::span<const std::string_view> words,
                                Role incident, Role outgoing, Role unsaid) {
  for (const std::string_view word : words) {
    std::optional<Role> role;
    if (key.starts_with(word)) {
      role = RoleBySide(key.substr(word.size()), incident, outgoing, unsaid);
    }
    if (!role && key.ends_with(word)) {
      role = RoleBySide(key.substr(0, key.size() - word.size()), incident, outgoing, unsaid);
    }
    if (role) return role;
  }
  return std::nullopt;
}

std::optional<Role> AngleRole(std::string key) {
  if (key == "angle") return Role::kTheta;
  if (std::ranges::any_of(kFromMirror, [&](std::string_view word) {
        return key.find(word) != std::string::npos;
      })) {
    return Role::kFromMirror;
  }
  for (const std::string_view word : {"angle", "angulo", "angolo", "of"}) {
    if (const size_t at = key.find(word); at != std::string::npos) key.erase(at, word.size());
  }
  if (IsOneOf(key, kIncidentAlone)) return Role::kThetaI;
  if (IsOneOf(key, kOutgoingAlone)) return Role::kThetaO;
  if (key == "pi" || key == "saa") return Role::kPhiI;
  if (key == "po" || key == "pr" || key == "vaa") return Role::kPhiO;
  if (key == "dphi" || key == "deltaphi" || key == "relativeazimuth" || key == "raa") {
    return Role::kPhi;
  }
  if (const auto role = RoleByWords(key, kThetaWords, Role::kThetaI, Role::kThetaO, Role::kTheta)) {
    return role;
  }
  return RoleByWords(key, kPhiWords, Role::kPhiI, Role::kPhiO, Role::kPhi);
}

// --- Values --------------------------------------------------------------------------------------

constexpr std::string_view kValues[] = {"brdf", "bsdf",  "bdrf", "frdb", "reflectance",
                                        "rho",  "value", "val",  "fr",   "f"};

std::optional<Role> ColorRole(std::string_view word) {
  if (word == "r" || word == "red") return Role::kRed;
  if (word == "g" || word == "green") return Role::kGreen;
  if (word == "b" || word == "blue") return Role::kBlue;
  return std::nullopt;
}

std::optional<Role> ValueRole(std::string text) {
  for (const std::string_view suffix : {"persr", "1sr", "sr1"}) TakeSuffix(suffix, &text);
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

// [nm] "550", "550nm", "0.55 um", "brdf_550", "lambda=550nm"; none for what is no wavelength.
std::optional<double> WavelengthIn(std::string_view plain, std::string_view unit) {
  const size_t first = std::min(plain.find_first_of("0123456789"), plain.size());
  const std::string_view before = plain.substr(0, first);
  const std::string word = LettersAndDigits(before);
  if (IsSigned(before)) return std::nullopt;
  if (!word.empty() && word != "lambda" && word != "wl" && word != "wavelength" && word != "r" &&
      !IsOneOf(word, kValues)) {
    return std::nullopt;
  }
  const std::string_view rest = plain.substr(first);
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
    return;
  }
  std::string key = LettersAndDigits(plain);
  column->scale = TakeScale(&key);
  if (key == "wavelength" || key == "lambda" || key == "wl") {
    column->role = Role::kWavelength;
  } else if (const auto value = ValueRole(key)) {
    column->role = *value;
  } else {
    for (const std::string_view unit : kAngleUnits) {
      if (!TakeSuffix(unit, &key)) continue;
      column->unit = unit;
      break;
    }
    column->role = AngleRole(key).value_or(Role::kOther);
  }
}

// --- Layout --------------------------------------------------------------------------------------

class ColumnLayouter {
 public:
  ColumnLayouter(const TextLines& lines, const std::vector<TableColumn>& columns)
      : lines_(lines), layout_{.columns = columns}, is_read_(columns.size()) {}

  ColumnLayout Lay(const GivenAngles& given, bool prefers_bands) {
    LayAngles(given);
    LayValues(prefers_bands);
    for (size_t k = 0; k < is_read_.size(); ++k) {
      if (!is_read_[k]) layout_.left_out.push_back(k);
    }
    return std::move(layout_);
  }

 private:
  std::vector<size_t> All(Role role) const {
    std::vector<size_t> found;
    for (size_t k = 0; k < layout_.columns.size(); ++k) {
      if (layout_.columns[k].role == role) found.push_back(k);
    }
    return found;
  }

  std::optional<size_t> One(Role role) {
    const std::vector<size_t> found = All(role);
    if (found.empty()) return std::nullopt;
    if (found.size() > 1) FailAsTheSame(found[0], found[1]);
    is_read_[found[0]] = true;
    return found[0];
  }

  [[noreturn]] void FailAsTheSame(size_t one, size_t other) const {
    lines_.Fail("the header has " + std::to_string(layout_.columns.size()) + " columns, and '" +
                layout_.columns[one].name + "' and '" + layout_.columns[other].name +
                "' say the same; --columns=" + kUsualColumns +
                " names those to read, - the others");
  }

  [[noreturn]] void FailWithout(const std::string& column, const std::string& advice) const {
    lines_.Fail("the header has no column " + column + advice);
  }

  void LayAngles(const GivenAngles& given) {
    constexpr Role kRoles[kAngles] = {Role::kThetaI, Role::kPhiI, Role::kThetaO, Role::kPhiO};
    for (int k = 0; k < kAngles; ++k) layout_.angles[k] = One(kRoles[k]);
    auto& [theta_i, phi_i, theta_o, phi_o] = layout_.angles;
    if (!theta_i && !given.theta_i && given.theta_o) theta_i = One(Role::kTheta);
    if (!theta_i && !given.theta_i) {
      FailWithout("theta_i", std::string("; --theta_i=DEGREES gives it, and --columns=") +
                                 kUsualColumns + " names columns");
    }
    if (!theta_o && !given.theta_o) theta_o = One(Role::kTheta);
    if (!theta_o && !given.theta_o && !phi_i && !phi_o && All(Role::kPhi).empty()) {
      theta_o = One(Role::kFromMirror);
      layout_.from_mirror = theta_o.has_value();
    }
    if (!theta_o && !given.theta_o) {
      FailWithout("theta_o", std::string("; --theta_o=DEGREES gives it, and --columns=") +
                                 kUsualColumns + " names columns");
    }
    if (!phi_o && !phi_i) phi_o = One(Role::kPhi);
    if (!phi_o && phi_i) {
      FailWithout("phi_o", std::string("; it must be ") + kUsualColumns + ", in any order");
    }
    for (int k = 0; k < kAngles; ++k) {
      if (layout_.angles[k]) layout_.units[k] = UnitOf(layout_.columns[*layout_.angles[k]]);
    }
  }

  // [rad]
  double UnitOf(const TableColumn& column) const {
    if (const auto radians = RadiansIn(column.unit)) return *radians;
    lines_.Fail("column '" + column.name +
                "' is neither in degrees nor in radians or gon; convert it");
  }

  void LayValues(bool prefers_bands) {
    const auto red = All(Role::kRed), green = All(Role::kGreen), blue = All(Role::kBlue);
    const auto values = All(Role::kValue), bands = All(Role::kBand);
    layout_.wavelength = One(Role::kWavelength);
    const bool takes_bands = prefers_bands && !bands.empty();
    if (!takes_bands && !green.empty() && !blue.empty()) {
      const Role first = red.empty() ? Role::kValue : Role::kRed;  // "fr" beside "fg" and "fb"
      for (const Role role : {first, Role::kGreen, Role::kBlue}) {
        if (const auto column = One(role)) layout_.values.push_back(*column);
      }
      if (layout_.values.size() < kChannels) FailWithout("r", " beside those of g and b");
    } else if (takes_bands || bands.size() > 1) {
      LayBands(bands);
    } else if (!values.empty()) {
      layout_.values = {*One(Role::kValue)};
    } else if (red.size() + green.size() + blue.size() == 1) {
      layout_.values = {
          *One(red.empty() ? green.empty() ? Role::kBlue : Role::kGreen : Role::kRed)};
    } else if (!bands.empty()) {
      layout_.values = {*One(Role::kBand)};
      layout_.wavelengths = {layout_.columns[layout_.values[0]].wavelength};
    } else {
      FailWithout("of values",
                  std::string(", as r, g, b, or brdf, or wavelengths as 550nm; --columns=") +
                      kUsualColumns + " names columns, - those to leave out");
    }
    for (const size_t k : layout_.values) {
      const TableColumn& column = layout_.columns[k];
      if (!IsOneOf(column.unit, kNoBrdf)) continue;
      lines_.Fail("column '" + column.name + "' is in " + column.unit +
                  ", and a BRDF is in 1/sr; convert it");
    }
  }

  void LayBands(std::vector<size_t> bands) {
    const auto wavelength = [&](size_t k) { return layout_.columns[k].wavelength; };
    std::ranges::sort(bands, {}, wavelength);
    const auto twice = std::ranges::adjacent_find(bands, {}, wavelength);
    if (twice != bands.end()) FailAsTheSame(*twice, *std::next(twice));
    for (const size_t k : bands) {
      is_read_[k] = true;
      layout_.wavelengths.push_back(wavelength(k));
    }
    layout_.values = std::move(bands);
  }

  const TextLines& lines_;
  ColumnLayout layout_;
  std::vector<bool> is_read_;
};

}  // namespace

TableColumn ColumnNamed(std::string_view name) {
  TableColumn column{.name = std::string(name)};
  column.is_usual_name = std::ranges::find(kUsualNames, name) != std::end(kUsualNames);
  std::string plain = Plain(name);
  const std::string whole = plain, bracket = TakeBracket(&plain);
  if (const auto unit = UnitIn(bracket)) {
    column.unit = *unit;
  } else if (!bracket.empty()) {  // "theta (incident)" and "r (red)"
    SetRole(whole, &column);
    if (column.role != Role::kOther) return column;
  }
  SetRole(plain, &column);
  if (column.unit == "db") column.scale = ValueScale::kDecibels;
  return column;
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

std::vector<std::string> RenamedColumns(const ColumnLayout& layout) {
  std::vector<std::string> renamed;
  const auto add = [&](size_t column, const char* usual) {
    const std::string& name = layout.columns[column].name;
    std::string plain = Plain(name);
    TakeBracket(&plain);
    std::string key = LettersAndDigits(plain);
    for (const std::string_view unit : kAngleUnits) TakeSuffix(unit, &key);
    if (key != LettersAndDigits(usual)) renamed.push_back(Quoted(name) + " as " + usual);
  };
  for (int k = 0; k < kAngles; ++k) {
    if (layout.angles[k]) add(*layout.angles[k], kUsualNames[k]);
  }
  if (!layout.wavelengths.empty()) return renamed;
  for (size_t k = 0; k < layout.values.size(); ++k) {
    if (layout.columns[layout.values[k]].role == Role::kValue) continue;
    add(layout.values[k], layout.values.size() == 1 ? "f" : kUsualNames[kAngles + k]);
  }
  return renamed;
}

std::string LeftOutColumns(const ColumnLayout& layout) {
  constexpr size_t kMost = 5;
  std::string text;
  for (size_t k = 0; k < std::min(layout.left_out.size(), kMost); ++k) {
    text += (k > 0 ? ", " : "") + Quoted(layout.columns[layout.left_out[k]].name);
  }
  if (layout.left_out.size() <= kMost) return text;
  return text + " and " + std::to_string(layout.left_out.size() - kMost) + " more";
}

ColumnLayout LayoutOf(const TextLines& lines, const std::vector<TableColumn>& columns,
                      const GivenAngles& given, bool prefers_bands) {
  return ColumnLayouter(lines, columns).Lay(given, prefers_bands);
}

}  // namespace trilobe
