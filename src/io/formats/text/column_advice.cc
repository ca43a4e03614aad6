#include "io/formats/text/column_advice.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "core/base/text.h"
#include "io/formats/text/angle_names.h"
#include "io/formats/text/column_words.h"
#include "io/formats/text/columns_flag.h"
#include "io/formats/text/value_advice.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
namespace {

bool Has(const std::vector<TableColumn>& columns, std::string_view key) {
  return std::ranges::any_of(columns,
                             [&](const TableColumn& column) { return KeyOf(column) == key; });
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
    if (key == "beta" && Has(columns, "alpha")) continue;  // angles by letters
    for (const Coordinate& coordinate : kCoordinates) {
      // Checked before "beta": the distance between bars, |beta - beta0|.
      const bool is_distance = key.find("betabeta") != std::string::npos ||
                               key.starts_with("bb0") || key.starts_with("bbo");
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

// A number of waves is no wavelength, and rows that it tells apart are no repetitions.
std::string AdviceOnWavenumbers(const std::vector<TableColumn>& columns) {
  constexpr std::string_view kNames[] = {"wavenumber", "wellenzahl", "nombredonde"};
  for (const TableColumn& column : columns) {
    if (column.role == ColumnRole::kWavelength) return {};
    const std::string key = KeyOf(column);
    const bool is_so =
        std::ranges::any_of(kNames, [&](std::string_view name) { return key.starts_with(name); });
    if (column.role != ColumnRole::kOther || column.is_by_flag || !is_so) continue;
    return "column '" + column.name +
           "' is not read; make it the wavelength in nm: 10,000,000 divided by the wavenumber in "
           "1/cm";
  }
  return {};
}

// "BRDF at 10 deg", "BRDF at 30 deg", "BRDF at 50 deg".
std::string AdviceOnMatrix(const std::vector<TableColumn>& columns) {
  constexpr int kFewest = 3;
  constexpr std::string_view kOfGloss[] = {"20", "45", "60", "75", "85"};
  const bool has_values = std::ranges::any_of(columns, [](const TableColumn& column) {
    return column.role >= ColumnRole::kRed && column.role <= ColumnRole::kBand;
  });
  if (has_values) return {};
  std::map<std::string, int> stems;
  bool is_gloss = true;
  for (const TableColumn& column : columns) {
    constexpr std::string_view kDigits = "0123456789.";
    if (column.role != ColumnRole::kOther) continue;
    const size_t first = column.name.find_first_of("0123456789");
    if (first == std::string::npos) continue;
    const size_t end = std::min(column.name.find_first_not_of(kDigits, first), column.name.size());
    is_gloss &= IsOneOf(column.name.substr(first, end - first), kOfGloss);
    ++stems[column.name.substr(0, first) + column.name.substr(end)];
  }
  const auto are_many = [](const auto& stem) {
    const std::string plain = Plain(stem.first);
    const bool is_brdf = plain.starts_with("brdf") || plain.starts_with("bsdf");
    return stem.second >= (is_brdf ? kFewest - 1 : kFewest);
  };
  if (std::ranges::none_of(stems, are_many)) return {};
  if (is_gloss) {
    return "columns of 20, 60 and 85 deg seem to be of gloss, and no BRDF; one is measured at many "
           "pairs of directions";
  }
  return "no column theta_i; --columns=theta_o/theta_i says that a row is a theta_o and a column a "
         "theta_i, of those in its name";
}

std::string AdviceOnAngles(const std::vector<TableColumn>& columns) {
  if (std::string advice = AdviceOnTransmission(columns); !advice.empty()) return advice;
  for (const std::string_view vector :
       {"wix", "ix", "lx", "inx", "lightx", "xi", "kx", "kxin", "kxi", "kix", "vx"}) {
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
  if (std::string advice = AdviceOnMatrix(columns); !advice.empty()) return advice;
  const bool half = Has(columns, "thetah") || Has(columns, "thetahalf") || Has(columns, "thetam") ||
                    Has(columns, "halfangle");
  const bool is_ndf = Has(columns, "ndf") || (half && (Has(columns, "d") || Has(columns, "dh")));
  if (is_ndf && !has_role(ColumnRole::kValue)) {
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

std::string AdviceOnFactor(const std::string& name, double albedo) {
  const auto reflects = [&](double times) {
    if (!(albedo > 0)) return std::string();
    return " (at least " + Text(times * albedo, 2) + " of the light comes back)";
  };
  return "column '" + name +
         "' may hold pi f, the reflectance factor, or f in 1/sr; type "
         "--scale=0.3183 if it is pi f" +
         reflects(1 / kPi) + ", and --scale=1 if it is f" + reflects(1);
}

std::string AdviceOn(const std::vector<TableColumn>& columns, const GivenAngles& given,
                     const FirstRows& rows) {
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
  if (std::string advice = AdviceOnWavenumbers(columns); !advice.empty()) return advice;
  return has_values ? AdviceOnScale(columns) : AdviceOnValues(columns, rows);
}

}  // namespace trilobe
