// E, its residuals and derivatives, by the library's sums, for other people's optimisers.

#include "trilobe/model/objective/objective.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/algebra/openblas.h"
#include "fit/azimuths.h"
#include "fit/choose_azimuths.h"
#include "fit_module.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "model/objective/sample_derivatives.h"
#include "named_values.h"
#include "owned_array.h"
#include "trilobe/fit/form.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/read_model.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

using Vector = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// The objective of a fit without a prior.
class FitObjective {
 public:
  FitObjective(const Measured& measured, const NamedValues& options,
               const std::optional<Weights>& weights)
      : data_(measured.data),
        objective_(Make(measured, options, weights)),
        equations_(objective_) {}

  const Objective& objective() const { return objective_; }

  // A model of these parameters. Throws Error unless their number is right and all are finite.
  FactorModel ModelAt(const Vector& x) const {
    FactorModel model(objective_.spec());
    const size_t wanted = model.parameters().size();
    if (x.shape(0) != wanted) {
      throw Error(ErrorKind::kMismatch, "x has " + std::to_string(x.shape(0)) +
                                            " parameters; the model has " + std::to_string(wanted))
          .About("x", x.shape(0));
    }
    for (size_t k = 0; k < wanted; ++k) {
      if (!std::isfinite(x.data()[k])) {
        throw Error(ErrorKind::kData, "x[" + std::to_string(k) + "] is not finite")
            .About("x[" + std::to_string(k) + "]", x.data()[k]);
      }
      model.parameters()[k] = x.data()[k];
    }
    return model;
  }

  QuadraticModel Expand(const FactorModel& model, Hessian hessian) {
    const BlasCall memory_is_there;
    const std::lock_guard lock(mutex_);  // it has work space of its own
    QuadraticModel result;
    equations_.Evaluate(model, hessian, &result);
    return result;
  }

  std::string ModelText(FactorModel model, const std::string& solver) const {
    CheckParameters(model);
    Canonicalize(objective_, &model);
    ModelFile file;
    file.fit.solver = solver;
    file.fit.weighting = objective_.weighting().name;
    file.fit.objective = file.fit.solver_objective = objective_.Value(model);
    file.fit.threads = objective_.num_threads();
    file.fit.source = data_->source;
    file.fit.source_xxh128 = data_->xxh128;
    file.fit.valid_samples = objective_.samples().size();
    file.fit.program = std::string("trilobe ") + TRILOBE_VERSION;
    file.unobserved = UnobservedParameters(objective_.coverage());
    file.model = std::move(model);
    return FormatModel(file);
  }

 private:
  static Objective Make(const Measured& measured, const nb::dict& options,
                        const std::optional<Weights>& weights) {
    const FitOptions fit = FitOptionsOf(options);
    std::optional<ModelSpec> like;
    if (options.contains("like")) {
      const auto text = OptionOf<nb::bytes>(options, "like", "the text of a model file");
      like = ParseModel({text.c_str(), text.size()}, "the model").model.spec();
    }
    std::shared_ptr<const Measurement> data = measured.data;
    const nb::gil_scoped_release released;
    if (!like && ChoosesAzimuths(*data, fit)) {
      data = std::make_shared<const Measurement>(WithAzimuthsChosen(*data, fit));
    }
    BrdfSamples samples = SamplesOf(*data);
    if (weights) samples = Weighted(std::move(samples), ByRow(*weights));
    const ModelSpec spec = like ? *like : SpecFor(*data, fit.form, samples.size());
    return Objective(std::move(samples), spec, fit.weighting, fit.num_threads);
  }

  std::shared_ptr<const Measurement> data_;
  Objective objective_;
  std::mutex mutex_;
  NormalEquations equations_;
};

double Value(const FitObjective& self, const Vector& x) {
  const FactorModel model = self.ModelAt(x);
  const nb::gil_scoped_release released;
  return self.objective().Value(model);
}

// E and dE/dx = 2 J'r.
std::tuple<double, NumpyArray<double>> ValueAndGradient(FitObjective* self, const Vector& x) {
  const FactorModel model = self->ModelAt(x);
  QuadraticModel quadratic;
  {
    const nb::gil_scoped_release released;
    quadratic = self->Expand(model, Hessian::kGaussNewton);
    for (double& g : quadratic.gradient) g *= 2;
  }
  const size_t n = quadratic.gradient.size();
  return {quadratic.objective, OwnedArray(std::move(quadratic.gradient), {n})};
}

// (H, J'r), H of E/2: J'J, or with the second derivatives.
std::tuple<NumpyArray<double>, NumpyArray<double>> Equations(FitObjective* self, const Vector& x,
                                                             bool newton) {
  const FactorModel model = self->ModelAt(x);
  QuadraticModel quadratic;
  {
    const nb::gil_scoped_release released;
    quadratic = self->Expand(model, newton ? Hessian::kNewton : Hessian::kGaussNewton);
  }
  const size_t n = quadratic.gradient.size();
  return {OwnedArray(std::move(quadratic.H), {n, n}),
          OwnedArray(std::move(quadratic.gradient), {n})};
}

