#ifndef TRILOBE_IO_FORMATS_TEXT_BAND_ADVICE_H_
#define TRILOBE_IO_FORMATS_TEXT_BAND_ADVICE_H_

#include <string>
#include <vector>

#include "io/formats/text/first_rows.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {

// Advice on columns that number bands, "band1", "B02", "MODIS_B1": which wavelengths these are a
// name does not say, but of known sensors. "" without such columns.
std::string AdviceOnBands(const std::vector<TableColumn>& columns, const FirstRows& rows);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_BAND_ADVICE_H_
