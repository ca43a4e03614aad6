#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/system/process.h"
#include "fit/reports/bin_counts.h"
#include "fit_module.h"
#include "io/formats/completed_measurement.h"
#include "io/formats/databases/utia_file.h"
#include "named_values.h"
#include "owned_array.h"
#include "trilobe/fit/as_measurement.h"
#include "trilobe/fit/export/convert.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/measurement/synth.h"
#include "trilobe/model/measurement/tabulated_brdf.h"
#include "trilobe/model/read_model.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

using Doubles = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

Measured Read(const std::string& source, const NamedValues& options) {
  const SourceOptions source_options = SourceOptionsOf(options);
  const nb::gil_scoped_release released;
  Stopwatch stopwatch;
  Measured measured{
      .data = std::make_shared<const Measurement>(LoadMeasurement(source, source_options)),
      .noise = source_options.noise,
      .seed = static_cast<int64_t>(source_options.seed)};
  measured.seconds = stopwatch.Lap();
  return measured;
}

DirectionPair PairOf(const double* wi, const double* wo) {
  const auto unit = [](const double* w) {
    const double length = std::hypot(w[0], w[1], w[2]);
    return Direction{w[0] / length, w[1] / length, w[2] / length};
  };
  return {unit(wi), unit(wo)};
}

// Scattered samples. Whether azimuths matter is for `azimuths` to say: "yes", "no", or "auto".
Measured FromArrays(const Doubles& wi, const Doubles& wo, const Doubles& rho,
                    const std::string& source, const std::string& azimuths,
                    const NamedValues& options) {
  const size_t count = rho.shape(0);
  for (const Doubles* const array : {&wi, &wo, &rho}) {
    if (array->shape(0) != count || array->shape(1) != 3) {
      throw Error(ErrorKind::kMismatch, "wi, wo and rho must have the same shape (n, 3)")
          .About("wi, wo, rho");
    }
  }
  const SourceOptions source_options = SourceOptionsOf(options);
  const nb::gil_scoped_release released;
  SampleCollector collector(source, "set of arrays");
  for (size_t k = 0; k < count; ++k) {
    const DirectionPair pair = PairOf(wi.data() + 3 * k, wo.data() + 3 * k);
    collector.Add(ToSphericalAngles(pair),
                  {rho.data()[3 * k], rho.data()[3 * k + 1], rho.data()[3 * k + 2]});
  }
  Measurement measurement = azimuths == "auto" ? collector.TakeByAzimuths() : collector.Take();
  if (azimuths != "auto") {
    measurement.anisotropic = measurement.azimuths_matter = azimuths == "yes";
  }
  TakeMerlBinsAsTable(&measurement);
  if (azimuths == "auto" && measurement.anisotropic) {
    measurement.notes.emplace_back(
        "light comes from several azimuths: a fit finds out whether the material depends on them; "
        "anisotropic=True or anisotropic=False says so, and is sooner fitted");
  }
  if (source_options.min_theta_d_deg < 0) LeaveOutOwnShadow(&measurement);
  DecideMeasured(source_options, &measurement);
  return {.data = std::make_shared<const Measurement>(std::move(measurement))};
}

// Valid samples have 0; the other numbers are those of ReasonsOf's keys, from 1 on.
std::vector<std::string> ReasonNames() {
  std::vector<std::string> names = {"valid"};
  for (const LeftOut& left_out : ReasonsOf({})) names.push_back(left_out.key);
  return names;
}

uint8_t ReasonNamed(const char* name) {
  const std::vector<std::string> names = ReasonNames();
  const auto at = std::ranges::find(names, name);
  return static_cast<uint8_t>(at - names.begin());
}

// Why each bin of a table is left out, as CountBins has it.
std::vector<uint8_t> ReasonsOfBins(const BrdfTable& table) {
  const uint8_t below = ReasonNamed("below_surface"), non_finite = ReasonNamed("non_finite"),
                negative = ReasonNamed("negative");
  const std::array<uint8_t, 5> unmeasured = {
      0, ReasonNamed("extrapolated"), ReasonNamed("beyond_nodes"), ReasonNamed("beyond_max_angle"),
      ReasonNamed("below_min_theta_d")};
  const std::vector<bool> above = BinsAboveSurface(table.grid);
  std::vector<uint8_t> reasons(table.grid.size());
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    const std::array<double, 3> stored = {table.stored[0][bin], table.stored[1][bin],
                                          table.stored[2][bin]};
    if (!above[bin]) {
      reasons[bin] = below;
    } else if (!std::ranges::all_of(stored, [](double x) { return std::isfinite(x); })) {
      reasons[bin] = non_finite;
    } else if (std::ranges::any_of(stored, [](double x) { return x < 0; })) {
      reasons[bin] = negative;
    } else {
      reasons[bin] = unmeasured[static_cast<size_t>(ReasonOf(table, bin))];
    }
  }
  return reasons;
}

