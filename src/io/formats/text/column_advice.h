#ifndef TRILOBE_IO_FORMATS_TEXT_COLUMN_ADVICE_H_
#define TRILOBE_IO_FORMATS_TEXT_COLUMN_ADVICE_H_

#include <string>
#include <vector>

#include "io/formats/text/column_layout.h"
#include "io/formats/text/first_rows.h"

namespace trilobe {

// Advice on a table that lacks columns of values, or of angles that are not given, if these may
// follow from another column, by the names and the first rows. "": nothing is missing, or nothing
// is known of its columns.
std::string AdviceOn(const std::vector<TableColumn>& columns, const GivenAngles& given,
                     const FirstRows& rows);

// Question whether a column of reflectance holds f or pi f, with what comes back of the light
// in the first case, 0 if nothing tells.
std::string AdviceOnFactor(const std::string& name, double albedo);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_COLUMN_ADVICE_H_
