#ifndef TRILOBE_BASE_NEAREST_NAME_H_
#define TRILOBE_BASE_NEAREST_NAME_H_

#include <string_view>
#include <vector>

namespace trilobe {

// The one of `known`, which is not empty, that takes the fewest insertions, deletions and
// replacements of a character to become `name` (Levenshtein 1966); of several, the first.
std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace trilobe

#endif  // TRILOBE_BASE_NEAREST_NAME_H_
