#ifndef TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_
#define TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_

#include <optional>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// Scattered samples of an isotropic material as a table, for images. Bins hold the mean of their
// samples; others are invalid. The grid is the finest of a few with four times as many samples as
// bins and samples in at least 60 % of the bins. Nothing if samples are too few, as for car paints
// without dark samples, or azimuths matter.
std::optional<BrdfTable> TableOfSamples(const Measurement& scattered);

// The grid with the steps of samples whose azimuths are given, whether these matter or not. Nothing
// unless they are at its nodes, at most one per pair, and at half or more of the pairs up to the
// last theta.
std::optional<HemisphereGrid> GridOf(const Measurement& scattered);

// The data for images of a measurement: its table, or its values at grid nodes. Other scattered
// samples have neither, and are shown as slices.
struct PictureData {
  const BrdfTable* table = nullptr;
  const Measurement* scattered = nullptr;  // set if there is neither
  std::optional<NodeBrdf> nodes = {};
  BrdfFunction formula = nullptr;  // exact BRDF at the nodes, if known

  bool empty() const { return table == nullptr && !nodes; }
};
// Keeps a reference to the measurement. `grid`: of scattered samples.
PictureData PictureDataOf(const Measurement& measurement,
                          const std::optional<HemisphereGrid>& grid);
PictureData PictureDataOf(const Measurement& measurement);  // on GridOf(measurement)

// Throws Error unless there is a table and `fitted` is isotropic.
void CheckIsotropic(const PictureData& measured, const Material& fitted);

// CompareAppearance of the table or nodes. Throws Error if there are neither, and for an
// anisotropic material with a table, which has no azimuths.
AppearanceReport CompareAppearance(const PictureData& measured, const Material& fitted,
                                   const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_
