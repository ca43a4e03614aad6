#include "trilobe/model/model_spec.h"

#include <algorithm>

#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

const char* FactorName(Factor factor) {
  switch (factor) {
    case Factor::kD:
      return "D";
    case Factor::kF:
      return "F";
    case Factor::kG:
      return "G";
  }
  return "";
}

ModelSpec ModelSpec::SharedFactors(int lobes, const MerlGrid& grid) {
  ModelSpec spec;
  spec.lobes = lobes;
  spec.d_axis.size = grid.theta_h;
  spec.f_axis.size = grid.theta_d;
  spec.g_axis.size = grid.theta_d;
  return spec;
}

ModelSpec ModelSpec::Anisotropic(int lobes) {
  ModelSpec spec = SharedFactors(lobes);
  spec.d_axis = spec.g_axis = Axis::Utia();
  return spec;
}

ModelSpec ModelSpec::AnisotropicFor(int lobes, int data_phis, double data_max_theta) {
  ModelSpec spec = SharedFactors(lobes);
  spec.d_axis = Axis::EvenPolar(12, Axis::Steps::kOfRoot, std::clamp(data_phis, 4, 36));
  spec.f_axis.size = 6;
  spec.g_axis = Axis::EvenPolar(6, Axis::Steps::kOfTheta, std::clamp(data_phis / 2, 4, 24));
  constexpr double kRounding = 1e-6;  // [degrees]
  if (RadiansToDegrees(data_max_theta) <= spec.g_axis.theta.back() + kRounding) {
    spec.g_axis = spec.g_axis.ToHorizon();
  }
  return spec;
}

ModelSpec ModelSpec::ForScattered(int num_samples) const {
  constexpr int kPlenty = 200, kBins = 10, kNodes = 9;
  ModelSpec spec = *this;
  if (num_samples >= kPlenty * num_parameters()) return spec;
  spec.f_axis.size = std::min(f_axis.size, kBins);
  spec.g_axis.size = std::min(g_axis.size, kNodes);
  return spec;
}

ModelSpec ModelSpec::IndependentG(const MerlGrid& grid) {
  ModelSpec spec = SharedFactors(1, grid);
  spec.D = spec.F = spec.G = {.per_lobe = true, .per_channel = true};
  return spec;
}

int ModelSpec::num_tables(Factor factor) const {
  const auto [per_lobe, per_channel] = sharing(factor);
  return (per_lobe ? lobes : std::min(lobes, 1)) * (per_channel ? kChannels : 1);
}

int ModelSpec::num_parameters() const {
  int count = kChannels + lobes * kChannels;
  for (const Factor factor : kFactors) count += num_tables(factor) * table_size(factor);
  return count;
}

void CheckSameSpec(const ModelSpec& is, const ModelSpec& wanted) {
  if (is == wanted) return;
  const auto text = [](const ModelSpec& spec) {
    std::string tables;
    for (const Factor factor : kFactors) {
      tables += ", " + std::to_string(spec.num_tables(factor)) + " tables " + FactorName(factor) +
                " of " + std::to_string(spec.table_size(factor));
    }
    return std::to_string(spec.lobes) + " lobes, stretched in " +
           std::to_string(spec.stretches.any() ? spec.stretches.distinct().size() : 0) + " ways" +
           tables;
  };
  throw Error(ErrorKind::kMismatch, "a model of another spec: it has " + text(is) +
                                        "; wanted are " + text(wanted) + ", shared alike")
      .About("spec");
}

void CheckSpec(const ModelSpec& spec) {
  if (spec.lobes < 0 || spec.lobes > kMaxLobes) {
    throw Error(ErrorKind::kRange, "lobes is " + std::to_string(spec.lobes) +
                                       "; it must be from 0 to " + std::to_string(kMaxLobes))
        .About("lobes", spec.lobes);
  }
  for (const Factor factor : kFactors) CheckAxis(spec.axis(factor), FactorName(factor));
  if (spec.f_axis.rule != Axis::Rule::kTheta) {
    throw Error(ErrorKind::kRange, "F tables must be over bins of theta_d").About("f_axis");
  }
  for (const Axis::Rule rule : {spec.d_axis.rule, spec.g_axis.rule}) {
    if (rule == Axis::Rule::kTheta) {
      throw Error(ErrorKind::kRange, "only F tables may be over bins of theta_d")
          .About("d_axis, g_axis", "theta_d");
    }
  }
  if (spec.d_axis.rule == Axis::Rule::kSpline || spec.g_axis.rule == Axis::Rule::kRootTheta) {
    throw Error(ErrorKind::kRange,
                "a D table cannot be a spline, nor a G table one over the root of theta_h")
        .About("d_axis, g_axis");
  }
  spec.stretches.Check(spec.lobes);
  if (spec.stretches.any()) CheckIsotropic(spec, "a stretch of highlights");
  if (spec.stretches.several() && !spec.D.per_lobe) {
    throw Error(ErrorKind::kConflict, "lobes that share D must be stretched alike")
        .About("stretches");
  }
}

void CheckIsotropic(const ModelSpec& spec, const char* wants) {
  if (!spec.anisotropic()) return;
  throw Error(ErrorKind::kUnsupported,
              std::string(wants) + " wants an isotropic model, and this one is anisotropic")
      .About("anisotropic", wants);
}

}  // namespace trilobe
