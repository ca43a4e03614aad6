#ifndef TRILOBE_IO_MODEL_FILES_TRACE_FILE_H_
#define TRILOBE_IO_MODEL_FILES_TRACE_FILE_H_

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

// The iterations of a fit as CSV: the header
//   iteration,seconds,objective,filtered,accepted,step,optimality
// then a row a record, with the members of IterationRecord: filtered and accepted are 0 or 1,
// optimality is empty where it is unknown. Of a fit with a prior, objective_with_prior is an eighth
// column (guided_objective in older files). Numbers read back to the same double, whatever the
// locale. A row that is not of this form, or a number that is not finite and >= 0, is an Error that
// names file, line and column.
std::string FormatTrace(std::span<const IterationRecord> records);
std::vector<IterationRecord> ParseTrace(std::string_view text, const std::string& source);
void WriteTrace(const std::string& path, std::span<const IterationRecord> records);
std::vector<IterationRecord> ReadTrace(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_IO_MODEL_FILES_TRACE_FILE_H_
