#include "io/formats/text/column_layout.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "io/formats/text/column_words.h"
#include "io/formats/text/columns_flag.h"
#include "io/formats/text/value_advice.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/printable.h"

namespace trilobe {
namespace {

using Role = ColumnRole;

constexpr std::string_view kNoBrdf[] = {"%", "percent"};

// A name in quotes for a note, in UTF-8.
std::string Quoted(std::string_view name) {
  constexpr size_t kLongest = 40;
  return std::string("'").append(Printable(name.substr(0, kLongest))).append("'");
}

class ColumnLayouter {
 public:
  ColumnLayouter(const TextLines& lines, const std::vector<TableColumn>& columns,
                 const FirstRows& rows)
      : lines_(lines), rows_(rows), layout_{.columns = columns}, is_read_(columns.size()) {}

  ColumnLayout Lay(const GivenAngles& given, bool prefers_bands) {
    LayAngles(given);
    LayValues(prefers_bands, /*may_lack=*/given.values);
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
    const auto is_word = [&](size_t k) { return layout_.columns[k].is_word; };
    if (!std::ranges::all_of(found, is_word)) std::erase_if(found, is_word);
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
    const std::string names = std::to_string(layout_.columns.size()) + " columns, and '" +
                              layout_.columns[one].name + "' and '" + layout_.columns[other].name;
    const bool is_value = layout_.columns[one].role >= Role::kRed;
    lines_.Fail("the header has " + names + "' say the same; " +
                    ColumnsFlag(layout_.columns, is_value ? one : ValueColumn()) +
                    " names those to read, - the others",
                ErrorKind::kConflict, layout_.columns[one].name, layout_.columns[other].name);
  }

  [[noreturn]] void FailWithout(const std::string& column, const std::string& advice) const {
    lines_.Fail("the header has no column " + column + advice, ErrorKind::kMissing, column);
  }

  // The columns that no name tells, and that hold numbers.
  std::vector<std::string> Unread() const {
    std::vector<std::string> names;
    for (size_t k = 0; k < layout_.columns.size(); ++k) {
      const TableColumn& column = layout_.columns[k];
      const bool is_unknown = column.role == Role::kOther && !column.is_by_flag;
      const bool can_be_named =
          !column.name.empty() && column.name.find_first_of(",=") == std::string::npos;
      if (is_unknown && can_be_named && rows_.IsOfNumbers(k)) names.push_back(column.name);
    }
    return names;
  }

  static std::string Either(const std::vector<std::string>& names) {
    constexpr size_t kMost = 5;
    std::string text;
    for (size_t k = 0; k < std::min(names.size(), kMost); ++k) {
      text += (k == 0 ? "" : k + 1 == names.size() ? " or " : ", ") + Quoted(names[k]);
    }
    return text;
  }

  // The last column that may hold values.
  size_t ValueColumn() const {
    for (size_t k = layout_.columns.size(); k-- > 0;) {
      const Role role = layout_.columns[k].role;
      if ((role >= Role::kRed && role <= Role::kBand) || role == Role::kOther) return k;
    }
    return layout_.columns.size();
  }

  bool HasValues() const {
    return std::ranges::any_of(layout_.columns, [](const TableColumn& column) {
      return column.role >= Role::kRed && column.role <= Role::kBand;
    });
  }

  [[noreturn]] void FailWithoutTheta(const GivenAngles& given) const {
    const bool lacks_i = !layout_.angles[0] && !given.theta_i;
    const bool lacks_o = !given.theta_o && !layout_.angles[2] && All(Role::kTheta).empty() &&
                         All(Role::kFromMirror).empty();
    const std::string column = lacks_i ? "theta_i" : "theta_o";
    std::vector<std::string> unread = Unread();
    std::erase_if(unread, [](const std::string& name) { return IsKnownValue(ColumnNamed(name)); });
    if (unread.empty()) {
      FailWithout(column, "; --" + column + "=DEGREES gives it, and --columns=" +
                              ExampleColumns(layout_.columns.size()) + " names columns");
    }
    std::string flag = "--columns=";
    size_t next = 0;
    const auto name = [&](bool lacks, const char* what) {
      if (!lacks || next == unread.size()) return;
      flag += (flag.ends_with("--columns=") ? "" : ",") + std::string(what) + "=" + unread[next];
      ++next;
    };
    name(lacks_i, "theta_i");
    name(lacks_o, "theta_o");
    if (!HasValues() && next < unread.size()) {
      next = unread.size() - 1;
      name(true, "f");
    }
    FailWithout(column, "; if it is " + Either(unread) + ", type " + Quotable(flag) +
                            (lacks_o ? ", or from_mirror=NAME if it is counted from the mirror "
                                       "direction"
                                     : ""));
  }