size_t CountOf(const Measured& measured) {
  const Measurement& data = *measured.data;
  return data.table ? data.table->grid.size() : data.samples.size();
}

NumpyArray<double> DirectionsOf(const Measured& measured, bool incident) {
  const Measurement& data = *measured.data;
  const size_t count = CountOf(measured);
  std::vector<double> values;
  {
    const nb::gil_scoped_release released;
    values.reserve(3 * count);
    for (size_t k = 0; k < count; ++k) {
      const int at = static_cast<int>(k);
      const DirectionPair pair = data.table ? ToDirections(data.table->grid.Center(at))
                                 : data.samples.directions.empty()
                                     ? ToDirections(data.samples.Angles(at))
                                     : ToDirections(data.samples.directions[k]);
      const Direction& w = incident ? pair.wi : pair.wo;
      values.insert(values.end(), w.begin(), w.end());
    }
  }
  return OwnedArray(std::move(values), {count, size_t{3}});
}

NumpyArray<double> ValuesOf(const Measured& measured) {
  const Measurement& data = *measured.data;
  const size_t count = CountOf(measured);
  std::vector<double> values;
  {
    const nb::gil_scoped_release released;
    values.reserve(3 * count);
    for (size_t k = 0; k < count; ++k) {
      for (int c = 0; c < kChannels; ++c) {
        values.push_back(data.table ? data.table->Value(c, static_cast<int>(k))
                                    : data.samples.rho[k][c]);
      }
    }
  }
  return OwnedArray(std::move(values), {count, size_t{3}});
}

NumpyArray<uint8_t> ReasonsOfAll(const Measured& measured) {
  const Measurement& data = *measured.data;
  std::vector<uint8_t> reasons =
      data.table ? ReasonsOfBins(*data.table) : std::vector<uint8_t>(data.samples.size());
  const size_t count = reasons.size();
  return OwnedArray(std::move(reasons), {count});
}

ConvertOptions ConvertOptionsOf(const nb::dict& options) {
  const int threads = ThreadsOf(options);
  return {.error = OptionOf<double>(options, "error", "a number"),
          .spectral = OptionOf<bool>(options, "spectral", "True or False"),
          .program = std::string("trilobe ").append(TRILOBE_VERSION),
          .appearance = {.num_threads = threads},
          .num_threads = threads};
}

// Lines that say what was written.
using Lines = std::vector<std::string>;

// Writes as `trilobe convert` does, from a model file's text or a measurement.
Lines ConvertModel(const nb::bytes& model_text, const std::string& path, const NamedValues& given) {
  const ModelFile file = ParseModel({model_text.c_str(), model_text.size()}, "the model");
  const ConvertOptions options = ConvertOptionsOf(given);
  const nb::gil_scoped_release released;
  if (IsForRenderer(path)) return WriteForRenderer(file, "the model", path, options);
  if (file.model.spec().anisotropic() && !WritableFormat(path).holds_anisotropic) {
    throw ErrorIn(ErrorKind::kUnsupported, path,
                  "an anisotropic model is written as .bin (UTIA's directions), .csv, "
                  ".bsdf, .zemax.bsdf, .xml, .glsl, .hlsl, .mtlx, .principled.json, .gltf or .usda")
        .About("anisotropic");
  }
  const Measurement measurement =
      AsMeasurement(file.model, "the model", options.num_threads, kUtiaGrid);
  return {WriteMeasurement(measurement, path, options.num_threads)};
}

Lines ConvertMeasurement(const Measured& measured, const std::string& path,
                         const NamedValues& given) {
  const ConvertOptions options = ConvertOptionsOf(given);
  const std::shared_ptr<const Measurement> data = measured.data;
  const nb::gil_scoped_release released;
  if (IsForRenderer(path)) return WriteForRenderer(*data, path, options);
  return {WriteMeasurement(*data, path, options.num_threads)};
}

// A measurement as a function of all directions, and the ratios that it interpolates.
struct Completed {
  Completed(const nb::bytes& model_text, const Measured& measured, const NamedValues& options)
      : data(measured.data) {
    const ModelFile file = ParseModel({model_text.c_str(), model_text.size()}, "the model");
    const int threads = ThreadsOf(options);
    const nb::gil_scoped_release released;
    completed = Complete(*data, file.model, threads);
  }

  std::shared_ptr<const Measurement> data;
  CompletedMeasurement completed;
};

