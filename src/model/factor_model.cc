#include "trilobe/model/factor_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "model/splined_cosine.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

void SetCosineStencils(const ModelSpec& spec, const Cosines& cosines, SampleStencils* stencils) {
  const CatmullRom spline(spec.g_axis.size);
  stencils->G_i = spline.StencilAt(std::acos(cosines.i));
  stencils->G_o = spline.StencilAt(std::acos(cosines.o));
  stencils->inverse_cosines =
      1 / (SplinedCosine(spline, stencils->G_i) * SplinedCosine(spline, stencils->G_o));
}

void SetStretchedStencils(const ModelSpec& spec, const HalfDiffAngles& angles,
                          SampleStencils* stencils) {
  spec.stretches.ForEachThetaH(angles, [&](size_t k, double theta_h) {
    const Stencil D = spec.d_axis.At(theta_h, 0);
    if (k == 0) {
      stencils->D = D;
    } else {
      stencils->more_D.push_back(D);
    }
  });
}

}  // namespace

FactorModel::FactorModel(const ModelSpec& spec) : spec_(spec) {
  CheckSpec(spec);
  int offset = kChannels * (1 + spec.lobes);
  for (const Factor factor : kFactors) {
    offset_[static_cast<int>(factor)] = offset;
    offset += spec.num_tables(factor) * spec.table_size(factor);
  }
  values_.assign(offset, 0.0);
}

std::vector<FactorModel::Part> FactorModel::Parts() const {
  std::vector<Part> parts;
  for (int part = 0; part <= spec_.lobes; ++part) parts.push_back({part * kChannels, kChannels});
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec_.num_tables(factor); ++t) {
      parts.push_back({TableOffset(factor, t), spec_.table_size(factor)});
    }
  }
  return parts;
}

void CheckParameters(const FactorModel& model) {
  const std::span<const double> x = model.parameters();
  const auto bad = std::ranges::find_if(x, [](double number) {
    return !(number >= 0 && number <= std::numeric_limits<double>::max());
  });
  if (bad == x.end()) return;
  std::ostringstream message;
  message << "parameter " << bad - x.begin() << " of the model is " << *bad
          << "; all must be finite and 0 or more";
  throw Error(ErrorKind::kData, message.str())
      .About("parameter " + std::to_string(bad - x.begin()), *bad);
}

void CheckCoverage(std::span<const double> coverage, const FactorModel& model) {
  if (coverage.size() == model.parameters().size()) return;
  throw Error(ErrorKind::kMismatch, "a coverage of " + std::to_string(coverage.size()) +
                                        " entries, but the model has " +
                                        std::to_string(model.parameters().size()) +
                                        "; take that of an objective of its spec")
      .About("coverage", coverage.size());
}

SampleStencils GridStencils(const ModelSpec& spec, const MerlGrid& grid, int bin) {
  CheckIsotropic(spec, "a MERL grid, which knows no azimuths,");
  SampleStencils stencils;
  const HalfDiffAngles angles = grid.Center(bin);  // which checks the bin
  if (spec.stretches.any() || spec.d_axis.size != grid.theta_h) {
    SetStretchedStencils(spec, angles, &stencils);
  } else {
    stencils.D = PointStencil(bin / (grid.theta_d * grid.phi_d));
  }
  stencils.F = spec.f_axis.size == grid.theta_d ? PointStencil(bin / grid.phi_d % grid.theta_d)
                                                : spec.f_axis.At(angles.theta_d, 0);
  SetCosineStencils(spec, ToCosines(angles), &stencils);
  return stencils;
}

SampleStencils ScatteredStencils(const ModelSpec& spec, const HalfDiffAngles& angles) {
  CheckIsotropic(spec, "a pair of directions without azimuths");
  SampleStencils stencils;
  SetStretchedStencils(spec, angles, &stencils);
  stencils.F = spec.f_axis.At(angles.theta_d, 0);
  SetCosineStencils(spec, ToCosines(angles), &stencils);
  return stencils;
}

SampleStencils ScatteredStencils(const ModelSpec& spec, const SphericalAngles& angles) {
  const DirectionPair pair = ToDirections(angles);
  const HalfDiffAngles half_diff = ToHalfDiff(pair);
  if (!spec.anisotropic()) return ScatteredStencils(spec, half_diff);
  const PolarAngles half = HalfVector(pair);
  SampleStencils stencils;
  stencils.D = spec.d_axis.At(half.theta, half.phi);
  stencils.F = spec.f_axis.At(half_diff.theta_d, 0);
  if (spec.g_axis.rule == Axis::Rule::kSpline) {
    SetCosineStencils(spec, ToCosines(half_diff), &stencils);
    return stencils;
  }
  stencils.G_i = spec.g_axis.At(angles.theta_i, angles.phi_i);
  stencils.G_o = spec.g_axis.At(angles.theta_o, angles.phi_o);
  stencils.inverse_cosines = 1 / (std::cos(angles.theta_i) * std::cos(angles.theta_o));
  return stencils;
}

double UnclampedValue(const FactorModel& model, const SampleStencils& stencils, int channel) {
  return ValueOf(model.spec(), model.d()[channel], ModelReads{model, stencils}, channel);
}

Rgb EvaluateAt(const FactorModel& model, const SampleStencils& stencils) {
  const std::span<const double> d = model.d();
  return AtLeastZero(ValueOf(model.spec(), Rgb{d[0], d[1], d[2]}, ModelReads{model, stencils}));
}

Rgb Evaluate(const FactorModel& model, const DirectionPair& directions) {
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return {0, 0, 0};
  const ModelSpec& spec = model.spec();
  return EvaluateAt(model, spec.anisotropic()
                               ? ScatteredStencils(spec, ToSphericalAngles(directions))
                               : ScatteredStencils(spec, ToHalfDiff(directions)));
}

}  // namespace trilobe
