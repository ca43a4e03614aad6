#ifndef TRILOBE_MODEL_FACTOR_MODEL_H_
#define TRILOBE_MODEL_FACTOR_MODEL_H_

#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/math/stencil.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/value_of.h"

namespace trilobe {

// The parameters of a model, all >= 0, in one vector
//   [ d (3) | s (lobes x 3) | D tables | F tables | G tables ]
// whose parts the accessors view. A value type: copying it copies the parameters.
class FactorModel {
 public:
  FactorModel() : FactorModel(ModelSpec{.lobes = 0}) {}
  // All parameters zero. Throws Error if the spec is out of range.
  explicit FactorModel(const ModelSpec& spec);

  const ModelSpec& spec() const { return spec_; }

  // All parameters. [spec().num_parameters()]
  std::span<double> parameters() { return values_; }
  std::span<const double> parameters() const { return values_; }

  // Diffuse albedo / pi. [kChannels]
  std::span<double> d() { return {values_.data(), kChannels}; }
  std::span<const double> d() const { return {values_.data(), kChannels}; }

  // Specular weights of one lobe. [kChannels]
  std::span<double> s(int lobe) { return {values_.data() + kChannels * (1 + lobe), kChannels}; }
  std::span<const double> s(int lobe) const {
    return {values_.data() + kChannels * (1 + lobe), kChannels};
  }

  // One table by its number. [spec().table_size(factor)]
  std::span<double> table(Factor factor, int index) {
    return {values_.data() + TableOffset(factor, index),
            static_cast<size_t>(spec_.table_size(factor))};
  }
  std::span<const double> table(Factor factor, int index) const {
    return {values_.data() + TableOffset(factor, index),
            static_cast<size_t>(spec_.table_size(factor))};
  }

  // The table that serves a lobe and channel. [spec().table_size(factor)]
  std::span<const double> D(int lobe, int channel) const {
    return table(Factor::kD, spec_.table(Factor::kD, lobe, channel));
  }
  std::span<const double> F(int lobe, int channel) const {
    return table(Factor::kF, spec_.table(Factor::kF, lobe, channel));
  }
  std::span<const double> G(int lobe, int channel) const {
    return table(Factor::kG, spec_.table(Factor::kG, lobe, channel));
  }

  // Parameters of one kind in parameters(): d, then s of each lobe, then each table.
  struct Part {
    int begin, size;
  };
  std::vector<Part> Parts() const;

  // Where a table starts in parameters().
  int TableOffset(Factor factor, int index) const {
    return offset_[static_cast<int>(factor)] + index * spec_.table_size(factor);
  }

 private:
  ModelSpec spec_;
  int offset_[3] = {0, 0, 0};
  std::vector<double> values_;
};

// Throws Error, with the place of the first that is not, unless all parameters are finite and >= 0.
void CheckParameters(const FactorModel& model);

// Throws Error unless there are as many of these as the model has parameters.
void CheckCoverage(std::span<const double> coverage, const FactorModel& model);

// How one direction pair reads the tables: the model's value is
//   d + sum_m s (D . its stretch's stencil) (F . stencil) (G . theta_i) (G . theta_o) *
//   inverse_cosines.
struct SampleStencils {
  Stencil D, F, G_i, G_o;
  std::vector<Stencil> more_D =
      {};  // where lobes are stretched differently: of the second stretch on
  // 1 / (cos theta_i cos theta_o), splined as G is where that is a spline (docs/model.md).
  double inverse_cosines = 0;

  // By the number of the stretch among the distinct ones.
  const Stencil& DOf(int stretch) const { return stretch == 0 ? D : more_D[stretch - 1]; }
};

// How ValueOf reads a model's tables at a sample; both outlive this.
struct ModelReads {
  const FactorModel& model;
  const SampleStencils& at;

  double s(int m, int c) const { return model.s(m)[c]; }
  double D(int m, int c) const { return at.DOf(model.spec().stretches.index(m))(model.D(m, c)); }
  double F(int m, int c) const { return at.F(model.F(m, c)); }
  Shadowing G(int m, int c) const {
    const std::span<const double> G = model.G(m, c);
    return {at.G_i(G), at.G_o(G), at.inverse_cosines};
  }
};

// Stencils at the centre of bin (h, d, p): D and F at their own bins (docs/model.md), a stretched
// D, and tables of other bins than the grid's, between two. Throws Error for an anisotropic spec,
// and where the grid has no such bin.
SampleStencils GridStencils(const ModelSpec& spec, const MerlGrid& grid, int bin);

// Stencils at any directions, as the axes have it (Axis::At). Angles without azimuths do for
// isotropic specs only; Error for others.
SampleStencils ScatteredStencils(const ModelSpec& spec, const HalfDiffAngles& angles);
SampleStencils ScatteredStencils(const ModelSpec& spec, const SphericalAngles& angles);

// The sum above, of one channel [1/sr]: what E compares with the measurement. Where the spline
// through G undershoots, it may be negative.
double UnclampedValue(const FactorModel& model, const SampleStencils& stencils, int channel);

// BRDF [1/sr]: the same, but 0 where that is negative.
Rgb EvaluateAt(const FactorModel& model, const SampleStencils& stencils);

// BRDF [1/sr] for any pair of directions, x being where an anisotropic material's azimuths begin; 0
// where either is below the surface. Throws Error where one is not a number.
Rgb Evaluate(const FactorModel& model, const DirectionPair& directions);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_FACTOR_MODEL_H_
