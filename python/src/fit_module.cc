// The module trilobe._fit: measurements, fits and scores, by the whole library. What it says of
// them is the program's reports. Python loads it when it is first needed.

#include "fit_module.h"

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "trilobe/io/formats/source.h"

namespace nb = nanobind;

namespace trilobe::python {

int ThreadsOf(const nb::dict& options) {
  const int threads = OptionOf<int>(options, "threads", "an integer");
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (threads < 0) throw Error("threads is negative; give 0 for all cores");
  return threads == 0 ? cores : std::min(threads, cores);
}

std::vector<double> ByRow(const Weights& weights) {
  return {weights.data(), weights.data() + weights.shape(0)};
}

BrdfSamples Weighted(BrdfSamples samples, const std::vector<double>& weights) {
  const size_t count = samples.size();
  if (weights.size() != count) {
    throw Error("there are " + std::to_string(weights.size()) + " weights for " +
                std::to_string(count) + " valid samples");
  }
  samples.multiplicity = weights;
  return samples;
}

namespace {

// None for "auto".
std::optional<double> TiltOf(const nb::dict& options) {
  if (options.contains("tilt") && options["tilt"].equal(nb::str("auto"))) return std::nullopt;
  return OptionOf<double>(options, "tilt", "a number of degrees, or auto");
}

}  // namespace

SourceOptions SourceOptionsOf(const nb::dict& options) {
  SourceOptions source{
      .noise = OptionOf<double>(options, "noise", "a number"),
      .missing = OptionOf<double>(options, "missing", "a number"),
      .corrupt = OptionOf<std::string>(options, "corrupt", "a text"),
      .tilt_deg = TiltOf(options),
      .seed = OptionOf<uint64_t>(options, "seed", "an integer from 0"),
      .num_threads = ThreadsOf(options),
      .max_angle_deg = OptionOf<double>(options, "max_angle", "a number of degrees"),
      .min_theta_d_deg = OptionOf<double>(options, "min_theta_d", "a number of degrees"),
      .extrapolated = OptionOf<bool>(options, "extrapolated", "True or False"),
      .outliers = OptionOf<bool>(options, "outliers", "True or False"),
      .dark_noise = OptionOf<bool>(options, "dark_noise", "True or False"),
      .radiometry = OptionOf<std::string>(options, "radiometry", "a name"),
      .columns = OptionOf<std::string>(options, "columns", "a text"),
      .theta_i_deg = OptionOf<double>(options, "theta_i", "a number of degrees"),
      .bands = OptionOf<std::string>(options, "bands", "a text")};
  SetCosine(OptionOf<std::string>(options, "cosine", "a number, or o:1"), &source);
  source.scale = OptionOf<double>(options, "scale", "a number");
  source.azimuth_from_mirror = OptionOf<bool>(options, "azimuth_from_mirror", "True or False");
  CheckSourceOptions(source);
  return source;
}

NB_MODULE(_fit, m) {  // NOLINT(performance-unnecessary-value-param): nanobind's
  nb::set_leak_warnings(false);
  FLAGS_minloglevel = google::GLOG_FATAL;  // the reports have what Ceres Solver would log
  gflags::SetVersionString(TRILOBE_VERSION);
  nb::register_exception_translator(
      [](const std::exception_ptr& exception, void* /*payload*/) {
        try {
          std::rethrow_exception(exception);
        } catch (const Error& error) {
          // Imported only when needed, so that the module can be loaded without the package.
          const nb::object type = nb::module_::import_("trilobe._core").attr("Error");
          PyErr_SetString(type.ptr(), error.what());
        }
      },
      nullptr);
  BindMeasurement(&m);
  BindFit(&m);
  BindObjective(&m);
  BindScore(&m);
  BindTexels(&m);
}

}  // namespace trilobe::python