  void LayAngles(const GivenAngles& given) {
    constexpr Role kRoles[kAngles] = {Role::kThetaI, Role::kPhiI, Role::kThetaO, Role::kPhiO};
    for (int k = 0; k < kAngles; ++k) layout_.angles[k] = One(kRoles[k]);
    auto& [theta_i, phi_i, theta_o, phi_o] = layout_.angles;
    if (!theta_i && !given.theta_i && given.theta_o) theta_i = One(Role::kTheta);
    if (!theta_i && !given.theta_i) FailWithoutTheta(given);
    if (!theta_o && !given.theta_o) theta_o = One(Role::kTheta);
    if (!theta_o && !given.theta_o) {
      theta_o = One(Role::kFromMirror);
      layout_.from_mirror = theta_o.has_value();
    }
    if (!theta_o && !given.theta_o) FailWithoutTheta(given);
    if (!phi_o && !phi_i) phi_o = One(Role::kPhi);
    if (!phi_o && !phi_i && !layout_.from_mirror) layout_.phase = One(Role::kPhase);
    if (layout_.phase) UnitOf(layout_.columns[*layout_.phase]);  // throws for others
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
    lines_.Fail(
        "column '" + column.name + "' is neither in degrees nor in radians or gon; convert it",
        ErrorKind::kUnsupported, column.name, column.unit);
  }

  void LayValues(bool prefers_bands, bool may_lack) {
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
    } else if (const std::vector<size_t> polarised = All(Role::kPolarised); !polarised.empty()) {
      layout_.is_polarised = true;
      layout_.values = polarised;
      for (const size_t k : polarised) is_read_[k] = true;
    } else if (red.size() + green.size() + blue.size() == 1) {
      layout_.values = {
          *One(red.empty() ? green.empty() ? Role::kBlue : Role::kGreen : Role::kRed)};
    } else if (!bands.empty()) {
      layout_.values = {*One(Role::kBand)};
      layout_.wavelengths = {layout_.columns[layout_.values[0]].wavelength};
    } else if (const std::optional<size_t> other = OtherBrdf()) {
      layout_.values = {*other};
      is_read_[*other] = true;
    } else if (!may_lack) {
      const std::vector<std::string> unread = Unread();
      const std::string begin = ", as r, g, b, or brdf, or wavelengths as 550nm; ";
      if (All(Role::kOther).empty()) {
        FailWithout("of values", begin +
                                     "these are directions alone; add what you measured at "
                                     "each, in 1/sr");
      }
      if (unread.empty()) {
        FailWithout("of values", begin + "--columns=" + ExampleColumns(layout_.columns.size()) +
                                     " names columns, - those to leave out");
      }
      FailWithout("of values", begin + "if " + Either(unread) + " holds f in 1/sr, type " +
                                   Quotable("--columns=f=" + unread.back()));
    }
    for (const size_t k : layout_.values) {
      const TableColumn& column = layout_.columns[k];
      if (!IsOneOf(column.unit, kNoBrdf)) continue;
      lines_.Fail("column '" + column.name + "' is in " + column.unit +
                      ", and a BRDF is in 1/sr; convert it",
                  ErrorKind::kUnsupported, column.name, column.unit);
    }
  }

  // The only column whose name begins so, as "brdf_data_1D".
  std::optional<size_t> OtherBrdf() const {
    std::vector<size_t> others = All(Role::kOther);
    std::erase_if(others, [&](size_t k) {
      const std::string plain = Plain(layout_.columns[k].name);
      return !plain.starts_with("brdf") && !plain.starts_with("bsdf");
    });
    return others.size() == 1 ? std::optional(others[0]) : std::nullopt;
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
  const FirstRows& rows_;
  ColumnLayout layout_;
  std::vector<bool> is_read_;
};

}  // namespace

std::vector<std::string> RenamedColumns(const ColumnLayout& layout) {
  std::vector<std::string> renamed;
  const auto add = [&](size_t column, const char* usual) {
    const TableColumn& of = layout.columns[column];
    const std::string as = of.from_horizon ? " as 90 deg minus " : " as ";
    if (!IsCalled(of.name, usual)) renamed.push_back(Quoted(of.name) + as + usual);
  };
  for (int k = 0; k < kAngles; ++k) {
    if (layout.angles[k]) add(*layout.angles[k], kUsualNames[k]);
  }
  if (layout.phase && IsCalled(layout.columns[*layout.phase].name, "phi")) {
    add(*layout.phase, "the phase, which it is where i or e is 0");
  }
  if (layout.is_polarised) {
    std::string names;
    for (const size_t k : layout.values) {
      names += (names.empty() ? "" : ", ") + Quoted(layout.columns[k].name);
    }
    renamed.push_back("half the sum of " + names + ", for light that is not polarised");
  }
  if (!layout.wavelengths.empty() || layout.is_polarised) return renamed;
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

bool MayBeFactor(const ColumnLayout& layout) {
  if (layout.values.empty()) return false;
  const TableColumn& first = layout.columns[layout.values[0]];
  const bool is_r = layout.values.size() == 1 && first.role == Role::kRed && !first.per_steradian;
  return (is_r && !first.is_by_flag) || std::ranges::any_of(layout.values, [&](size_t k) {
           return layout.columns[k].is_reflectance;
         });
}

ColumnLayout LayoutOf(const TextLines& lines, const std::vector<TableColumn>& columns,
                      const GivenAngles& given, const FirstRows& rows, bool prefers_bands) {
  return ColumnLayouter(lines, columns, rows).Lay(given, prefers_bands);
}

}  // namespace trilobe
