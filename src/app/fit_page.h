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
  std::string error = {};    // of kFailed: why
  std::string undrawn = {};  // why pictures are missing; "" if they are not
  // What a person would see, of a model: in words, and how much (NameOf(Visibility)).
  std::string verdict = {}, visibility = {};
  // Of the sphere (AppearanceReport) and of the fit; 0 where there is none.
  double psnr_db = 0, mean_delta_e = 0, mean_color_error = 0, objective = 0, seconds = 0;
  int num_parameters = 0;  // that the model stores
  bool anisotropic = false;
  bool has_picture = false;
  // In its folder: what the page of all shows of it, and leads to.
  std::string picture = "pair.png", page = "report.json";

  bool has_model() const { return state == State::kFitted || state == State::kKept; }
};

std::string StateName(FitOutcome::State state);

// A table, a row a measurement.
std::string FitsCsv(std::span<const FitOutcome> outcomes);

// A page with what failed, and the picture of each that did not, the least PSNR first; it can be
// sorted and filtered, and shows up to four of them side by side. `table`: the address of
// FitsCsv's, if there is one.
std::string FitsPage(std::span<const FitOutcome> outcomes, const std::string& table);

// What stands beside the folders of several fits.
inline constexpr const char* kTableName = "fits.csv";
inline constexpr const char* kPageName = "index.html";

// What a measurement's folder is called: synth:NAME's or a file's name, without its ending unless
// only with it that can be a folder beside the others.
std::string FitNameOf(const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_PAGE_H_
