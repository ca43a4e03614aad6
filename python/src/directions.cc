// Which directions to measure, and which next.

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/algebra/openblas.h"
#include "fit/next_directions.h"
#include "fit_module.h"
#include "model/measurement/directions_to_measure.h"
#include "named_values.h"
#include "owned_array.h"
#include "running_fit.h"
#include "trilobe/core/base/angles.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

// By the names of the program's flags, in degrees.
Goniometer DeviceOf(const nb::dict& options) {
  const auto angle = [&](const char* name) {
    return DegreesToRadians(OptionOf<double>(options, name, "a number of degrees"));
  };
  Goniometer device{.max_theta = angle("theta_max"),
                    .in_plane = OptionOf<bool>(options, "in_plane", "True or False"),
                    .step = angle("step"),
                    .blind = angle("blind")};
  for (const double degrees :
       OptionOf<std::vector<double>>(options, "incidences", "angles in degrees")) {
    device.incidences.push_back(DegreesToRadians(degrees));
  }
  return device;
}

// theta_i, phi_i, theta_o and phi_o. [directions][4], in degrees
NumpyArray<double> AnglesOf(const std::vector<SphericalAngles>& directions) {
  std::vector<double> angles;
  angles.reserve(4 * directions.size());
  for (const SphericalAngles& at : directions) {
    for (const double angle : {at.theta_i, at.phi_i, at.theta_o, at.phi_o}) {
      angles.push_back(RadiansToDegrees(angle));
    }
  }
  return OwnedArray(std::move(angles), {directions.size(), size_t{4}});
}

NumpyArray<double> Plan(const NamedValues& options) {
  const int count = OptionOf<int>(options, "directions", "an integer");
  const Goniometer device = DeviceOf(options);
  std::vector<SphericalAngles> directions;
  {
    const nb::gil_scoped_release released;
    directions = DirectionsToMeasure(count, device);
  }
  return AnglesOf(directions);
}

// Their angles, the number of samples that were fitted, and Delta E, now and then.
using Next = std::tuple<NumpyArray<double>, int, std::optional<double>, std::optional<double>>;

// Nothing if it was stopped.
std::optional<Next> NextOf(const Measured& measured, const NamedValues& options,
                           RunningFit* running) {
  const int count = OptionOf<int>(options, "next", "an integer");
  const NextBy by = FindNextBy(OptionOf<std::string>(options, "by", "a name"));
  const Goniometer device = DeviceOf(options);
  const int threads = ThreadsOf(options);
  const FitOptions fit_options{
      .appearance = {.num_threads = threads},
      .num_threads = threads,
      .on_progress = [running](const IterationRecord& record) { running->Show(record); },
      .stop = [running] { return running->stopped(); }};
  const std::shared_ptr<const Measurement> data = measured.data;
  NextDirections next;
  {
    const nb::gil_scoped_release released;
    { const BlasCall memory_is_there; }
    next = NextDirectionsToMeasure(*data, count, by, device, fit_options);
  }
  if (running->stopped()) return std::nullopt;
  std::optional<double> delta_e;
  if (next.now) delta_e = next.now->mean_delta_e;
  return Next(AnglesOf(next.directions), next.measured, delta_e, next.expected_delta_e);
}

}  // namespace

void BindDirections(nb::module_* module) {
  module->def("directions_to_measure", &Plan, nb::arg("options"));
  module->def("next_directions", &NextOf, nb::arg("measured"), nb::arg("options"),
              nb::arg("running"));
}

}  // namespace trilobe::python
