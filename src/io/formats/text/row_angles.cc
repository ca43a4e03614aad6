#include "io/formats/text/row_angles.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/text.h"
#include "io/formats/optical/zemax_angles.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Theta with its sign, which turns *phi by 180 degrees.
double Unsigned(double theta, double* phi) {
  if (theta >= -kAngleRounding) return std::max(theta, 0.0);
  *phi += *phi > 0 ? -kPi : kPi;
  return -theta;
}

}  // namespace

RowAngles::RowAngles(const ColumnLayout& layout, const SourceOptions& options,
                     const AnglesInText& above)
    : layout_(layout),
      options_(options),
      above_(above),
      adds_phi_i_(layout.angles[kPhiO] && !layout.angles[kPhiI] &&
                  layout.columns[*layout.angles[kPhiO]].is_difference),
      given_theta_o_(DegreesToRadians(std::max(options.theta_o_deg, 0.0))) {
  Begin();
}

void RowAngles::Begin() {
  block_theta_i_ = options_.theta_i_deg != -1 ? DegreesToRadians(options_.theta_i_deg)
                                              : above_.theta_i.value_or(0);
  block_phi_i_ = above_.phi_i.value_or(0);
  has_rows_ = false;
}

bool RowAngles::IsByFlag(double theta_i) const {
  return std::abs(RadiansToDegrees(theta_i) - options_.theta_i_deg) < 1e-6;
}

void RowAngles::TakeGiven(const TextLines& lines, const AnglesInText& given) {
  if (given.phi_i && !layout_.angles[kPhiI]) {
    has_phi_blocks_ |= *given.phi_i != block_phi_i_;
    block_phi_i_ = *given.phi_i;
  }
  if (!given.theta_i || layout_.angles[kThetaI]) return;
  if (options_.theta_i_deg == -1) {
    block_theta_i_ = *given.theta_i;
    has_blocks_ = true;
  } else if (has_rows_ && !IsByFlag(*given.theta_i)) {
    lines.Fail("theta_i is " + Text(RadiansToDegrees(*given.theta_i)) +
                   " deg here, and --theta_i says " + Text(options_.theta_i_deg) +
                   " of all rows; without the flag each block has the angle of its line",
               ErrorKind::kConflict, "theta_i", FactText(RadiansToDegrees(*given.theta_i)));
  }
}

// [rad]; `missing` without a column.
double RowAngles::AngleOf(const TextLines& lines, Angle angle, const AngleRange& range,
                          double missing, TableRow* row) const {
  const std::optional<size_t> column = layout_.angles[angle];
  if (!column) return missing;
  const TableColumn& of = layout_.columns[*column];
  if (row->IsGapAt(*column)) {
    lines.FailAt(*column, of.name,
                 "no angle; each row has its own: fill the cells down with the one above them",
                 ErrorKind::kMissing);
  }
  const double number = row->Number(lines, *column);
  if (!of.from_horizon) {
    return ReadAngle(lines, *column, of.name, number, layout_.units[angle], range);
  }
  if (number < 0) {
    lines.FailAt(*column, of.name,
                 "an elevation below 0 is under the horizon; if it is counted from the normal, "
                 "type --columns=" +
                     std::string(kUsualNames[angle]) + "=" + of.name + ", and likewise the others",
                 ErrorKind::kRange, FactText(number));
  }
  return kPi / 2 - ReadAngle(lines, *column, of.name, number, layout_.units[angle], {0, 90});
}

