#ifndef TRILOBE_IO_FORMATS_CSV_FILE_H_
#define TRILOBE_IO_FORMATS_CSV_FILE_H_

#include <span>
#include <string>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Writes a CSV file with a row per sample: its directions [degrees], its value and that of a model
// [1/sr]. fitted: [samples]. Throws Error if the file cannot be written.
void WriteBesideCsv(const BrdfSamples& measured, std::span<const Rgb> fitted,
                    const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_CSV_FILE_H_
