#ifndef TRILOBE_MODEL_APPEARANCE_NODE_APPEARANCE_H_
#define TRILOBE_MODEL_APPEARANCE_NODE_APPEARANCE_H_

#include <string>
#include <vector>

#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"

namespace trilobe {

// Any model at all pairs of nodes of a grid, clamped at 0, as a measurement would give it. `source`
// names it in messages. Throws Error if a value overflows.
Measurement ReconstructAtNodes(const FactorModel& model, const std::string& source,
                               const HemisphereGrid& grid);

// Which of several models looks most like a measurement at nodes, between which nothing is known.
// Interpolation between them is right where highlights are wide. Where they are narrow a good model
// is nearer to the material than that, and one that looks like the interpolation is a bad one. How
// far it is off can be told by a model that is about right: by the sphere of the model beside that
// of its own values at the nodes, interpolated. So a pixel and channel where these differ by h, of
// encoded values from 0 to 1, weighs 1 / (h^2 + (1/255)^2) in the mean of squares.
class NodeJudge {
 public:
  // `about_right`: a fit of the measurement.
  NodeJudge(const NodeBrdf& measured, const SphericalBrdf& about_right,
            const AppearanceOptions& options);

  // As a PSNR [dB], the higher the better. NaN where values overflow.
  double operator()(const SphericalBrdf& fitted) const;

 private:
  // Of the pixels that count: the light, and what it is encoded to.
  std::vector<Rgb> RadianceOf(const SphericalBrdf& brdf) const;
  std::vector<Rgb> PictureOf(const SphericalBrdf& brdf) const;

  const NodeBrdf& measured_;
  const AppearanceOptions options_;
  const std::vector<Light> lights_;
  double exposure_ = 1;
  std::vector<Rgb> reference_, weights_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_NODE_APPEARANCE_H_
