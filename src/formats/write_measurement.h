#ifndef TRILOBE_FORMATS_WRITE_MEASUREMENT_H_
#define TRILOBE_FORMATS_WRITE_MEASUREMENT_H_

#include <string>

#include "trilobe/brdf/measurement.h"

namespace trilobe {

// Writes a measurement in the format that the ending of the name says: .csv, .bin (UTIA's
// directions), else MERL. Returns what was written, for a message: "CSV, 12 samples". Throws Error
// where the format has no place for the data.
std::string WriteMeasurement(const Measurement& measurement, const std::string& path,
                             int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FORMATS_WRITE_MEASUREMENT_H_