// How many bins there are over (theta_h, theta_d, phi_d), or nodes over (theta_i, phi_i, theta_o,
// phi_o); none where it is the model.
std::vector<int> ShapeOf(const Completed& self) {
  if (self.completed.over_table) {
    const MerlGrid& grid = self.data->table->grid;
    return {grid.theta_h, grid.theta_d, grid.phi_d};
  }
  if (!self.completed.over_nodes) return {};
  const HemisphereGrid& grid = self.completed.over_nodes->table().grid;
  return {grid.thetas, grid.phis, grid.thetas, grid.phis};
}

NumpyArray<float> RatiosOf(const Completed& self) {
  std::vector<float> ratios;
  const auto add = [&](const Rgb& ratio) {
    for (const double x : ratio) ratios.push_back(static_cast<float>(x));
  };
  if (self.completed.over_table) {
    const int bins = self.data->table->grid.size();
    for (int bin = 0; bin < bins; ++bin) add(self.completed.over_table->Value(bin));
  } else if (self.completed.over_nodes) {
    for (const Rgb& ratio : self.completed.over_nodes->values()) add(ratio);
  }
  const size_t places = ratios.size() / kChannels;
  return OwnedArray(std::move(ratios), {places, size_t{kChannels}});
}

NumpyArray<double> EvalOf(const Completed& self, const Doubles& wi, const Doubles& wo) {
  const size_t count = wi.shape(0);
  if (wo.shape(0) != count || wi.shape(1) != 3 || wo.shape(1) != 3) {
    throw Error(ErrorKind::kMismatch, "wi and wo must both have the shape (n, 3)").About("wi, wo");
  }
  const double *const i = wi.data(), *const o = wo.data();
  std::vector<double> values;
  {
    const nb::gil_scoped_release released;
    for (size_t k = 0; k < 3 * count; k += 3) {
      const DirectionPair pair = {{i[k], i[k + 1], i[k + 2]}, {o[k], o[k + 1], o[k + 2]}};
      const bool above = pair.wi[2] > 0 && pair.wo[2] > 0;
      const Rgb rho = above ? self.completed.value(pair) : Rgb{};
      values.insert(values.end(), rho.begin(), rho.end());
    }
  }
  return OwnedArray(std::move(values), {count, size_t{3}});
}

}  // namespace

void BindMeasurement(nb::module_* module) {
  module->def("reasons", &ReasonNames);
  nb::class_<Measured>(*module, "Measured", "A measurement in memory.")
      .def_prop_ro("source", [](const Measured& self) { return self.data->source; })
      .def_prop_ro("xxh128", [](const Measured& self) { return self.data->xxh128; })
      .def_prop_ro("kind", [](const Measured& self) { return self.data->kind; })
      .def_prop_ro("anisotropic", [](const Measured& self) { return self.data->anisotropic; })
      .def_prop_ro("notes", [](const Measured& self) { return self.data->notes; })
      .def_prop_ro("max_angle", [](const Measured& self) { return MaxAngleDegrees(*self.data); })
      .def_prop_ro("counts_json",
                   [](const Measured& self) { return ToJson(CountsOf(*self.data)).dump(); })
      .def_prop_ro("grid",
                   [](const Measured& self) {
                     std::vector<int> sizes;
                     if (self.data->table) {
                       const MerlGrid& grid = self.data->table->grid;
                       sizes = {grid.theta_h, grid.theta_d, grid.phi_d};
                     }
                     return sizes;
                   })
      .def("directions", &DirectionsOf, nb::arg("incident"))
      .def("values", &ValuesOf)
      .def("reasons", &ReasonsOfAll);
  module->def("read", &Read, nb::arg("source"), nb::arg("options"));
  module->def("from_arrays", &FromArrays, nb::arg("wi"), nb::arg("wo"), nb::arg("rho"),
              nb::arg("source"), nb::arg("azimuths"), nb::arg("options"));
  module->def("convert_model", &ConvertModel, nb::arg("text"), nb::arg("path"), nb::arg("options"));
  module->def("convert_measurement", &ConvertMeasurement, nb::arg("measured"), nb::arg("path"),
              nb::arg("options"));
  nb::class_<Completed>(*module, "Completed", "A measurement as a function of all directions.")
      .def(nb::init<const nb::bytes&, const Measured&, const NamedValues&>(), nb::arg("model"),
           nb::arg("measured"), nb::arg("options"))
      .def_prop_ro("shape", &ShapeOf)
      .def_prop_ro("offset", [](const Completed& self) { return self.completed.offset; })
      .def("ratios", &RatiosOf)
      .def("eval", &EvalOf, nb::arg("wi"), nb::arg("wo"));
  module->def("synthetic_materials", [] {
    std::vector<std::string> names;
    for (const SynthMaterial& material : SynthMaterials()) names.push_back(material.name);
    return names;
  });
}

}  // namespace trilobe::python
