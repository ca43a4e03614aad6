#include "io/formats/text/value_advice.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>

#include "io/formats/text/band_advice.h"
#include "io/formats/text/column_words.h"
#include "io/formats/text/columns_flag.h"

namespace trilobe {
namespace {

struct KnownColumn {
  std::string_view key;  // letters and digits of the name, in lower case
  std::string_view holds;
  std::string_view flag;  // besides --columns; "": there is none
};

constexpr std::string_view kTimesCosine = "f times cos theta_o", kOverCosine = "--cosine=o:1";
constexpr std::string_view kFactor = "pi f", kOverPi = "--scale=0.3183";
constexpr std::string_view kRadianceFactor = "pi f times cos theta_i",
                           kOverPiCosine = "--cosine=1 --scale=0.3183";
constexpr std::string_view kReading =
    "what a detector reads; a BRDF is that over the irradiance of the sample";

constexpr std::string_view kNone = "none";

constexpr std::string_view kPolarised = "light of one polarisation; give the mean of both, as f";

constexpr std::string_view kMueller =
    "the first element of a Mueller matrix, f of light that is not polarised";

constexpr KnownColumn kKnownValues[] = {
    {"ccbrdf", kTimesCosine, kOverCosine},
    {"ccbsdf", kTimesCosine, kOverCosine},
    {"cosinecorrectedbrdf", kTimesCosine, kOverCosine},
    {"ars", kTimesCosine, kOverCosine},  // angle resolved scattering
    {"dsf", kTimesCosine, kOverCosine},
    {"bdr", "f times cos theta_i, as Hapke's bidirectional reflectance", "--cosine=1"},
    {"reflectancefactor", kFactor, kOverPi},
    {"reflfactor", kFactor, kOverPi},
    {"bidirectionalreflectancefactor", kFactor, kOverPi},
    {"brf", kFactor, kOverPi},
    {"reff", kFactor, kOverPi},
    {"hdrf", kFactor, kOverPi},
    {"hcrf", kFactor, kOverPi},
    {"radiancefactor", kFactor, kOverPi},
    {"luminancefactor", kFactor, kOverPi},
    {"leuchtdichtefaktor", kFactor, kOverPi},
    {"strahldichtefaktor", kFactor, kOverPi},
    {"reflexionsfaktor", kFactor, kOverPi},
    {"facteurdereflexion", kFactor, kOverPi},
    {"facteurdereflectance", kFactor, kOverPi},
    {"facteurdeluminance", kFactor, kOverPi},
    {"factordereflectancia", kFactor, kOverPi},
    {"fattorediriflessione", kFactor, kOverPi},
    {"beta", "the radiance factor of CIE, pi f", kOverPi},
    {"radf", kRadianceFactor, kOverPiCosine},
    {"if", kRadianceFactor, kOverPiCosine},
    {"iof", kRadianceFactor, kOverPiCosine},
    {"counts", kReading, ""},
    {"intensity", kReading, ""},
    {"signal", kReading, ""},
    {"voltage", kReading, ""},
    {"power", kReading, ""},
    {"radiance", kReading, ""},
    {"luminance", kReading, ""},
    {"btdf", "transmitted light, which is not read; the BRDF is what is reflected", ""},
    {"transmittance", "transmitted light, which is not read; the BRDF is what is reflected", ""},
    {"dhr", "the reflectance of a hemisphere; a BRDF is by pairs of directions", ""},
    {"brdfs", kPolarised, ""},
    {"brdfp", kPolarised, ""},
    {"m00", kMueller, kNone},
    {"m11", kMueller, kNone},
    {"mueller00", kMueller, kNone},
    {"mueller11", kMueller, kNone},
    {"f00", kMueller, kNone},
    {"f11", kMueller, kNone},
    {"s0", "the first Stokes parameter, f of light that is not polarised", kNone},
};

std::string Described(const std::vector<TableColumn>& columns, size_t k, const KnownColumn& known) {
  std::string text = "column '" + columns[k].name + "' holds ";
  text += known.holds;
  if (known.flag.empty()) return text;
  std::string flag(known.flag);
  if (columns[k].unit == "%" || columns[k].unit == "percent") {
    text = "column '" + columns[k].name + "' holds percents of " + std::string(known.holds);
    if (known.flag == kOverPi) flag = "--scale=0.003183";
  }
  return text + "; type " + ColumnsFlag(columns, k) + (flag == kNone ? "" : " " + flag);
}

bool Has(const std::vector<TableColumn>& columns, std::string_view key) {
  return std::ranges::any_of(columns,
                             [&](const TableColumn& column) { return KeyOf(column) == key; });
}

constexpr std::string_view kBrdf[] = {"brdf", "bsdf", "bdrf", "fr", "f"};

// "BRDF*cos", "f_r cos(theta_o)", "cos BRDF", "brdf_times_pi", "pi f": f times something; and
// "BRDF/cos".
std::optional<KnownColumn> ProductNamed(const std::string& name) {
  const std::string plain = Plain(name);
  std::string key = LettersAndDigits(plain);
  for (const std::string_view unit : {"1sr", "sr1"}) TakeSuffix(unit, &key);
  if (const size_t at = key.find("times"); at != std::string::npos) key.erase(at, 5);
  const size_t slash = plain.find('/');
  const bool is_over = slash != std::string::npos && plain.find("sr", slash) == std::string::npos;
  const auto holds = [&](std::string_view times, std::string_view flag, std::string_view over,
                         std::string_view flag_over) {
    return KnownColumn{
        .key = "", .holds = is_over ? over : times, .flag = is_over ? flag_over : flag};
  };
  for (const std::string_view brdf : kBrdf) {
    std::string rest;
    if (key.starts_with(brdf)) {
      rest = key.substr(brdf.size());
    } else if (key.ends_with(brdf) && !is_over) {
      rest = key.substr(0, key.size() - brdf.size());
    }
    if (rest == "pi") return holds(kFactor, kOverPi, "f over pi", "--scale=3.1416");
    if (!rest.starts_with("cos")) continue;
    rest.erase(0, 3);
    if (rest.starts_with("theta")) rest.erase(0, 5);
    constexpr std::string_view kOutgoing[] = {"", "o", "s", "r", "v", "e", "out", "obs"};
    if (IsOneOf(rest, kOutgoing)) {
      return holds(kTimesCosine, kOverCosine, "f over cos theta_o", "--cosine=o:-1");
    }
    if (rest == "i" || rest == "in" || rest == "inc") {
      return holds("f times cos theta_i", "--cosine=1", "f over cos theta_i", "--cosine=-1");
    }
  }
  return std::nullopt;
}

}  // namespace

// Advice if the names of columns say that values are not a BRDF in 1/sr, else "".
std::string AdviceOnScale(const std::vector<TableColumn>& columns) {
  for (size_t k = 0; k < columns.size(); ++k) {
    const TableColumn& column = columns[k];
    const bool is_value = column.role >= ColumnRole::kRed && column.role <= ColumnRole::kValue;
    if (is_value && (column.unit == "%" || column.unit == "percent")) {
      return "column '" + column.name + "' is in percent, and a BRDF in 1/sr; type " +
             ColumnsFlag(columns, k) +
             " --scale=0.01, or --scale=0.003183 of the reflectance factor, pi f";
    }
  }
  return {};
}

bool IsKnownValue(const TableColumn& column) {
  const std::string key = KeyOf(column);
  if (key.starts_with("brdf") || key.starts_with("bsdf")) return true;
  if (key == "beta") return false;  // an angle, too
  return std::ranges::find(kKnownValues, key, &KnownColumn::key) != std::end(kKnownValues) ||
         ProductNamed(column.name).has_value();
}

std::string AdviceOnTransmission(const std::vector<TableColumn>& columns) {
  for (size_t k = 0; k < columns.size(); ++k) {
    if (columns[k].role != ColumnRole::kOther || !KeyOf(columns[k]).starts_with("btdf")) continue;
    return Described(columns, k, *std::ranges::find(kKnownValues, "btdf", &KnownColumn::key));
  }
  return {};
}

std::string AdviceOnValues(const std::vector<TableColumn>& columns, const FirstRows& rows) {
  if (std::string advice = AdviceOnTransmission(columns); !advice.empty()) return advice;
  for (size_t k = 0; k < columns.size(); ++k) {
    if (columns[k].role != ColumnRole::kOther) continue;
    const std::string key = KeyOf(columns[k]);
    if (key == "log" || key == "logbrdf" || key == "logbsdf") {
      return "column '" + columns[k].name + "' holds logarithms; type " +
             ColumnsFlag(columns, k, "log10") + ", or ln in the place of log10";
    }
    if (const auto product = ProductNamed(columns[k].name)) {
      return Described(columns, k, *product);
    }
    const auto* const known = std::ranges::find(kKnownValues, key, &KnownColumn::key);
    if (known != std::end(kKnownValues)) return Described(columns, k, *known);
  }
  if (Has(columns, "x") && Has(columns, "y") && Has(columns, "z")) {
    return "X, Y, Z are not read in tables; make them linear sRGB, as r, g, b";
  }
  return AdviceOnBands(columns, rows);
}

}  // namespace trilobe