// Of wo from that of wi, by cos g = cos theta_i cos theta_o + sin theta_i sin theta_o cos phi.
double RowAngles::AzimuthByPhase(const TextLines& lines, TableRow* row) const {
  constexpr double kRounding = 2;  // degrees of three rounded angles
  const size_t column = *layout_.phase;
  const TableColumn& named = layout_.columns[column];
  const double phase = ReadAngle(lines, column, named.name, row->Number(lines, column),
                                 RadiansIn(named.unit).value_or(1), {-180, 180});
  const double theta_i = std::abs(theta_i_), theta_o = std::abs(theta_o_);
  const double least = RadiansToDegrees(std::abs(theta_i - theta_o));
  const double most = RadiansToDegrees(std::min(theta_i + theta_o, 2 * kPi - theta_i - theta_o));
  const double degrees = RadiansToDegrees(std::abs(phase));
  if (degrees < least - kRounding || degrees > most + kRounding) {
    lines.FailAt(column, named.name,
                 Text(degrees) + " deg is no angle between these directions, which are " +
                     Text(least) + " to " + Text(most) + " deg apart",
                 ErrorKind::kRange, FactText(degrees));
  }
  const double sines = std::sin(theta_i_) * std::sin(theta_o_);
  if (std::abs(sines) < 1e-12) return 0;
  const double cosine = (std::cos(phase) - std::cos(theta_i_) * std::cos(theta_o_)) / sines;
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// Where a direction is the normal, nothing, NaN or -999 may stand in the place of its azimuth.
bool RowAngles::HasNoAzimuth(Angle angle, const TextLines& lines, TableRow* row) const {
  const std::optional<size_t> column = layout_.angles[angle];
  if (!column) return false;
  if (row->IsGapAt(*column)) return true;
  const double radians = row->Number(lines, *column) * layout_.units[angle];
  return !(std::abs(radians) <= 2 * kPi + kAngleRounding);
}

SphericalAngles RowAngles::Of(const TextLines& lines, bool turned, TableRow* row) {
  constexpr AngleRange kTheta = {-180, 180}, kPhi = {-360, 360};
  has_rows_ = true;
  theta_i_ = AngleOf(lines, kThetaI, kTheta, block_theta_i_, row);
  theta_o_ = AngleOf(lines, kThetaO, kTheta, given_theta_o_, row);
  // The angle and the azimuth about the mirror direction; without an azimuth, in the plane.
  const bool about_mirror = layout_.from_mirror && HasAzimuths();
  if (layout_.from_mirror && !about_mirror) theta_o_ += theta_i_;
  SphericalAngles at;
  const auto phi_of = [&](Angle angle, double theta, double missing) {
    if (theta == 0 && HasNoAzimuth(angle, lines, row)) return 0.0;
    return AngleOf(lines, angle, kPhi, missing, row);
  };
  at.phi_i = phi_of(kPhiI, theta_i_, block_phi_i_);
  at.phi_o =
      layout_.phase ? at.phi_i + AzimuthByPhase(lines, row) : phi_of(kPhiO, theta_o_, at.phi_i);
  if (adds_phi_i_) at.phi_o += at.phi_i;
  signed_ |= std::min(theta_i_, theta_o_) < -kAngleRounding;
  in_plane_ &= at.phi_i == at.phi_o && !layout_.phase;
  if (!phi_i_) phi_i_ = at.phi_i;
  one_phi_i_ &= at.phi_i == *phi_i_;
  at.theta_i = Unsigned(theta_i_, &at.phi_i);
  if (turned) at.phi_o += kPi;
  at.theta_o = Unsigned(theta_o_, &at.phi_o);
  if (!about_mirror) return at;
  return ToSphericalAngles(ZemaxAngles{.rotation = kPi - at.phi_i,
                                       .incidence = at.theta_i,
                                       .azimuth = at.phi_o - at.phi_i,
                                       .radial = at.theta_o});
}

std::string RowAngles::ThetaINote() const {
  if (layout_.angles[kThetaI]) return "";
  if (has_blocks_) return "theta_i by lines between the rows";
  return "theta_i = " + Text(RadiansToDegrees(block_theta_i_)) + " deg";
}

std::string RowAngles::PhiINote() const {
  if (layout_.angles[kPhiI]) return "";
  if (has_phi_blocks_) return "phi_i by lines between the rows";
  if (block_phi_i_ == 0) return "phi_i = 0";
  return "phi_i = " + Text(RadiansToDegrees(block_phi_i_)) + " deg";
}

std::string RowAngles::NoteOnFlag() const {
  if (options_.theta_i_deg == -1 || layout_.angles[kThetaI]) return "";
  if (!above_.theta_i || IsByFlag(*above_.theta_i)) return "";
  return "theta_i is that of --theta_i, and not " + Text(RadiansToDegrees(*above_.theta_i)) +
         " deg, as a line above the rows says";
}

}  // namespace trilobe
