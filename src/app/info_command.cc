#include "trilobe/app/command.h"
#include "trilobe/app/describe.h"
#include "trilobe/app/inputs.h"

namespace trilobe {
namespace {

int RunInfo(std::span<const std::string> arguments) {
  if (IsModelFile(arguments[0])) {
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
      .min_arguments = 1,
      .max_arguments = 1,
      .details =
          "A measurement: what it is, which bins are valid and why the others are not, the range "
          "of "
          "values,\nhow far the bins at phi_d and 180 deg - phi_d differ (0 for a reciprocal, "
          "mirror-symmetric\nmaterial; for RGL files also the plain reciprocity error), and the "
          "directional albedo over\ntheta_i with the angle where it passes 1. A model file: its "
          "tables, coefficients, how it was\nfitted, and its albedo.",
      .flags = {"json", "noise", "seed", "threads"},
      .run = RunInfo};
}

}  // namespace trilobe
