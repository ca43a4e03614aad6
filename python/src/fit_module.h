#ifndef TRILOBE_PYTHON_FIT_MODULE_H_
#define TRILOBE_PYTHON_FIT_MODULE_H_

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::python {

// A measurement, and how it was read. Shared with fits that run while Python forgets it.
struct Measured {
  std::shared_ptr<const Measurement> data;
  double noise = 0;
  int64_t seed = 1;
  double seconds = 0;  // that reading it took
};

// An option by its name, which must be of this type.
template <typename T>
T OptionOf(const nanobind::dict& options, const char* name, const char* must_be) {
  T value{};
  if (!options.contains(name) || !nanobind::try_cast<T>(options[name], value)) {
    throw Error(ErrorKind::kFormat, std::string(name) + " must be " + must_be).About(name);
  }
  return value;
}

// The threads to use: as many as are wanted, but no more than there are cores; 0 is all of these.
int ThreadsOf(const nanobind::dict& options);
// How a source is read.
SourceOptions SourceOptionsOf(const nanobind::dict& options);

// How a model is fitted, by the names that trilobe.fit has, without the solver's options and seed.
FitOptions FitOptionsOf(const nanobind::dict& options);

// How often each valid sample counts. [samples]
using Weights =
    nanobind::ndarray<const double, nanobind::ndim<1>, nanobind::c_contig, nanobind::device::cpu>;
std::vector<double> ByRow(const Weights& weights);
// In the place of how much they count by their density (EvenOutDensity). Throws Error unless there
// is a weight for each sample.
BrdfSamples Weighted(BrdfSamples samples, const std::vector<double>& weights);

void BindMeasurement(nanobind::module_* module);
void BindFit(nanobind::module_* module);
void BindDirections(nanobind::module_* module);
void BindObjective(nanobind::module_* module);
void BindScore(nanobind::module_* module);
void BindTexels(nanobind::module_* module);

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_FIT_MODULE_H_
