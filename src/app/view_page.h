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
  bool has_measured = false;  // pictures of the measurement, not of the model alone
};

// The page of a model (io/page/page.h), beside `measured` where that is not null. `seen` is how the
// two differ on the sphere; where it is not given it is found out. `path` is what names the
// material where the model does not say of what it is a fit.
ViewedPage ViewPage(const ModelFile& model, const std::string& path, const Measurement* measured,
                    const std::optional<SeenError>& seen, std::span<const IterationRecord> trace,
                    const AppearanceOptions& appearance);

}  // namespace trilobe

#endif  // TRILOBE_APP_VIEW_PAGE_H_
