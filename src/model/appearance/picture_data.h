#ifndef TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_
#define TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_

#include <optional>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// Scattered samples of an isotropic material as a table, for pictures: the mean of those in each
// bin of the finest of a few grids that has four times as many samples as bins, and at least one in
// 60 % of the bins; the others are invalid. Nothing where samples are too few, as in car paints
// that lack what was dark, or azimuths matter.
std::optional<BrdfTable> TableOfSamples(const Measurement& scattered);

// The grid at whose nodes anisotropic samples stand, at most one at each pair: that of their
// smallest steps. Nothing unless they do, and at half of the pairs up to the last theta or more.
std::optional<HemisphereGrid> GridOf(const Measurement& scattered);

// What pictures of a measurement are made of: its table, or its values at the nodes of a grid.
// Neither where scattered samples stand on none, which slices are made of.
struct PictureData {
  const BrdfTable* table = nullptr;
  const Measurement* scattered = nullptr;  // if there is neither
  std::optional<NodeBrdf> nodes = {};
  BrdfFunction formula = nullptr;  // what the nodes were measured of, if known

  bool empty() const { return table == nullptr && !nodes; }
};
// Keeps a reference to the measurement.
PictureData PictureDataOf(const Measurement& measurement);

// Throws Error unless there is a table, and an isotropic material to show beside it.
void CheckIsotropic(const PictureData& measured, const Material& fitted);

// CompareAppearance of whichever there is. Throws Error for an anisotropic material beside a table,
// which knows no azimuths, and where there is neither.
AppearanceReport CompareAppearance(const PictureData& measured, const Material& fitted,
                                   const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_PICTURE_DATA_H_
