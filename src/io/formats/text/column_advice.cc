#include "io/formats/text/column_advice.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/base/text.h"
#include "io/formats/text/angle_names.h"
#include "trilobe/core/base/angles.h"

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

constexpr KnownColumn kKnownValues[] = {
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
    {"reff", kFactor, kOverPi},
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
    {"dhr", "the reflectance of a hemisphere; a BRDF is by pairs of directions", ""},
    {"brdfs", kPolarised, ""},
    {"brdfp", kPolarised, ""},
    {"m11", "an element of a Mueller matrix, f of light that is not polarised", kNone},
    {"mueller11", "an element of a Mueller matrix, f of light that is not polarised", kNone},
};

// Sensors that number their bands.
struct Sensor {
  std::string_view name;
  std::vector<std::pair<std::string_view, int>> bands;  // keys, wavelengths [nm]
  std::array<int, 3> rgb;                               // [nm]
};
const Sensor kSensors[] = {{"MODIS",
                            {{"band1", 645},
                             {"band2", 859},
                             {"band3", 469},
                             {"band4", 555},
                             {"band5", 1240},
                             {"band6", 1640},
                             {"band7", 2130}},
                            {645, 555, 469}},
                           {"Sentinel-2",
                            {{"b01", 443},
                             {"b02", 490},
                             {"b03", 560},
                             {"b04", 665},
                             {"b05", 705},
                             {"b06", 740},
                             {"b07", 783},
                             {"b08", 842},
                             {"b8a", 865},
                             {"b11", 1610},
                             {"b12", 2190}},
                            {665, 560, 490}}};

// A flag as a shell takes it.
std::string Quotable(const std::string& flag) {
  const bool is_plain = flag.find_first_of(" \t'\"()[]|&;*$<>#`\\") == std::string::npos;
  return is_plain                               ? flag
         : flag.find('\'') == std::string::npos ? "'" + flag + "'"
                                                : "\"" + flag + "\"";
}

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

bool IsNumberedBand(const TableColumn& column) {
  const std::string key = KeyOf(column);
  const size_t digits = key.find_first_of("0123456789");
  const std::string word = key.substr(0, digits);
  return digits != std::string::npos && key.size() < digits + 3 &&
         (word == "band" || word == "b" || word == "ch" || word == "channel");
}

// "band1", "B02": which wavelengths these are a name does not say, but of known sensors.
std::string AdviceOnBands(const std::vector<TableColumn>& columns) {
  if (std::ranges::count_if(columns, IsNumberedBand) < 2) return {};
  const auto first = std::ranges::find_if(columns, IsNumberedBand);
  const auto named = [&](const Sensor& sensor) {
    std::string flag = ColumnsFlag(columns, columns.size());
    std::vector<std::string_view> cells = SplitCells(flag);
    std::string with;
    for (size_t k = 0; k < columns.size(); ++k) {
      const auto band = std::ranges::find(sensor.bands, KeyOf(columns[k]),
                                          &std::pair<std::string_view, int>::first);
      with += (k > 0 ? "," : "");
      with +=
          band == sensor.bands.end() ? std::string(cells[k]) : std::to_string(band->second) + "nm";
    }
    return with;
  };
  for (const Sensor& sensor : kSensors) {
    const bool knows_all = std::ranges::all_of(columns, [&](const TableColumn& column) {
      return !IsNumberedBand(column) ||
             std::ranges::find(sensor.bands, KeyOf(column),
                               &std::pair<std::string_view, int>::first) != sensor.bands.end();
    });
    if (!knows_all) continue;
    std::string flags = named(sensor);
    const bool has_rgb = std::ranges::all_of(sensor.rgb, [&](int wavelength) {
      return flags.find("," + std::to_string(wavelength) + "nm") != std::string::npos;
    });
    const auto& [red, green, blue] = sensor.rgb;
    if (has_rgb) {
      flags += " --bands=" + std::to_string(red) + "," + std::to_string(green) + "," +
               std::to_string(blue);
    }
    return "'" + first->name + "' and others are bands without a wavelength; if they are of " +
           std::string(sensor.name) + ", and reflectance factors, pi f, type " + flags + " " +
           std::string(kOverPi);
  }
  return "'" + first->name + "' and others are bands without a wavelength; name them so, as " +
         ColumnsFlag(columns, first - columns.begin(), "645nm");
}

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

std::string AdviceOnValues(const std::vector<TableColumn>& columns) {
  for (size_t k = 0; k < columns.size(); ++k) {
    const std::string key = KeyOf(columns[k]);
    if (key == "log" || key == "logbrdf" || key == "logbsdf") {
      return "column '" + columns[k].name + "' holds logarithms; type " +
             ColumnsFlag(columns, k, "log10") + ", or ln in the place of log10";
    }
    const auto* const known = std::ranges::find(kKnownValues, KeyOf(columns[k]), &KnownColumn::key);
    if (known != std::end(kKnownValues)) return Described(columns, k, *known);
  }
  if (Has(columns, "x") && Has(columns, "y") && Has(columns, "z")) {
    return "X, Y, Z are not read in tables; make them linear sRGB, as r, g, b";
  }
  return AdviceOnBands(columns);
}

// Coordinates of directions that are no angles: the begin of their keys, and what makes them so.
struct Coordinate {
  std::string_view begin, what;
};
constexpr std::string_view kSines =
    "a sine of an angle (beta), as of ray tracers; make it theta_o = asin(beta) in degrees, or of "
    "two theta_o = asin(sqrt(bx^2 + by^2)) and phi_o = atan2(by, bx)";
