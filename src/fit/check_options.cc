#include "fit/check_options.h"

#include <cmath>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

FitOptions CheckOptions(FitOptions options) {
  CheckNumber("robust", options.robust, options.robust >= 0 && std::isfinite(options.robust),
              "finite and 0 or more");
  CheckNumber("smoothness", options.smoothness, options.smoothness >= 0 && options.smoothness <= 1,
              "from 0 to 1");
  if (options.raw) {
    if (options.robust > 0) throw Error("raw stores what the solver found; leave out robust");
    if (options.choose_form) throw Error("raw stores what the solver found; leave out choose_form");
    options.smoothness = 0;
    options.match_reflectance = false;
  }
  if (options.bands && options.choose_form) {
    throw Error(
        "--spectral takes a form that is given: --model=auto may choose a D for each channel");
  }
  const int most = options.max_parameters.value_or(1);
  CheckNumber("max_parameters", most, most >= 1, "at least 1");
  CheckNumThreads(options.num_threads);
  const auto complete = [&options, by_default = FitOptions()](const auto member) {
    if (!(options.*member)) options.*member = by_default.*member;
  };
  complete(&FitOptions::solver_options);
  complete(&FitOptions::on_begin);
  complete(&FitOptions::on_progress);
  complete(&FitOptions::on_start);
  complete(&FitOptions::on_iteration);
  complete(&FitOptions::on_model);
  return options;
}

}  // namespace trilobe
