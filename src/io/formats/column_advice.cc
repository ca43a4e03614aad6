#include "io/formats/column_advice.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

namespace trilobe {
namespace {

struct Known {
  std::string_view key;  // letters and digits of the name, in lower case
  std::string_view holds;
  std::string_view flag;  // besides --columns; "": there is none
};

constexpr std::string_view kTimesCosine = "f times cos theta_o", kOverCosine = "--cosine=o:1";
constexpr std::string_view kFactor = "pi f", kOverPi = "--scale=0.3183";
constexpr std::string_view kReading =
    "what a detector reads; a BRDF is that over the irradiance of the sample";

constexpr std::string_view kPolarised = "light of one polarisation; give the mean of both, as f";

constexpr Known kKnownValues[] = {
    {"ccbrdf", kTimesCosine, kOverCosine},
    {"ccbsdf", kTimesCosine, kOverCosine},
    {"cosinecorrectedbrdf", kTimesCosine, kOverCosine},
    {"brdfcos", kTimesCosine, kOverCosine},
    {"brdfcostheta", kTimesCosine, kOverCosine},
    {"brdfcosthetao", kTimesCosine, kOverCosine},
    {"brdfcosthetas", kTimesCosine, kOverCosine},
    {"cosbrdf", kTimesCosine, kOverCosine},
    {"reflectancefactor", kFactor, kOverPi},
    {"reflfactor", kFactor, kOverPi},
    {"bidirectionalreflectancefactor", kFactor, kOverPi},
    {"brf", kFactor, kOverPi},
    {"counts", kReading, ""},
    {"intensity", kReading, ""},
    {"signal", kReading, ""},
    {"voltage", kReading, ""},
    {"power", kReading, ""},
    {"radiance", kReading, ""},
    {"luminance", kReading, ""},
    {"btdf", "transmitted light, which is not read; the BRDF is what is reflected", ""},
    {"log10", "logarithms; a BRDF is ten to that power", ""},
    {"log10brdf", "logarithms; a BRDF is ten to that power", ""},
    {"dhr", "the reflectance of a hemisphere; a BRDF is by pairs of directions", ""},
    {"brdfs", kPolarised, ""},
    {"brdfp", kPolarised, ""},
};

std::string KeyOf(const TableColumn& column) {
  std::string key;
  for (const char c : column.name.substr(0, column.name.find_first_of("[("))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return key;
}

bool Has(const std::vector<TableColumn>& columns, std::string_view key) {
  return std::ranges::any_of(columns,
                             [&](const TableColumn& column) { return KeyOf(column) == key; });
}

std::string Described(const std::vector<TableColumn>& columns, size_t k, const Known& known) {
  std::string text = "column '" + columns[k].name + "' holds ";
  text += known.holds;
  if (known.flag.empty()) return text;
  std::string flag(known.flag);
  if (columns[k].unit == "%" || columns[k].unit == "percent") {
    text = "column '" + columns[k].name + "' holds percents of " + std::string(known.holds);
    if (known.flag == kOverPi) flag = "--scale=0.003183";
  }
  return text + "; type " + ColumnsFlag(columns, k) + " " + flag;
}

std::string AdviceOnValues(const std::vector<TableColumn>& columns) {
  for (size_t k = 0; k < columns.size(); ++k) {
    const auto* const known = std::ranges::find(kKnownValues, KeyOf(columns[k]), &Known::key);
    if (known != std::end(kKnownValues)) return Described(columns, k, *known);
  }
  if (Has(columns, "x") && Has(columns, "y") && Has(columns, "z")) {
    return "X, Y, Z are not read in tables; make them linear sRGB, as r, g, b";
  }
  return {};
}

std::string AdviceOnAngles(const std::vector<TableColumn>& columns) {
  for (const std::string_view vector : {"wix", "ix", "lx", "inx", "lightx", "xi"}) {
    if (!Has(columns, vector)) continue;
    return "directions are vectors; make them angles, or give them to trilobe.Measurement(wi, wo, "
           "rho) in Python";
  }
  // "BRDF at 10 deg", "BRDF at 30 deg"
  const auto has_number = [](const TableColumn& column) {
    return column.role == ColumnRole::kOther &&
           column.name.find_first_of("0123456789") != std::string::npos;
  };
  if (std::ranges::count_if(columns, has_number) > 1) {
    return "no column theta_i; --columns=theta_o/theta_i says that a row is a theta_o and a column "
           "a theta_i, of those in its name";
  }
  const bool half = Has(columns, "thetah") || Has(columns, "thetahalf");
  if (half && (Has(columns, "thetad") || Has(columns, "thetadiff"))) {
    return "theta_h and theta_d are angles of the half and difference vectors; make them theta_i, "
           "phi_i, theta_o, phi_o, or write an ALTA file (#PARAM_IN RUSIN_TH_TD_PD)";
  }
  return {};
}

}  // namespace

std::string ColumnsFlag(const std::vector<TableColumn>& columns, size_t as_f) {
  std::string text = "--columns=";
  for (size_t k = 0; k < columns.size(); ++k) {
    const ColumnRole role = columns[k].role;
    text += k > 0 ? "," : "";
    text += k == as_f                                                   ? "f"
            : role == ColumnRole::kThetaI                               ? "theta_i"
            : role == ColumnRole::kPhiI                                 ? "phi_i"
            : role == ColumnRole::kThetaO || role == ColumnRole::kTheta ? "theta_o"
            : role == ColumnRole::kPhiO || role == ColumnRole::kPhi     ? "phi_o"
                                                                        : "-";
  }
  return text;
}

std::string AdviceOn(const std::vector<TableColumn>& columns, bool theta_i_is_given) {
  const auto has = [&](auto is) {
    return std::ranges::any_of(columns, [&](const TableColumn& column) { return is(column.role); });
  };
  if (!theta_i_is_given && !has([](ColumnRole role) { return role == ColumnRole::kThetaI; })) {
    return AdviceOnAngles(columns);
  }
  const bool has_values =
      has([](ColumnRole role) { return role >= ColumnRole::kRed && role <= ColumnRole::kBand; });
  return has_values ? "" : AdviceOnValues(columns);
}

}  // namespace trilobe
