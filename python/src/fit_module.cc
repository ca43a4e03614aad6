// The module trilobe._fit: measurements, fits and scores, by the whole library. What it says of
// them is the program's reports. Python loads it when it is first needed.

#include "fit_module.h"

#include <gflags/gflags.h>
#include <glog/logging.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "core/files/own_mark.h"
#include "error_translator.h"
#include "fit/fit_option.h"
#include "io/formats/source_option.h"
#include "trilobe/fit/form.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/read_model.h"

namespace nb = nanobind;

namespace trilobe::python {

int ThreadsOf(const nb::dict& options) {
  const int threads = OptionOf<int>(options, "threads", "an integer");
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (threads < 0) {
    throw Error(ErrorKind::kRange, "threads is negative; give 0 for all cores")
        .About("threads", threads);
  }
  return threads == 0 ? cores : std::min(threads, cores);
}

std::vector<double> ByRow(const Weights& weights) {
  return {weights.data(), weights.data() + weights.shape(0)};
}

BrdfSamples Weighted(BrdfSamples samples, const std::vector<double>& weights) {
  const size_t count = samples.size();
  if (weights.size() != count) {
    throw Error(ErrorKind::kMismatch, "there are " + std::to_string(weights.size()) +
                                          " weights for " + std::to_string(count) +
                                          " valid samples")
        .About("weights", weights.size());
  }
  samples.multiplicity = weights;
  return samples;
}

namespace {

// How an option is to be given, by the default value of its flag.
std::string TypeOf(const OptionValue& value) {
  if (std::holds_alternative<bool>(value)) return "True or False";
  if (std::holds_alternative<int>(value)) return "an integer";
  return std::holds_alternative<double>(value) ? "a number" : "a text";
}

// The text of a number, of NumPy, too; nothing for another value.
std::optional<std::string> NumberText(const nb::handle& value) {
  if (int64_t integer = 0; nb::try_cast<int64_t>(value, integer)) return std::to_string(integer);
  double number = 0;
  if (!nb::try_cast<double>(value, number)) return std::nullopt;
  return nb::cast<std::string>(nb::repr(nb::float_(number)));
}

// The text that the flag of an option would have.
std::string FlagTextOf(const std::string& name, const OptionValue& like, const nb::handle& value) {
  std::optional<std::string> text;
  if (std::holds_alternative<bool>(like)) {
    if (bool truth = false; nb::try_cast<bool>(value, truth)) text = truth ? "true" : "false";
  } else if (std::holds_alternative<int>(like)) {
    if (int integer = 0; nb::try_cast<int>(value, integer)) text = std::to_string(integer);
  } else if (std::holds_alternative<std::string>(like) && nb::isinstance<nb::str>(value)) {
    text = nb::cast<std::string>(value);
  } else {
    text = NumberText(value);
  }
  if (!text) throw Error(ErrorKind::kFormat, name + " must be " + TypeOf(like)).About(name);
  return *text;
}

// Sets those options of a table of rows that are there.
template <typename Row, typename Options>
void SetOptions(const std::vector<Row>& rows, const nb::dict& given, Options* options) {
  for (const Row& option : rows) {
    const char* const name = option.name.c_str();
    if (!given.contains(name)) continue;
    option.set(FlagTextOf(option.name, option.default_value, given[name]), options);
  }
}

// The names of the options, and the defaults of their flags.
template <typename Row>
nb::dict DefaultsOf(const std::vector<Row>& rows) {
  nb::dict defaults;
  for (const Row& option : rows) {
    std::visit([&](const auto& value) { defaults[option.name.c_str()] = nb::cast(value); },
               option.default_value);
  }
  return defaults;
}

}  // namespace

SourceOptions SourceOptionsOf(const nb::dict& options) {
  SourceOptions source{.num_threads = ThreadsOf(options)};
  SetOptions(AllSourceOptions(), options, &source);
  CheckSourceOptions(source);
  return source;
}

FitOptions FitOptionsOf(const nb::dict& options) {
  FitOptions fit;
  fit.num_threads = ThreadsOf(options);
  SetOptions(AllFitOptions(), options, &fit);
  if (options.contains("start")) {
    const auto text = OptionOf<nb::bytes>(options, "start", "the text of a model file");
    fit.start_model = ParseModel({text.c_str(), text.size()}, "start").model;
    fit.init = "start";
  }
  CheckFitOptions(fit);
  return fit;
}

NB_MODULE(_fit, m) {  // NOLINT(performance-unnecessary-value-param): nanobind's
  nb::set_leak_warnings(false);
  FLAGS_minloglevel = google::GLOG_FATAL;  // the reports have what Ceres Solver would log
  gflags::SetVersionString(TRILOBE_VERSION);
  TranslateErrors();
  m.def(
      "source_options", [] { return DefaultsOf(AllSourceOptions()); },
      nb::sig("def source_options() -> dict[str, object]"));
  m.def(
      "fit_options", [] { return DefaultsOf(AllFitOptions()); },
      nb::sig("def fit_options() -> dict[str, object]"));
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
  BindDirections(&m);
  BindObjective(&m);
  BindScore(&m);
  BindTexels(&m);
}

}  // namespace trilobe::python
