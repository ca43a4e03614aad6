#include "fit/complete_options.h"

namespace trilobe {

FitOptions CompleteOptions(FitOptions options) {
  if (options.raw) {
    options.smoothness = 0;
    options.match_reflectance = false;
  }
  const auto complete = [&options, by_default = FitOptions()](const auto member) {
    if (!(options.*member)) options.*member = by_default.*member;
  };
  complete(&FitOptions::solver_options);
  complete(&FitOptions::on_begin);
  complete(&FitOptions::on_stage);
  complete(&FitOptions::on_progress);
  complete(&FitOptions::on_start);
  complete(&FitOptions::on_iteration);
  complete(&FitOptions::on_model);
  return options;
}

}  // namespace trilobe
