#include <string>
#include <string_view>

#include "trilobe/core/system/parallel.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/model/evaluate/read_terms.h"

namespace trilobe {
namespace {

// A model of terms (docs/file-formats.md), as a table of its values at the bins of MERL's grid.
Measurement ParseTermsAsTable(std::string_view text, const std::string& source,
                              const SourceOptions& options) {
  const TermFile file = ParseTerms(text, source);
  const MerlGrid grid;
  Measurement measurement{.source = source, .kind = "table of a model of terms"};
  BrdfTable table = MakeInvalidTable(source, grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  const auto rgb = RgbOf(file);
  measurement.formula = [rgb](const DirectionPair& pair) -> Rgb {
    if (!(pair.wi[2] > 0 && pair.wo[2] > 0)) return {0, 0, 0};
    return rgb(ToHalfDiff(pair));
  };
  ParallelForShort(grid.size(), options.num_threads, [&](int bin) {
    if (!above[bin]) return;
    const Rgb rho = rgb(grid.Center(bin));
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, rho[c]);
  });
  measurement.table = std::move(table);
  return measurement;
}

bool LooksLikeTerms(std::string_view text) {
  return text.find("\"trilobe-terms\"") != std::string_view::npos;
}

}  // namespace

MeasurementFormat TermsFormat() {
  return {.name = "terms",
          .description = "a model of terms (.json of `trilobe forms`)",
          .ending = ".json",
          .is_text = true,
          .is_json = true,
          .recognise = LooksLikeTerms,
          .read = ParseTermsAsTable};
}

}  // namespace trilobe
