#ifndef TRILOBE_APP_OWN_FILES_H_
#define TRILOBE_APP_OWN_FILES_H_

#include <string>

#include "trilobe/model/measurement/measurement.h"

// Files that may be overwritten or removed: those that Trilobe has written, and with --force any.

namespace trilobe {

// The member of a report or a plan that has checksums of files beside it, by their names.
inline constexpr const char* kChecksumsKey = "checksums";

// Throws Error if there is a file at `path` that Trilobe has not written, unless --force is given:
// its content does not say so (SaysOwn), and no report or plan beside it has its checksum. An empty
// file is nobody's.
void CheckMayReplace(const std::string& path);

// The same for a file that ReplaceMeasurement will write: a MERL or UTIA file, which cannot say who
// wrote it, is let pass.
void CheckMayReplaceMeasurement(const std::string& path);

// WriteMeasurement. Throws Error, and leaves the file at `path`, if it cannot say who wrote it and
// would become another, unless --force is given.
std::string ReplaceMeasurement(const Measurement& measurement, const std::string& path,
                               int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_APP_OWN_FILES_H_
