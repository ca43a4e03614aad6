#ifndef TRILOBE_CORE_BASE_NAMES_H_
#define TRILOBE_CORE_BASE_NAMES_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/error.h"

namespace trilobe {

// The name of `known` that another one was probably meant to be: nearest by EditDistance, by which
// at most a third of its letters differ. Empty if there is none.
std::string MeantName(std::string_view name, const std::vector<std::string_view>& known);

// "unknown weighting 'lug'; known: compressive, log; did you mean 'log'?"
Error UnknownName(std::string_view what, std::string_view name,
                  const std::vector<std::string_view>& known);

// The entry of `choices` whose member `name` equals `name`. Throws UnknownName if there is none.
template <typename T>
const T& FindNamed(std::string_view what, std::string_view name, const std::vector<T>& choices) {
  std::vector<std::string_view> known;
  for (const T& choice : choices) {
    if (choice.name == name) return choice;
    known.push_back(choice.name);
  }
  throw UnknownName(what, name, known);
}

// Number of character insertions, deletions, replacements and swaps of neighbours that turn one
// name into the other, no character edited twice (Damerau 1964, Levenshtein 1966).
size_t EditDistance(std::string_view a, std::string_view b);

// The element of `known` (not empty) with the smallest edit distance to `name`; the first on ties.
std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known);

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_NAMES_H_
