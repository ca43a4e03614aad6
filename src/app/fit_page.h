#ifndef TRILOBE_APP_FIT_PAGE_H_
#define TRILOBE_APP_FIT_PAGE_H_

#include <span>
#include <string>

namespace trilobe {

// What became of one of many measurements.
struct FitOutcome {
  enum class State { kMissing, kFitted, kKept, kInterrupted, kFailed };

  std::string name, source;
  State state = State::kMissing;
  std::string error = {};  // of kFailed: why
  // What a person would see, of a model: in words, and how much (NameOf(Visibility)).
  std::string verdict = {}, visibility = {};
  // Of the sphere (AppearanceReport) and of the fit; 0 where there is none.
  double psnr_db = 0, mean_delta_e = 0, mean_color_error = 0, objective = 0, seconds = 0;
  int num_parameters = 0;  // that the model stores
  bool has_picture = false;

  bool has_model() const { return state == State::kFitted || state == State::kKept; }
};

std::string StateName(FitOutcome::State state);

// A table, a row a measurement.
std::string FitsCsv(std::span<const FitOutcome> outcomes);

// A page with what failed, and the picture NAME/pair.png of each that did not, the least PSNR
// first.
std::string FitsPage(std::span<const FitOutcome> outcomes);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_PAGE_H_
