#ifndef TRILOBE_IO_FORMATS_TEXT_SPECTRA_OF_ROWS_H_
#define TRILOBE_IO_FORMATS_TEXT_SPECTRA_OF_ROWS_H_

#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "io/formats/spectrum_bands.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Spectra of a table with a row for each direction and wavelength, in any order.
class SpectraOfRows {
 public:
  static constexpr size_t kMostWavelengths = 1024;
  // The value [1/sr] at a wavelength [nm]; NaN where there is none. False, and not added, if there
  // are more wavelengths than that.
  bool Add(const SphericalAngles& at, double wavelength, double value);

  std::vector<double> wavelengths() const;  // ascending

  // A sample a direction, in the order in which they came; a direction that has a wavelength once
  // more is another sample. Those without one of the wavelengths that are read count as missing.
  void AddTo(SpectrumBands* bands, SampleCollector* collector) const;

 private:
  struct Sample {
    SphericalAngles at;
    std::vector<std::pair<double, double>> values = {};  // wavelength, value
  };
  std::map<std::array<double, 4>, size_t> last_;  // of each direction, the sample
  std::vector<Sample> samples_;
  std::set<double> wavelengths_;
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_SPECTRA_OF_ROWS_H_
