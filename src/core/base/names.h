#ifndef TRILOBE_CORE_BASE_NAMES_H_
#define TRILOBE_CORE_BASE_NAMES_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {

// The entry of `choices` whose member `name` is `name`. Throws Error that lists the known names:
// "unknown weighting 'x'; known: compressive, log".
template <typename T>
const T& FindNamed(std::string_view what, std::string_view name, const std::vector<T>& choices) {
  std::string known;
  for (const T& choice : choices) {
    if (choice.name == name) return choice;
    known += (known.empty() ? "" : ", ") + std::string(choice.name);
  }
  throw Error("unknown " + std::string(what) + " '" + std::string(name) + "'; known: " + known);
}

// How many insertions, deletions and replacements of a character make one name the other
// (Levenshtein 1966).
size_t EditDistance(std::string_view a, std::string_view b);

// The one of `known`, which is not empty, that is the fewest edits away from
// `name`; of several, the first.
std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_NAMES_H_
