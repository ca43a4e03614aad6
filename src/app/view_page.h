#ifndef TRILOBE_APP_VIEW_PAGE_H_
#define TRILOBE_APP_VIEW_PAGE_H_

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/appearance/verdict.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

struct ViewedPage {
  std::string text;
  bool has_measured = false;  // the page also shows the measurement
};

// Known differences of a model and its measurement.
struct Compared {
  std::optional<SeenError> seen = {};  // their difference; else it is computed, on the sphere
  std::optional<Basis> basis = {};     // of a verdict; else of the samples of the measurement
  std::optional<Reach> reach = {};     // of the model where nothing was measured
  std::vector<std::string> advice = {};
  std::string wavelengths = {};  // of the spectral fit that the model is the colours of
};

// The page of a model (io/pictures/page.h), compared with `measured` unless that is null. `path`
// names the material if the model does not name its source.
ViewedPage ViewPage(const ModelFile& model, const std::string& path, const Measurement* measured,
                    const Compared& compared, std::span<const IterationRecord> trace,
                    const AppearanceOptions& appearance);

}  // namespace trilobe

#endif  // TRILOBE_APP_VIEW_PAGE_H_
