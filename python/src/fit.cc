#include "trilobe/fit/fit.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "core/algebra/openblas.h"
#include "core/base/json_text.h"
#include "core/system/evaluation_count.h"
#include "core/system/process.h"
#include "fit/reports/fit_details.h"
#include "fit/reports/fit_report.h"
#include "fit_module.h"
#include "named_values.h"
#include "owned_array.h"
#include "running_fit.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/solvers/solver_options.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A fit that is through; without a model where it was stopped before it began.
struct Outcome {
  bool begun = false;
  std::string model_text, trace_text, report_text;
  std::vector<double> parameters;
  std::vector<IterationRecord> trace;
  bool interrupted = false;
  int64_t values = 0, derivatives = 0;  // how often E and its derivatives were computed
};

OptionValue ValueOf(const nb::dict& options, const std::string& name, const OptionValue& like) {
  return std::visit(
      [&](const auto& of_type) -> OptionValue {
        using T = std::decay_t<decltype(of_type)>;
        return OptionOf<T>(options, name.c_str(),
                           std::is_same_v<T, bool>          ? "True or False"
                           : std::is_same_v<T, std::string> ? "a name"
                           : std::is_same_v<T, double>      ? "a number"
                                                            : "an integer");
      },
      like);
}

// Values given for the solver, by the names of the program's flags. Throws Error for what this
// solver does not read.
std::vector<std::pair<const SolverOption*, OptionValue>> SolverValues(const SolverEntry& solver,
                                                                      const nb::dict& given) {
  const std::vector<const SolverOption*> read = OptionsReadBy(solver.options);
  std::vector<std::pair<const SolverOption*, OptionValue>> values;
  for (const auto& [key, value] : given) {
    const auto name = nb::cast<std::string>(key);
    const SolverOption* found = nullptr;
    std::string known;
    for (const SolverOption* const option : read) {
      if (option->help.empty()) continue;  // an argument of every fit
      known += (known.empty() ? "" : ", ") + option->flag;
      if (option->flag == name) found = option;
    }
    if (found == nullptr) {
      throw Error(ErrorKind::kUnsupported,
                  "solver " + solver.name + " does not take " + name + "; it takes " + known)
          .About(name);
    }
    const OptionValue like =
        found->unit ? OptionValue(found->unit->default_value) : found->get(SolverOptions());
    values.emplace_back(found, ValueOf(given, name, like));
  }
  return values;
}

SolverOptions MakeOptions(const std::vector<std::pair<const SolverOption*, OptionValue>>& given,
                          const SolverEntry& solver, uint64_t seed, const ModelSpec& spec) {
  SolverOptions options;
  // Defaults of flags that are no members may depend on the form.
  for (const SolverOption* const option : OptionsReadBy(solver.options)) {
    if (option->help.empty()) continue;
    std::optional<OptionValue> value;
    for (const auto& [name, is] : given) {
      if (name == option) value = is;
    }
    if (!value && !option->unit) continue;
    if (!value) value = OptionValue(option->unit->default_value);
    if (option->unit) {
      CheckInRange(option->flag, *value, option->unit->range);
      if (option->unit->to_member) {
        value = option->unit->to_member(std::get<double>(*value), spec);
      }
    }
    CheckInRange(option->flag, *value, option->range);
    option->set(*value, &options);
  }
  options.seed = seed;
  return options;
}

FitOptions OptionsOf(const nb::dict& options, const nb::dict& solver_options) {
  FitOptions fit = FitOptionsOf(options);
  fit.seed = OptionOf<uint64_t>(options, "seed", "an integer from 0");
  const SolverEntry& solver = FindSolver(fit.solver);
  const auto values = SolverValues(solver, solver_options);
  fit.solver_options = [values, &solver, seed = fit.seed](const ModelSpec& spec) {
    return MakeOptions(values, solver, seed, spec);
  };
  CheckSolverOptions(fit.solver_options(ModelSpec()));
  return fit;
}

// The fields of trilobe.Record.
nb::tuple RecordOf(const IterationRecord& r) {
  return nb::make_tuple(r.iteration, r.seconds, r.objective, r.filtered, r.accepted, r.step,
                        r.optimality.value_or(kUnknown), r.processor_seconds.value_or(kUnknown),
                        r.objective_with_prior.value_or(kUnknown));
}

// Asks Python after an iteration whether to stop.
void Ask(const nb::object& callback, const IterationRecord& record, const FactorModel& model,
         RunningFit* running) {
  ModelFile file;
  file.model = model;
  const std::string text = FormatModel(file);
  const nb::gil_scoped_acquire held;
  if (nb::cast<bool>(callback(RecordOf(record), nb::bytes(text.data(), text.size())))) {
    running->Stop();
  }
}

// One that a limit of time has ended was not interrupted.
void TellOfLimit(const RunningFit& running, FitResult* fit) {
  if (running.stopped() || !fit->interrupted) return;
  fit->interrupted = false;
  if (fit->summary.stop_reason == StopReason::kInterrupted) {
    fit->summary.stop_reason = StopReason::kMaxSeconds;
    fit->file.fit.stop_reason = StopReasonName(StopReason::kMaxSeconds);
  }
}

