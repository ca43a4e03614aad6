#ifndef TRILOBE_IO_FORMATS_TEXT_PHASE_COLUMN_H_
#define TRILOBE_IO_FORMATS_TEXT_PHASE_COLUMN_H_

#include <vector>

#include "io/formats/text/first_rows.h"
#include "io/formats/text/table_columns.h"

namespace trilobe {

// Makes the column "phi" beside "i" and "e" that of the phase if its numbers say so: they are the
// other angle wherever one of the two is 0, and angles between two such directions everywhere.
void MarkPhase(const FirstRows& rows, std::vector<TableColumn>* columns);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_PHASE_COLUMN_H_
