#ifndef TRILOBE_APP_FIT_PAGE_H_
#define TRILOBE_APP_FIT_PAGE_H_

#include <span>
#include <string>

namespace trilobe {

// Outcome of the fit of one of several measurements.
struct FitOutcome {
  enum class State { kMissing, kFitted, kKept, kInterrupted, kFailed };

  std::string name, source;
  State state = State::kMissing;
  std::string error = {};    // message, for kFailed
  std::string earlier = {};  // FitRun::earlier
  std::string undrawn = {};  // why pictures are missing; empty if they are not
  // Visible difference of the model in words, and its grade (NameOf(Visibility)).
  std::string verdict = {}, visibility = {};
  // Errors of the sphere (AppearanceReport) and of the fit; 0 if unknown.
  double psnr_db = 0, mean_delta_e = 0, mean_color_error = 0, objective = 0, seconds = 0;
  int num_parameters = 0;  // stored
  bool anisotropic = false;
  bool glows = false;  // reflects more light than falls on it, somewhere
  bool has_picture = false;
  // Files in its folder that the index page shows and links to.
  std::string picture = "pair.png", page = "report.json";

  bool has_model() const { return state == State::kFitted || state == State::kKept; }
};

std::string StateName(FitOutcome::State state);

// CSV with one row per measurement.
std::string FitsCsv(std::span<const FitOutcome> outcomes);

// HTML page that lists failures and shows the picture of each fit, lowest PSNR first. It sorts,
// filters, and compares up to four fits side by side: their models under one light, which it
// holds of up to 200 fits.
// `folder` has the folders of the fits; `table`: link to the CSV, or empty.
std::string FitsPage(std::span<const FitOutcome> outcomes, const std::string& folder,
                     const std::string& table);

// Files beside the folders of several fits.
inline constexpr const char* kTableName = "fits.csv";
inline constexpr const char* kPageName = "index.html";

// Folder name of a measurement: NAME of synth:NAME, or the file name without its extension, unless
// that is "." or ".." or one of the files above.
std::string FitNameOf(const std::string& source);

}  // namespace trilobe

#endif  // TRILOBE_APP_FIT_PAGE_H_
