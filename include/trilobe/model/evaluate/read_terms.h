#ifndef TRILOBE_MODEL_EVALUATE_READ_TERMS_H_
#define TRILOBE_MODEL_EVALUATE_READ_TERMS_H_

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/evaluate/fit_info.h"
#include "trilobe/model/terms/term_model.h"

namespace trilobe {

// A stored model of terms (docs/file-formats.md): JSON with "format": "trilobe-terms".
struct TermFile {
  TermModel model;
  std::vector<double> wavelengths = {};  // [nm], of the channels; empty: they are R, G and B
  FitInfo fit = {};
};

// Throws Error with the file and the key.
TermFile ParseTerms(std::string_view text, const std::string& source);
TermFile ReadTerms(const std::string& path);

// Its BRDF [1/sr] in RGB, of directions above the surface: of wavelengths, the colour, of which
// channels below 0 are 0.
std::function<Rgb(const HalfDiffAngles&)> RgbOf(const TermFile& file);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_READ_TERMS_H_
