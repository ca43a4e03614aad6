#ifndef TRILOBE_IO_FORMATS_TEXT_MATRIX_TABLE_H_
#define TRILOBE_IO_FORMATS_TEXT_MATRIX_TABLE_H_

#include <string>
#include <string_view>

namespace trilobe {

// Matrices of values, whose rows are one angle and whose columns another, as a table of a row a
// value: "theta_o,phi_o,f". Above the values stands a row of the columns' angles, with or without a
// cell above those of the rows; lines of text between two matrices, as "theta_i = 30", stay. `axes`
// names the angles, "theta_o/phi_o"; without, the first cell of the header does ("theta_o\phi_o").
// "" where text is no matrix. Throws Error, with the line, for one with gaps in its angles.
std::string RowsOfMatrices(std::string_view text, const std::string& source, std::string_view axes);

// Whether --columns names the axes of a matrix.
bool NamesAxes(std::string_view columns);

// Whether one of the first lines is the header of a matrix, with the names of its axes.
bool HasAxes(std::string_view text);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_MATRIX_TABLE_H_
