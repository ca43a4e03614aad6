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

// A model at all pairs of nodes of a grid, clamped at 0, as a simulated measurement. `source` names
// it in messages. Throws Error if a value overflows.
Measurement ReconstructAtNodes(const FactorModel& model, const std::string& source,
                               const HemisphereGrid& grid);

// A material known at the measured pairs of nodes alone, and interpolated as the measurement is.
NodeBrdf AtNodesOf(const NodeBrdf& measured, const SphericalBrdf& brdf, int num_threads);

// Selects the model that looks most like a measurement at nodes, whose values between nodes are
// unknown. Interpolation is accurate for wide highlights. For narrow ones a good model is closer to
// the material, and a model that looks like the interpolation is bad. An approximately right model
// tells the interpolation's error: its sphere differs from that of its own interpolated node values
// by h, per pixel and channel, in encoded values from 0 to 1. That pixel and channel then has
// weight 1 / (h^2 + (1/255)^2) in the mean of squares.
class NodeJudge {
 public:
  // `about_right`: a fit of the measurement.
  NodeJudge(const NodeBrdf& measured, const SphericalBrdf& about_right,
            const AppearanceOptions& options);

  // Returns a PSNR [dB], the higher the better; NaN where values overflow.
  double operator()(const SphericalBrdf& fitted) const;

 private:
  // The light of a material at the pixels that count, and its encoded values.
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
