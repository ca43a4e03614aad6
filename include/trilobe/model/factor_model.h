#ifndef TRILOBE_MODEL_FACTOR_MODEL_H_
#define TRILOBE_MODEL_FACTOR_MODEL_H_

#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/value_of.h"

namespace trilobe {

// The parameters of a model, all >= 0, in one vector
//   [ d (3) | s (lobes x 3) | D tables | F tables | G tables ]
// with views of its parts. A value type: copies are independent.
//
//   FactorModel model(ModelSpec::SharedFactors(3));  // 822 zeros
//   std::ranges::fill(model.d(), 0.1);
//   model.table(Factor::kF, 0)[89] = 1;              // F of red, last bin of theta_d
//   const Rgb rho = Evaluate(model, ToDirections(SphericalAngles{.theta_i = 0.5}));
class FactorModel {
 public:
  FactorModel() : FactorModel(ModelSpec{.lobes = 0}) {}
  // Sets all parameters to 0. Throws Error for an invalid spec (CheckSpec).
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

  // A table by its index. [spec().table_size(factor)]
  std::span<double> table(Factor factor, int index) {
    return {values_.data() + TableOffset(factor, index),
            static_cast<size_t>(spec_.table_size(factor))};
  }
  std::span<const double> table(Factor factor, int index) const {
    return {values_.data() + TableOffset(factor, index),
            static_cast<size_t>(spec_.table_size(factor))};
  }

  // The table of a lobe and channel. [spec().table_size(factor)]
  std::span<const double> D(int lobe, int channel) const {
    return table(Factor::kD, spec_.table(Factor::kD, lobe, channel));
  }
  std::span<const double> F(int lobe, int channel) const {
    return table(Factor::kF, spec_.table(Factor::kF, lobe, channel));
  }
  std::span<const double> G(int lobe, int channel) const {
    return table(Factor::kG, spec_.table(Factor::kG, lobe, channel));
  }

  // The parts of parameters(): d, s of each lobe, and each table, in order.
  struct Part {
    int begin, size;
  };
  std::vector<Part> Parts() const;

  // Offset of a table in parameters().
  int TableOffset(Factor factor, int index) const {
    return offset_[static_cast<int>(factor)] + index * spec_.table_size(factor);
  }

 private:
  ModelSpec spec_;
  int offset_[3] = {0, 0, 0};
  std::vector<double> values_;
};

// Throws Error, naming the first bad parameter, unless all are finite and >= 0.
void CheckParameters(const FactorModel& model);

// Throws Error unless `coverage` has a value for each parameter of the model.
void CheckCoverage(std::span<const double> coverage, const FactorModel& model);

// The table lookups of one direction pair. The model's value is
//   d + sum_m s (D . its stretch's stencil) (F . stencil) (G . G_i) (G . G_o) * inverse_cosines.
struct SampleStencils {
  Stencil D, F, G_i, G_o;
  std::vector<Stencil> more_D =
      {};  // where lobes are stretched differently: of the second stretch on
  // 1 / (cos theta_i cos theta_o); the cosines are splined if G is a spline (docs/model.md).
  double inverse_cosines = 0;

  // The stencil of D for one of the distinct stretches.
  const Stencil& DOf(int stretch) const { return stretch == 0 ? D : more_D[stretch - 1]; }
};

// Table reads of a model at a sample, for ValueOf. Keeps references to both.
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

// Stencils at the centre of bin (h, d, p). D and F read their own bins (docs/model.md), but are
// interpolated if D is stretched or the tables' bins differ from the grid's. Throws Error for an
// anisotropic spec and a bin outside the grid.
SampleStencils GridStencils(const ModelSpec& spec, const MerlGrid& grid, int bin);

// Stencils at any directions, by Axis::At. HalfDiffAngles lack azimuths; Error for anisotropic
// specs.
SampleStencils ScatteredStencils(const ModelSpec& spec, const HalfDiffAngles& angles);
SampleStencils ScatteredStencils(const ModelSpec& spec, const SphericalAngles& angles);

// The sum above for one channel [1/sr], which E compares with the measurement. It may be negative
// where the spline of G undershoots.
double UnclampedValue(const FactorModel& model, const SampleStencils& stencils, int channel);

// BRDF [1/sr]: the same, clamped at 0.
Rgb EvaluateAt(const FactorModel& model, const SampleStencils& stencils);

// BRDF [1/sr] for a pair of directions; x is the origin of azimuths. 0 if either is below the
// surface. Throws Error for NaN.
Rgb Evaluate(const FactorModel& model, const DirectionPair& directions);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_FACTOR_MODEL_H_
