#ifndef TRILOBE_IO_FORMATS_EXPORTS_EXPORTED_BRDF_H_
#define TRILOBE_IO_FORMATS_EXPORTS_EXPORTED_BRDF_H_

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "io/formats/completed_measurement.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A BRDF for files of other programs, and the places at which these are compared with it.
struct ExportedBrdf {
  PairBrdf value;
  bool anisotropic = false;
  std::vector<CompletedMeasurement::Place> places;
};

// The BRDF of a model, of which no reference is kept; its places are no farther than max_theta
// [rad] from the normal. Throws Error for parameters that CheckParameters refuses.
ExportedBrdf ExportedModel(const FactorModel& model, double max_theta);

// Relative errors of rho cos theta_o of a file, over the places: their median, and their 99 %
// quantile. Throws Error if there are no places, as there is no light.
struct ExportError {
  double median = 0, high = 0;
};
ExportError MeasureError(const PairBrdf& file,
                         const std::vector<CompletedMeasurement::Place>& places);

// Whether the channels of each value are equal, but for rounding.
bool AreGrey(const std::vector<Rgb>& values);

// The first of `count` ever finer files whose median_error is at most max_error, or else of all of
// them the first that is hardly worse than the best.
template <typename File>
File ChooseSmallest(int count, const std::function<File(int)>& make, double max_error) {
  constexpr double kHardlyWorse = 1.1;
  std::vector<File> files;
  for (int k = 0; k < count; ++k) {
    files.push_back(make(k));
    if (files.back().median_error <= max_error) return files.back();
  }
  const auto error = [](const File& file) { return file.median_error; };
  const double best = std::ranges::min_element(files, {}, error)->median_error;
  return *std::ranges::find_if(
      files, [&](const File& file) { return file.median_error <= kHardlyWorse * best; });
}

// Appends a number of six digits, "1.23457e-02" or "0".
void AppendNumber(double number, std::string* text);

// Throws Error, with the size in bytes and the error, for a file that is not as exact as asked for.
void RequireExact(size_t bytes, double median_error, double max_error);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_EXPORTS_EXPORTED_BRDF_H_
