#include "app/command.h"
#include "app/describe.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

int RunInfo(std::span<const std::string> arguments) {
  if (IsModelFile(arguments[0])) {
    if (!FLAGS_out.empty()) {
      throw Error(ErrorKind::kConflict, "--out is for a picture of what was measured; " +
                                            arguments[0] + " is a model: draw it with trilobe plot")
          .At(arguments[0])
          .About("out", FLAGS_out);
    }
    RefuseForModel(arguments[0], MeasurementFlags());
    DescribeModel(arguments[0]);
  } else {
    DescribeMeasurement(arguments[0]);
  }
  return 0;
}

}  // namespace

Command InfoCommand() {
  return {
      .name = "info",
      .summary = "describe a measurement or a model file",
      .arguments = "SOURCE|MODEL",
      .doing = "reading",
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "A measurement: what it is, which bins are valid and why the others are not, the range "
          "of values,\nhow far the bins at phi_d and 180 deg - phi_d differ (0 for a reciprocal, "
          "mirror-symmetric\nmaterial; for RGL files also the plain reciprocity error), and the "
          "directional albedo over\ntheta_i with the angle where it passes 1, all of what was "
          "measured. With --out=DIR it draws\nDIR/measured.png: how many of the bins are valid, "
          "over theta_i and theta_o.\nScattered samples: how many are valid and why the others are "
          "not, their angles and values, how\nfar those with swapped directions differ and, where "
          "azimuths matter, how much of the energy the mean\nover all turns of the sample leaves "
          "out; with --out=DIR a picture of all pairs of directions.\nA "
          "model file: its tables, coefficients, how it was fitted, and its albedo.",
      .flags = WithSourceFlags({"json", "out"}),
      .run = RunInfo};
}

}  // namespace trilobe
