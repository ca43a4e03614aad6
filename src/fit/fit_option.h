#ifndef TRILOBE_FIT_FIT_OPTION_H_
#define TRILOBE_FIT_FIT_OPTION_H_

#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/option_value.h"
#include "trilobe/fit/fit_options.h"

namespace trilobe {

// An option of a fit. The program's flags, the "options" of scene files, the keywords of Python's
// `fit`, the keys of caches and checks are made from these rows.
struct FitOption {
  std::string name = {};           // "smoothness"
  std::string help = {};           // of the flag
  OptionValue default_value = {};  // of the flag: true or false, a number or a text
  OptionRange range = {};          // of a number

  bool follows_solver = false;  // a step that --raw leaves out
  bool of_form = false;         // part of FitOptions::form, which start_model replaces
  bool of_scenes = false;       // the fits of a scene take it, too
  bool changes_model = true;    // else it adds to the result
  // Sets it by the text of a flag: "0.01", "true", "12rx36". Throws Error, with flag and text, for
  // one that means nothing. CheckFitOptions checks ranges.
  void (*set)(std::string_view text, FitOptions* options) = nullptr;
  // A text that differs for different values.
  std::string (*get)(const FitOptions& options) = nullptr;
};

// All but the solver's options, the seed, threads and callbacks. --held_out draws by the seed of
// the fit, which callers may replace.
const std::vector<FitOption>& AllFitOptions();

// Throws Error for an unknown name.
const FitOption& FindFitOption(std::string_view name);

// Throws Error for numbers out of their ranges and for options that contradict each other.
void CheckFitOptions(const FitOptions& options);

// Throws Error for an option that follows the solver, with --raw.
[[noreturn]] void FailWithRaw(const FitOption& option);

// Whether an option differs from its default. Throws Error for an unknown name.
bool IsGiven(std::string_view name, const FitOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FIT_OPTION_H_
