#ifndef TRILOBE_CORE_BASE_NEAREST_NAME_H_
#define TRILOBE_CORE_BASE_NEAREST_NAME_H_

#include <cstddef>
#include <string_view>
#include <vector>

namespace trilobe {

// How many insertions, deletions and replacements of a character make one name the other
// (Levenshtein 1966).
size_t EditDistance(std::string_view a, std::string_view b);

// The one of `known`, which is not empty, that is the fewest edits away from
// `name`; of several, the first.
std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_NEAREST_NAME_H_
