#ifndef TRILOBE_FIT_REPORTS_BANDS_REPORT_H_
#define TRILOBE_FIT_REPORTS_BANDS_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "trilobe/fit/fit_bands.h"
#include "trilobe/model/appearance/seen_error.h"

namespace trilobe {

// "31 wavelengths from 400 to 700 nm by 3,495 parameters; E is 0.5 % of a black model's in the
// mean, 0.9 % at 700 nm; ...". `seen`: the colours beside those measured.
std::string Describe(const BandsFit& bands, const std::optional<SeenError>& seen);

// "spectral" in report.json.
nlohmann::ordered_json ToJson(const BandsFit& bands, const std::optional<SeenError>& seen);

}  // namespace trilobe

#endif  // TRILOBE_FIT_REPORTS_BANDS_REPORT_H_
