#ifndef TRILOBE_CORE_BASE_NAMED_H_
#define TRILOBE_CORE_BASE_NAMED_H_

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

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_NAMED_H_
