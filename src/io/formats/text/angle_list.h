#ifndef TRILOBE_IO_FORMATS_TEXT_ANGLE_LIST_H_
#define TRILOBE_IO_FORMATS_TEXT_ANGLE_LIST_H_

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/files/text_lines.h"

namespace trilobe {

// Angles that a header of Zemax or LightTools lists: a key with their number and, on the next line,
// these [degrees], ascending.
struct AngleList {
  const char* key;
  double min_deg, max_deg;
};
std::vector<double> ReadAngleList(const AngleList& list, std::string_view count, TextLines* lines);

// The numbers of the line where `lines` is. Throws Error unless there are `count` of them.
std::vector<double> ReadNumbersOfLine(const TextLines& lines, size_t count, const char* what);

// Number of entries without a last one that repeats the first a whole turn later.
size_t Distinct(const std::vector<double>& degrees);

// Position of x among ascending nodes: `t` of the way from `lower` to the next; at the end beyond
// an end, and at the node if there is only one.
struct BetweenNodes {
  size_t lower = 0;
  double t = 0;
};
BetweenNodes FindBetween(const std::vector<double>& nodes, double x);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_ANGLE_LIST_H_
