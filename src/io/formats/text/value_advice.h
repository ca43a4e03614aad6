#ifndef TRILOBE_IO_FORMATS_TEXT_VALUE_ADVICE_H_
#define TRILOBE_IO_FORMATS_TEXT_VALUE_ADVICE_H_

#include <string>
#include <vector>

#include "io/formats/text/first_rows.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {

// Advice if the names of columns say that values are not a BRDF in 1/sr, else "".
std::string AdviceOnScale(const std::vector<TableColumn>& columns);

// Advice on columns without one of values: which holds f times something, or what else; or "".
std::string AdviceOnValues(const std::vector<TableColumn>& columns, const FirstRows& rows);

// Whether the name of a column is one of values, "brdf_data", or of those that are no BRDF.
bool IsKnownValue(const TableColumn& column);

// The column of transmitted light, if there is one and none of values, or "".
std::string AdviceOnTransmission(const std::vector<TableColumn>& columns);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_VALUE_ADVICE_H_
