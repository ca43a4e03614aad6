#include <gflags/gflags.h>

#include <iostream>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/text_lines.h"
#include "fit/reports/print.h"
#include "model/measurement/directions_to_measure.h"
#include "trilobe/core/base/error.h"

DEFINE_int32(directions, 50, "pairs of directions to measure");
DEFINE_double(
    theta_max, 80,
    "largest angle of light and detector from the normal that the device has, in degrees");
DEFINE_bool(in_plane, false, "the detector stays in the plane of incidence");
DEFINE_string(incidences, "",
              "angles of incidence that the light has, in degrees: 10,30,50,70; by default any");
DEFINE_double(
    step, 0,
    "all angles but given incidences are multiples of this, in degrees, to 45; 0 for any angle");
DEFINE_double(blind, 0,
              "least angle between light and detector, which hides the light, in degrees");

namespace trilobe {
namespace {

Goniometer DeviceFromFlags() {
  Goniometer device{.max_theta = DegreesToRadians(FLAGS_theta_max),
                    .in_plane = FLAGS_in_plane,
                    .step = DegreesToRadians(FLAGS_step),
                    .blind = DegreesToRadians(FLAGS_blind)};
  const std::optional<std::vector<double>> incidences = ToNumbers(FLAGS_incidences);
  if (!incidences) {
    throw Error(ErrorKind::kFormat,
                "--incidences=" + FLAGS_incidences + ": give angles in degrees, as 10,30,50,70")
        .About("incidences", FLAGS_incidences);
  }
  for (const double degrees : *incidences) {
    device.incidences.push_back(DegreesToRadians(degrees));
  }
  return device;
}

void Write(const std::vector<SphericalAngles>& directions, std::ostream& out) {
  constexpr int kDigits = 6;
  const auto degrees = [](double angle) { return Text(RadiansToDegrees(angle), kDigits); };
  out << "# Directions to measure [degrees], by " << ProgramName()
      << "\ntheta_i,phi_i,theta_o,phi_o\n";
  for (const SphericalAngles& at : directions) {
    out << degrees(at.theta_i) << "," << degrees(at.phi_i) << "," << degrees(at.theta_o) << ","
        << degrees(at.phi_o) << "\n";
  }
}

int RunMeasure(std::span<const std::string> /*arguments*/) {
  const std::vector<SphericalAngles> directions =
      DirectionsToMeasure(FLAGS_directions, DeviceFromFlags());
  if (FLAGS_out.empty()) {
    Write(directions, std::cout);
    return 0;
  }
  if (EndingOf(FLAGS_out) != ".csv") {
    throw Error(ErrorKind::kUnsupported, "--out=" + FLAGS_out +
                                             ": directions are CSV; end the "
                                             "name in .csv")
        .About("out", FLAGS_out);
  }
  Inputs().CheckOutput(FLAGS_out);
  WriteFile(FLAGS_out, [&](std::ostream& out) { Write(directions, out); });
  PrintLine("wrote " + FLAGS_out + ": " + std::to_string(directions.size()) +
            " pairs of directions [degrees], of which any first ones are spread evenly; measure r, "
            "g and b [1/sr] at each, and fit the file");
  return 0;
}

}  // namespace

Command MeasureCommand() {
  return {
      .name = "measure",
      .summary = "say which directions to measure of an unknown material",
      .arguments = "",
      .min_arguments = 0,
      .max_arguments = 0,
      .details =
          "Writes --directions=N pairs of directions for a goniometer, as CSV with theta_i, phi_i, "
          "theta_o and phi_o [degrees],\nto --out=FILE.csv or, without it, to standard output. "
          "They are for an isotropic material, and spread evenly over\nhalf and difference angles "
          "(docs/measure.md has how good the fits are); the first ones of a longer list are those "
          "of\na shorter one, so that one may stop at any time. --theta_max, --in_plane, "
          "--incidences, --step and --blind say what\nthe device can do.",
      .flags = {"directions", "theta_max", "in_plane", "incidences", "step", "blind", "out"},
      .run = RunMeasure};
}

}  // namespace trilobe
