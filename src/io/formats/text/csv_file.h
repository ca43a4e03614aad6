#ifndef TRILOBE_IO_FORMATS_TEXT_CSV_FILE_H_
#define TRILOBE_IO_FORMATS_TEXT_CSV_FILE_H_

#include <functional>
#include <span>
#include <string>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Writes a CSV file with a row per sample: its directions [degrees], its value and that of a model
// [1/sr]. fitted: [samples]. Throws Error if the file cannot be written.
void WriteBesideCsv(const BrdfSamples& measured, std::span<const Rgb> fitted,
                    const std::string& path);

// The same with a column a wavelength [nm], which reads back as spectra. spectrum(j, values) sets
// the values of sample j [1/sr], [wavelengths].
void WriteSpectraCsv(const BrdfSamples& at, std::span<const double> wavelengths,
                     const std::function<void(int, std::span<double>)>& spectrum,
                     const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_CSV_FILE_H_
