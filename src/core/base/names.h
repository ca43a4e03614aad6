#ifndef TRILOBE_CORE_BASE_NAMES_H_
#define TRILOBE_CORE_BASE_NAMES_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {

// The entry of `choices` whose member `name` equals `name`. If there is none, throws Error with the
// known names: "unknown weighting 'x'; known: compressive, log".
template <typename T>
const T& FindNamed(std::string_view what, std::string_view name, const std::vector<T>& choices) {
  std::string known;
  for (const T& choice : choices) {
    if (choice.name == name) return choice;
    known += (known.empty() ? "" : ", ") + std::string(choice.name);
  }
  throw Error(ErrorKind::kUnknown,
              "unknown " + std::string(what) + " '" + std::string(name) + "'; known: " + known)
      .About(what, name);
}

// Number of character insertions, deletions and replacements that turn one name into the other
// (Levenshtein 1966).
size_t EditDistance(std::string_view a, std::string_view b);

// The element of `known` (not empty) with the smallest edit distance to `name`; the first on ties.
std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_NAMES_H_
