#ifndef TRILOBE_IO_FORMATS_TRACE_FILE_H_
#define TRILOBE_IO_FORMATS_TRACE_FILE_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

// The iterations of a fit as CSV: the header
//   iteration,seconds,objective,filtered,accepted,step,optimality,processor_seconds
// then one row per IterationRecord. filtered and accepted are 0 or 1; optimality is empty if
// unknown. Older files lack processor_seconds. With a prior, objective_with_prior is one column
// more (guided_objective in older files). Numbers read back to the same double in any locale.
// Throws Error, which names file, line and column, for other rows and for numbers that are not
// finite and >= 0.
std::string FormatTrace(std::span<const IterationRecord> records);
std::vector<IterationRecord> ParseTrace(std::string_view text, const std::string& source);
void WriteTrace(const std::string& path, std::span<const IterationRecord> records);
std::vector<IterationRecord> ReadTrace(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TRACE_FILE_H_
