#include <gflags/gflags.h>

#include <algorithm>
#include <iostream>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/program.h"
#include "app/result_folder.h"
#include "app/status.h"
#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/text_lines.h"
#include "fit/next_directions.h"
#include "fit/reports/print.h"
#include "model/measurement/directions_to_measure.h"
#include "model/measurement/short_path.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"

DEFINE_int32(directions, 50, "pairs of directions to measure");
DEFINE_int32(next, 0, "pairs of directions to measure next, besides those of SOURCE");
DEFINE_string(by, "plan",
              "how --next chooses: plan, which goes on with --directions; design, by what a fit "
              "leaves open; or both, by turns");
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
DEFINE_string(
    path, "",
    "list them along a short path, by what a degree of theta_i, theta_o and phi takes, as "
    "1,1,2; first parts of it are no smaller plans then");

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

std::optional<AxisCosts> PathFromFlags() {
  if (FLAGS_path.empty()) return std::nullopt;
  const std::optional<std::vector<double>> costs = ToNumbers(FLAGS_path);
  AxisCosts path{.in_plane = FLAGS_in_plane};
  if (!costs || costs->size() != path.of_radian.size()) {
    throw Error(ErrorKind::kFormat, "--path=" + FLAGS_path +
                                        ": give what a degree of theta_i, theta_o and phi takes, "
                                        "as 1,1,2")
        .About("path", FLAGS_path);
  }
  std::ranges::copy(*costs, path.of_radian.begin());
  CheckAxisCosts(path);
  return path;
}

// What was asked for beside the number of directions.
struct Wanted {
  Goniometer device;
  std::optional<AxisCosts> path;
};

// Prints the directions or writes them to --out, of which it then says this.
void Give(std::vector<SphericalAngles> directions, const std::optional<AxisCosts>& path,
          const Inputs& inputs, std::string words) {
  if (path) {
    const double before = PathCost(directions, *path);
    directions = AlongShortPath(std::move(directions), *path);
    const double share = before > 0 ? PathCost(directions, *path) / before : 1;
    words = "along a path of " + Text(100 * share, 2) + " % of the way through the plan";
  }
  if (FLAGS_out.empty()) {
    Write(directions, std::cout);
    return;
  }
  inputs.CheckOutput(FLAGS_out);
  WriteFile(FLAGS_out, [&](std::ostream& out) { Write(directions, out); });
  PrintLine("wrote " + FLAGS_out + ": " + std::to_string(directions.size()) +
            " pairs of directions [degrees], " + words +
            "; measure r, g and b [1/sr] at each, and fit the file");
}

// What a fit expects now and after these; beside directions that are printed, on standard error.
std::string Expectation(const NextDirections& next) {
  const auto all = [](int count) { return std::to_string(count) + " directions"; };
  if (!next.now) return "the error of a fit to " + all(next.measured) + " is not guessed";
  constexpr double kSeen = 1;  // Delta E of patches side by side, at the least (verdict.h)
  const double delta_e = next.now->mean_delta_e;
  const std::string now = "a fit to " + all(next.measured) + " is off by about Delta E " +
                          Text(delta_e, 2) + " (guess for all directions)";
  if (delta_e <= kSeen) return now + "; what more would change is hardly seen";
  const auto count = static_cast<int>(next.directions.size());
  return now + "; with these, by about " + Text(*next.expected_delta_e, 2) +
         (*next.expected_delta_e <= kSeen
              ? ", and more would hardly be seen"
              : "; measure these " + std::to_string(count) + ", and ask again");
}

int GiveNext(const std::string& source, const Wanted& wanted) {
  if (!IsDefault("directions")) {
    throw Error(ErrorKind::kConflict,
                "--directions is for a material that is not known, and --next for one that is "
                "measured in part; leave one out")
        .About("directions", FLAGS_directions);
  }
  const NextBy by = FindNextBy(FLAGS_by);
  const Inputs inputs({source, FLAGS_probe});
  if (!FLAGS_out.empty()) inputs.CheckOutput(FLAGS_out);  // before the work
  const Measurement measured = MeasurementOfSource(source, SourceOptionsFromFlags());
  const NextDirections next = NextDirectionsToMeasure(measured, FLAGS_next, by, wanted.device,
                                                      {.appearance = AppearanceOptionsFromFlags(),
                                                       .num_threads = ThreadsFromFlags(),
                                                       .on_stage = Status::Stage});
  Status::End();
  (FLAGS_out.empty() ? std::cerr : std::cout) << Expectation(next) << "\n";
  Give(next.directions, wanted.path, inputs, "to be measured in this order");
  return 0;
}

int GivePlan(const Wanted& wanted) {
  for (const auto& [flag, value] : GivenFlags(WithSourceFlags({"next", "by", "probe"}))) {
    throw Error(ErrorKind::kMissing,
                "--" + flag + " goes with the SOURCE of what was measured; name its file")
        .About(flag, value);
  }
  Give(DirectionsToMeasure(FLAGS_directions, wanted.device), wanted.path, {},
       "of which any first ones are spread evenly");
  return 0;
}

int RunMeasure(std::span<const std::string> arguments) {
  if (!FLAGS_out.empty() && EndingOf(FLAGS_out) != ".csv") {
    throw Error(ErrorKind::kUnsupported, "--out=" + FLAGS_out +
                                             ": directions are CSV; end the "
                                             "name in .csv")
        .About("out", FLAGS_out);
  }
  const Wanted wanted = {DeviceFromFlags(), PathFromFlags()};
  if (arguments.empty()) return GivePlan(wanted);
  if (IsDefault("next")) {
    throw Error(ErrorKind::kMissing, arguments[0] +
                                         " has what was measured; say how many directions come "
                                         "next, as --next=10")
        .About("next");
  }
  return GiveNext(arguments[0], wanted);
}

}  // namespace

Command MeasureCommand() {
  return {
      .name = "measure",
      .summary = "say which directions to measure of a material, or which next",
      .arguments = "[SOURCE --next=N]",
      .min_arguments = 0,
      .max_arguments = 1,
      .details =
          "Writes --directions=N pairs of directions for a goniometer, as CSV with theta_i, phi_i, "
          "theta_o and phi_o [degrees],\nto --out=FILE.csv or, without it, to standard output. "
          "They are for an isotropic material, and spread evenly over\nhalf and difference angles "
          "(docs/measure.md has how good the fits are); the first ones of a longer list are those "
          "of\na shorter one, so that one may stop at any time. --theta_max, --in_plane, "
          "--incidences, --step and --blind say what\nthe device can do, and --path=1,1,2 lists "
          "them "
          "in an order in which its axes move little.\n\nWith a SOURCE, "
          "scattered samples of what was measured so far, it fits these, prints how far off the "
          "fit is expected to\nbe, now and then, and lists --next=N directions that are not among "
          "them: those that come next\nin the plan. With --by=design each is the one that tells "
          "most of what is seen, given the fit and all before; with\n--by=both they take turns.",
      .flags = WithSourceFlags({"directions", "next", "by", "theta_max", "in_plane", "incidences",
                                "step", "blind", "path", "out", "probe"}),
      .run = RunMeasure};
}

}  // namespace trilobe
