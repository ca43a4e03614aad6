#ifndef TRILOBE_APP_VIEW_PAGE_H_
#define TRILOBE_APP_VIEW_PAGE_H_

#include <optional>
#include <span>
#include <string>

#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

struct ViewedPage {
  std::string text;
  bool has_measured = false;  // the page also shows the measurement
};

// The page of a model (io/page/page.h), compared with `measured` unless that is null. `seen` is
// their difference on the sphere; computed if not given. `path` names the material if the model
// does not name its source.
ViewedPage ViewPage(const ModelFile& model, const std::string& path, const Measurement* measured,
                    const std::optional<SeenError>& seen, std::span<const IterationRecord> trace,
                    const AppearanceOptions& appearance);

}  // namespace trilobe

#endif  // TRILOBE_APP_VIEW_PAGE_H_
