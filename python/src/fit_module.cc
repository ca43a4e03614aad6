// The module trilobe._fit: measurements, fits and scores, by the whole library. What it says of
// them is the program's reports. Python loads it when it is first needed.

#include "fit_module.h"

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "core/files/own_mark.h"
#include "io/formats/source_option.h"
#include "trilobe/fit/form.h"
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

[[noreturn]] void FailOption(const SourceOption& option) {
  const bool is_truth = std::holds_alternative<bool>(option.default_value);
  const bool is_number = std::holds_alternative<double>(option.default_value);
  throw Error(option.name + " must be " +
              (is_truth    ? "True or False"
               : is_number ? "a number"
                           : "a text, or a number"));
}

// The text that the flag of an option would have.
std::string FlagTextOf(const SourceOption& option, const nb::handle& value) {
  bool truth = false;
  if (std::holds_alternative<bool>(option.default_value)) {
    if (!nb::try_cast<bool>(value, truth)) FailOption(option);
    return truth ? "true" : "false";
  }
  if (std::holds_alternative<std::string>(option.default_value) && nb::isinstance<nb::str>(value)) {
    return nb::cast<std::string>(value);
  }
  // Numbers of NumPy are taken, too.
  double number = 0;
  if (int64_t integer = 0; nb::try_cast<int64_t>(value, integer)) return std::to_string(integer);
  if (!nb::try_cast<double>(value, number)) FailOption(option);
  return nb::cast<std::string>(nb::repr(nb::float_(number)));
}

// The names of the options of a measurement, and the defaults of their flags.
nb::dict SourceOptionDefaults() {
  nb::dict defaults;
  for (const SourceOption& option : AllSourceOptions()) {
    std::visit([&](const auto& value) { defaults[option.name.c_str()] = nb::cast(value); },
               option.default_value);
  }
  return defaults;
}

}  // namespace

SourceOptions SourceOptionsOf(const nb::dict& options) {
  SourceOptions source{.num_threads = ThreadsOf(options)};
  for (const SourceOption& option : AllSourceOptions()) {
    if (!options.contains(option.name.c_str())) continue;
    option.set(FlagTextOf(option, options[option.name.c_str()]), &source);
  }
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
  m.def("source_options", SourceOptionDefaults,
        nb::sig("def source_options() -> dict[str, object]"));
  m.def(
      "form_names",
      [] {
        std::vector<std::string> names;
        for (const NamedForm& form : NamedForms()) names.push_back(form.name);
        return names;
      },
      nb::sig("def form_names() -> list[str]"));
  m.def("says_own", [](const nb::bytes& content) {
    return SaysOwn({static_cast<const char*>(content.data()), content.size()});
  });
  BindMeasurement(&m);
  BindFit(&m);
  BindObjective(&m);
  BindScore(&m);
  BindTexels(&m);
}

}  // namespace trilobe::python