NumpyArray<double> Residuals(const FitObjective& self, const Vector& x) {
  const FactorModel model = self.ModelAt(x);
  std::vector<double> residuals;
  {
    const nb::gil_scoped_release released;
    for (const WeightedSample& sample : self.objective().weighted_samples()) {
      for (int c = 0; c < kChannels; ++c) {
        residuals.push_back(std::sqrt(sample.weight[c]) *
                            (UnclampedValue(model, sample.stencils, c) - sample.rho[c]));
      }
    }
  }
  const size_t count = residuals.size();
  return OwnedArray(std::move(residuals), {count});
}

// J by rows: (values, columns, begin of each row and the end of the last), as scipy's csr_array
// takes it. Columns of unobserved entries are left out.
std::tuple<NumpyArray<double>, NumpyArray<int32_t>, NumpyArray<int64_t>> Jacobian(
    const FitObjective& self, const Vector& x) {
  const FactorModel model = self.ModelAt(x);
  std::vector<double> values;
  std::vector<int32_t> columns;
  std::vector<int64_t> rows = {0};
  {
    const nb::gil_scoped_release released;
    const std::vector<double>& coverage = self.objective().coverage();
    SampleDerivatives derivatives(model.spec().num_parameters());
    for (const WeightedSample& sample : self.objective().weighted_samples()) {
      for (int c = 0; c < kChannels; ++c) {
        derivatives.Set(model, sample.stencils, c);
        for (const int k : derivatives.touched()) {
          if (!(coverage[k] > 0)) continue;
          values.push_back(std::sqrt(sample.weight[c]) * derivatives[k]);
          columns.push_back(k);
        }
        rows.push_back(static_cast<int64_t>(values.size()));
      }
    }
  }
  const size_t count = values.size(), size = rows.size();
  return {OwnedArray(std::move(values), {count}), OwnedArray(std::move(columns), {count}),
          OwnedArray(std::move(rows), {size})};
}

NumpyArray<double> Start(const FitObjective& self, const std::string& init, uint64_t seed) {
  const InitialModel& start = FindInitialModel(init);
  std::vector<double> x;
  {
    const nb::gil_scoped_release released;
    const FactorModel model = start.make(self.objective(), seed);
    x.assign(model.parameters().begin(), model.parameters().end());
  }
  const size_t n = x.size();
  return OwnedArray(std::move(x), {n});
}

// The parameters of a model of the same form.
NumpyArray<double> ParametersOf(const FitObjective& self, const nb::bytes& text) {
  const FactorModel model = ParseModel({text.c_str(), text.size()}, "the model").model;
  CheckSameSpec(model.spec(), self.objective().spec());
  std::vector<double> x(model.parameters().begin(), model.parameters().end());
  const size_t n = x.size();
  return OwnedArray(std::move(x), {n});
}

NumpyArray<bool> Observed(const FitObjective& self) {
  const std::vector<double>& coverage = self.objective().coverage();
  const size_t n = coverage.size();
  auto observed = std::make_unique<bool[]>(n);  // NOLINT: a vector of bool is none of bytes
  for (size_t k = 0; k < n; ++k) observed[k] = coverage[k] > 0;
  bool* const data = observed.release();
  const nb::capsule owner(data, [](void* bools) noexcept { delete[] static_cast<bool*>(bools); });
  return NumpyArray<bool>(data, {n}, owner);
}

// (name, begin, end) of d, s, and each table of D, F and G.
std::vector<std::tuple<std::string, int, int>> Parts(const FitObjective& self) {
  const ModelSpec& spec = self.objective().spec();
  const FactorModel model(spec);
  std::vector<std::tuple<std::string, int, int>> parts = {
      {"d", 0, kChannels}, {"s", kChannels, kChannels * (1 + spec.lobes)}};
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const int begin = model.TableOffset(factor, t);
      parts.emplace_back(std::string(FactorName(factor)) + std::to_string(t), begin,
                         begin + spec.table_size(factor));
    }
  }
  return parts;
}

}  // namespace

void BindObjective(nb::module_* module) {
  nb::class_<FitObjective>(*module, "Objective", "E of a measurement, a form and a weighting.")
      .def(nb::init<const Measured&, const NamedValues&, const std::optional<Weights>&>(),
           nb::arg("measured"), nb::arg("options"), nb::arg("weights").none())
      .def_prop_ro(
          "num_parameters",
          [](const FitObjective& self) { return self.objective().spec().num_parameters(); })
      .def_prop_ro("num_samples",
                   [](const FitObjective& self) { return self.objective().samples().size(); })
      .def_prop_ro("measured_energy",
                   [](const FitObjective& self) { return self.objective().MeasuredEnergy(); })
      .def("observed", &Observed)
      .def("parts", &Parts)
      .def("start", &Start, nb::arg("init"), nb::arg("seed"))
      .def("parameters_of", &ParametersOf, nb::arg("text"))
      .def("value", &Value, nb::arg("x"))
      .def("value_and_gradient", &ValueAndGradient, nb::arg("x"))
      .def("equations", &Equations, nb::arg("x"), nb::arg("newton"))
      .def("residuals", &Residuals, nb::arg("x"))
      .def("jacobian", &Jacobian, nb::arg("x"))
      .def(
          "model_text",
          [](const FitObjective& self, const Vector& x, const std::string& solver) {
            const std::string text = self.ModelText(self.ModelAt(x), solver);
            return nb::bytes(text.data(), text.size());
          },
          nb::arg("x"), nb::arg("solver"));
}

}  // namespace trilobe::python