Outcome RunFit(const Measured& measured, const NamedValues& options,
               const NamedValues& solver_options, RunningFit* running,
               const std::optional<Weights>& weights, const nb::object& callback) {
  FitOptions fit_options = OptionsOf(options, solver_options);
  if (weights) {
    fit_options.select = [by_sample = ByRow(*weights)](BrdfSamples samples) {
      return Weighted(std::move(samples), by_sample);
    };
  }
  const std::shared_ptr<const Measurement> data = measured.data;
  FitReport report;
  report.noise = measured.noise;
  report.seed = static_cast<int64_t>(fit_options.seed);
  report.data_seed = measured.seed;
  report.seconds.read = measured.seconds;
  const nb::gil_scoped_release released;
  { const BlasCall memory_is_there; }
  Outcome outcome;
  running->Limit(fit_options.solver_options(ModelSpec()).max_seconds);
  fit_options.stop = [running] { return running->IsToEnd(); };
  fit_options.on_begin = [&outcome, running] {
    outcome.begun = true;
    running->Begin();
  };
  fit_options.on_progress = [running](const IterationRecord& record) { running->Show(record); };
  if (!callback.is_none()) {
    fit_options.on_iteration = [&](const IterationRecord& record, const FactorModel& model) {
      Ask(callback, record, model, running);
    };
  }
  EvaluationCount count;
  FitResult fit = [&] {
    const CountEvaluations counting(&count);
    return Fit(*data, fit_options);
  }();
  outcome.values = count.values;
  outcome.derivatives = count.derivatives;
  TellOfLimit(*running, &fit);
  outcome.interrupted = fit.interrupted;
  if (!outcome.begun) return outcome;
  ModelFile file = fit.file;
  file.fit.program = std::string("trilobe ") + TRILOBE_VERSION;
  file.fit.date = UtcNow();
  report.data_notes = data->notes;
  report.bins = CountsOf(*data);
  report.fit = file.fit;
  FillReport(fit, &report);
  report.summary.phases.reading = report.seconds.read;
  report.processor = ProcessorName();
  report.peak_memory = PeakMemory();
  outcome.parameters.assign(file.model.parameters().begin(), file.model.parameters().end());
  outcome.model_text = FormatModel(file);
  outcome.trace = fit.summary.trace;
  outcome.trace_text = FormatTrace(fit.summary.trace);
  outcome.report_text = JsonText(ToJson(report), 2) + "\n";
  return outcome;
}

// Columns of the trace, by the names that trace.csv has.
NamedValues TraceColumns(const Outcome& outcome) {
  const auto column = [&](const auto& value_of) {
    using T = std::decay_t<decltype(value_of(outcome.trace[0]))>;
    std::vector<T> values;
    for (const IterationRecord& record : outcome.trace) values.push_back(value_of(record));
    const size_t count = values.size();
    return OwnedArray(std::move(values), {count});
  };
  NamedValues columns;
  columns["iteration"] = column([](const IterationRecord& r) { return int64_t{r.iteration}; });
  columns["seconds"] = column([](const IterationRecord& r) { return r.seconds; });
  columns["objective"] = column([](const IterationRecord& r) { return r.objective; });
  columns["filtered"] = column([](const IterationRecord& r) { return uint8_t{r.filtered}; });
  columns["accepted"] = column([](const IterationRecord& r) { return uint8_t{r.accepted}; });
  columns["step"] = column([](const IterationRecord& r) { return r.step; });
  columns["optimality"] =
      column([](const IterationRecord& r) { return r.optimality.value_or(kUnknown); });
  columns["processor_seconds"] =
      column([](const IterationRecord& r) { return r.processor_seconds.value_or(kUnknown); });
  columns["objective_with_prior"] =
      column([](const IterationRecord& r) { return r.objective_with_prior.value_or(kUnknown); });
  return columns;
}

// The fields of trilobe.Solver.
using SolverTuples = std::vector<std::tuple<std::string, std::string, std::string, NamedValues>>;

SolverTuples ListSolvers() {
  SolverTuples list;
  for (const SolverEntry& solver : Solvers()) {
    NamedValues options;
    for (const SolverOption* const option : OptionsReadBy(solver.options)) {
      if (option->help.empty()) continue;
      const OptionValue value =
          option->unit ? OptionValue(option->unit->default_value) : option->get(SolverOptions());
      std::visit(
          [&](const auto& is) { options[option->flag.c_str()] = nb::make_tuple(is, option->help); },
          value);
    }
    list.emplace_back(solver.name, solver.description, solver.reference, options);
  }
  return list;
}

// (name, description) of each entry of a list.
template <typename T>
std::vector<std::pair<std::string, std::string>> Names(const std::vector<T>& entries) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const T& entry : entries) names.emplace_back(entry.name, entry.description);
  return names;
}

}  // namespace

void BindFit(nb::module_* module) {
  nb::class_<RunningFit>(*module, "RunningFit", "How far a fit has come; and the way to stop it.")
      .def(nb::init<>())
      .def("stop", &RunningFit::Stop)
      .def("latest", &RunningFit::Latest);
  nb::class_<Outcome>(*module, "Outcome", "What a fit has come to.")
      .def_ro("begun", &Outcome::begun)
      .def_ro("interrupted", &Outcome::interrupted)
      .def_ro("values", &Outcome::values)
      .def_ro("derivatives", &Outcome::derivatives)
      .def_prop_ro("model_text",
                   [](const Outcome& self) {
                     return nb::bytes(self.model_text.data(), self.model_text.size());
                   })
      .def("parameters",
           [](const Outcome& self) {
             return OwnedArray(std::vector<double>(self.parameters), {self.parameters.size()});
           })
      .def_ro("trace_text", &Outcome::trace_text)
      .def_prop_ro("report_text",
                   [](const Outcome& self) {
                     return nb::bytes(self.report_text.data(), self.report_text.size());
                   })
      .def("trace", &TraceColumns);
  module->def("fit", &RunFit, nb::arg("measured"), nb::arg("options"), nb::arg("solver_options"),
              nb::arg("running"), nb::arg("weights").none(), nb::arg("callback").none());
  module->def("solvers", &ListSolvers);
  module->def("initial_models", [] { return Names(InitialModels()); });
  module->def("weightings", [] { return Names(Weightings()); });
}

}  // namespace trilobe::python