constexpr std::string_view kCosines = "a cosine; make it an angle in degrees by acos";
constexpr Coordinate kCoordinates[] = {
    {"beta", kSines},
    {"absbeta", kSines},
    {"bb0",
     "the distance of sines |beta - beta0| from the mirror direction, as of ABg models; make "
     "it theta_o = asin(beta0 + it) in degrees, with theta_i = asin(beta0)"},
    {"sintheta", kSines},
    {"bx", kSines},
    {"costheta", kCosines},
    {"cosi", kCosines},
    {"coso", kCosines},
    {"mu", kCosines}};

std::string AdviceOnCoordinates(const std::vector<TableColumn>& columns) {
  for (const TableColumn& column : columns) {
    if (column.role != ColumnRole::kOther) continue;
    const std::string key = KeyOf(column);
    for (const Coordinate& coordinate : kCoordinates) {
      // Checked before "beta": the distance between bars, |beta - beta0|.
      const bool is_distance = key.find("betabeta") != std::string::npos || key.starts_with("bb0");
      const bool fits = coordinate.begin == "bb0"
                            ? is_distance
                            : !is_distance && key.starts_with(coordinate.begin);
      if (fits) return "column '" + column.name + "' is " + std::string(coordinate.what);
    }
    if (key.find("gloss") != std::string::npos || key.find("45as") != std::string::npos) {
      return "column '" + column.name +
             "' is of gloss or colour at fixed angles, and no BRDF; one is measured at many pairs "
             "of directions";
    }
  }
  return {};
}

// An azimuth that is left out makes another measurement of a table.
std::string AdviceOnAzimuths(const std::vector<TableColumn>& columns) {
  const bool has_azimuth = std::ranges::any_of(columns, [](const TableColumn& column) {
    return column.role == ColumnRole::kPhiI || column.role == ColumnRole::kPhiO ||
           column.role == ColumnRole::kPhi || column.role == ColumnRole::kPhase;
  });
  if (has_azimuth) return {};
  const auto asked = std::ranges::find_if(columns, [](const TableColumn& column) {
    return column.role == ColumnRole::kOther && !column.is_by_flag && HasAzimuthWord(column.name);
  });
  if (asked == columns.end()) return {};
  return "column '" + asked->name + "' has the name of an azimuth, and not of which; type " +
         Quotable("--columns=phi_o=" + asked->name) +
         " if it is the detector's, or the difference to the light's, and " +
         Quotable("--columns=-=" + asked->name) + " if it is another";
}

std::string AdviceOnAngles(const std::vector<TableColumn>& columns) {
  for (const std::string_view vector : {"wix", "ix", "lx", "inx", "lightx", "xi"}) {
    if (!Has(columns, vector)) continue;
    return "directions are vectors; make them angles, or give them to trilobe.Measurement(wi, wo, "
           "rho) in Python";
  }
  if (std::string advice = AdviceOnCoordinates(columns); !advice.empty()) return advice;
  const auto has_role = [&](ColumnRole role) {
    return std::ranges::find(columns, role, &TableColumn::role) != columns.end();
  };
  if (has_role(ColumnRole::kWavelength) && !has_role(ColumnRole::kTheta) &&
      !has_role(ColumnRole::kThetaO)) {
    return "this is a spectrum without angles, as spectrometers write it; a BRDF is measured at "
           "many pairs of directions: make a table with a column of each wavelength, as 550nm, "
           "beside theta_i and theta_o";
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
  if (half && (Has(columns, "d") || Has(columns, "ndf"))) {
    return "this is a distribution of normals D(theta_h), of a model's tables; a BRDF is measured "
           "at many pairs of directions";
  }
  if (half && (Has(columns, "thetad") || Has(columns, "thetadiff"))) {
    return "theta_h and theta_d are angles of the half and difference vectors; make them theta_i, "
           "phi_i, theta_o, phi_o, or write an ALTA file (#PARAM_IN RUSIN_TH_TD_PD)";
  }
  return {};
}

}  // namespace

std::string ColumnsFlag(const std::vector<TableColumn>& columns, size_t as_f,
                        std::string_view value) {
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
    text += k == as_f ? std::string(value) : name_of(columns[k]);
  }
  return text;
}

std::string AdviceOnFactor(const std::string& name, double albedo) {
  const auto reflects = [&](double times) {
    if (!(albedo > 0)) return std::string();
    return " (at least " + Text(times * albedo, 2) + " of the light comes back)";
  };
  return "column '" + name + "' may hold pi f, the reflectance factor, or f in 1/sr; type " +
         std::string(kOverPi) + " if it is pi f" + reflects(1 / kPi) +
         ", and --scale=1 if it is f" + reflects(1);
}

std::string AdviceOn(const std::vector<TableColumn>& columns, const GivenAngles& given) {
  const auto has = [&](auto is) {
    return std::ranges::any_of(columns, [&](const TableColumn& column) { return is(column.role); });
  };
  const bool has_theta_i =
      given.theta_i || has([](ColumnRole role) { return role == ColumnRole::kThetaI; }) ||
      (given.theta_o && has([](ColumnRole role) { return role == ColumnRole::kTheta; }));
  const bool has_theta_o = given.theta_o || has([](ColumnRole role) {
                             return role == ColumnRole::kThetaO || role == ColumnRole::kTheta;
                           });
  const bool from_mirror = has([](ColumnRole role) { return role == ColumnRole::kFromMirror; });
  if (!has_theta_i || !(has_theta_o || from_mirror)) {
    if (std::string advice = AdviceOnAngles(columns); !advice.empty()) return advice;
    return AdviceOnAzimuths(columns);
  }
  if (std::string advice = AdviceOnAzimuths(columns); !advice.empty()) return advice;
  const bool has_values =
      has([](ColumnRole role) { return role >= ColumnRole::kRed && role <= ColumnRole::kBand; });
  return has_values ? AdviceOnScale(columns) : AdviceOnValues(columns);
}

}  // namespace trilobe
