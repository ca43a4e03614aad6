#ifndef TRILOBE_MODEL_EVALUATE_READ_MODEL_H_
#define TRILOBE_MODEL_EVALUATE_READ_MODEL_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// What helps a person months later to know where a model came from. Empty or 0 where unknown.
struct FitInfo {
  std::string solver;
  std::string init;
  std::string weighting;
  double objective = 0;         // E of the stored model, on the measured samples
  double solver_objective = 0;  // E where the solver ended, before what followed
  double initial_objective = 0;
  std::string stop_reason;
  int iterations = 0;
  double seconds = 0;
  int threads = 0;
  std::string source;
  int valid_samples = 0;
  double max_angle = 0;  // [degrees] up to which theta_i and theta_o the data reach
  std::string program;   // "trilobe 0.1.0"
  std::string date;      // ISO 8601, UTC
  std::string run = {};  // as in the report.json that belongs to it
};

// A model as it is stored (docs/file-formats.md).
struct ModelFile {
  FactorModel model;
  std::vector<bool>
      unobserved;  // [num_parameters]: table entries that no data touched; display only
  FitInfo fit;
  // Which of the model's parameters are stored; without one, all. The others follow from those, in
  // the model too (ExpandStored).
  std::optional<TableLayout> layout = std::nullopt;
};

// JSON with "format": "trilobe-model", "version": 1, "kind": "isotropic", "lobes", "d" [3],
// "s" [M][3], "D" [M][90], "F" [3][90], "G" [M][90] as docs/file-formats.md has it for the paper's
// model. Tables with other sharing nest as the spec says: [lobe][channel][entry], a level left out
// where it is shared; "sharing" {"D": {"per_lobe": true, "per_channel": false}, ...} says so, and
// may be missing for the paper's model. In a compact file, one with a layout, "d" and the rows of
// "s" may be [1], and a table may be {"size", "nodes": [indices], "values": [as many]}.
// "unobserved" {"D": [[indices], ...] a table, ...} lists unobserved bins. Unknown keys are
// ignored. Errors name the file and the key. All numbers must be finite and >= 0. Doubles read back
// bit for bit.
ModelFile ParseModel(std::string_view text, const std::string& source);
ModelFile ReadModel(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_READ_MODEL_H_
