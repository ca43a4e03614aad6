#ifndef TRILOBE_MODEL_READ_MODEL_H_
#define TRILOBE_MODEL_READ_MODEL_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/fit_info.h"
#include "trilobe/model/spectral_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// A stored model (docs/file-formats.md).
struct ModelFile {
  FactorModel model;
  std::vector<bool>
      unobserved;  // [num_parameters]: table entries that no data touched; display only
  FitInfo fit;
  // The stored parameters; all if there is no layout. The others are computed from them, also in
  // `model` (ExpandStored).
  std::optional<TableLayout> layout = std::nullopt;
  // The stored model if that is spectral: `model` is its colour, SpectralModel::ToRgb.
  std::optional<SpectralModel> spectral = std::nullopt;
};

// JSON with "format": "trilobe-model", "version": 1, "kind": "isotropic", "lobes", "d" [3], "s"
// [M][3], "D" [M][90], "F" [3][90], "G" [M][90] for the paper's model (docs/file-formats.md).
// - Other sharing: tables nest as [lobe][channel][entry] without the shared levels. "sharing" {"D":
//   {"per_lobe": true, "per_channel": false}, ...} gives it; the default is the paper's.
// - Compact files (with a layout): "d" and rows of "s" may be [1], and a table may be {"size",
//   "nodes": [indices], "values": [as many]}.
// - "unobserved" {"D": [[indices], ...] for each table, ...} lists unobserved entries.
// - Version 3, a spectral model: "wavelengths" [B], "d" [B], "s" [M][B], and F with bands in the
//   place of channels, none of it compact.
// Unknown keys are ignored. All numbers must be finite and >= 0; doubles are read back bit for bit.
// Throws Error with the file and the key.
ModelFile ParseModel(std::string_view text, const std::string& source);
ModelFile ReadModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_READ_MODEL_H_
