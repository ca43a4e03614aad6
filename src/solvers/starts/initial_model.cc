#include "trilobe/solvers/starts/initial_model.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "core/base/names.h"
#include "core/base/quantile.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "solvers/awls/awls.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Starting points look at about this many samples: enough for magnitudes and profiles.
constexpr int kSamplesLookedAt = 1 << 16;

std::vector<int> LookedAt(const Objective& objective) {
  const int size = objective.num_samples(), stride = std::max(1, size / kSamplesLookedAt);
  std::vector<int> numbers;
  // An odd stride visits all phi_d of a grid.
  for (int j = 0; j < size; j += stride | 1) numbers.push_back(j);
  return numbers;
}

// A thin, even selection of the samples, with their stencils.
std::vector<WeightedSample> Selection(const Objective& objective) {
  std::vector<WeightedSample> selection;
  for (const int j : LookedAt(objective)) selection.push_back(objective.Sample(j));
  return selection;
}

// The value that a share `fraction` of the samples stays below, a channel.
Rgb QuantileOf(const std::vector<WeightedSample>& samples, double fraction) {
  Rgb result{};
  std::vector<double> values(samples.size());
  for (int c = 0; c < kChannels; ++c) {
    std::ranges::transform(samples, values.begin(),
                           [c](const WeightedSample& sample) { return sample.rho[c]; });
    result[c] = Quantile(&values, fraction);
  }
  return result;
}

// MeanReflectance, a channel, of the samples that are looked at.
Rgb MeanColor(const Objective& objective) {
  const BrdfSamples samples = objective.Selected(LookedAt(objective));
  double light = 0;
  Rgb mean{};
  for (int j = 0; j < samples.size(); ++j) {
    const Cosines cosines = samples.CosinesOf(j);
    const double through = samples.SolidAngle(j) * cosines.i * cosines.o;
    light += through;
    for (int c = 0; c < kChannels; ++c) mean[c] += through * samples.rho[j][c];
  }
  for (double& channel : mean) channel = light > 0 ? channel / light : 0;
  return mean;
}

using Table = std::vector<double>;

void SetTable(Factor factor, int lobe, const Table& values, FactorModel* model) {
  for (int c = 0; c < kChannels; ++c) {
    std::ranges::copy(values, model->table(factor, model->spec().table(factor, lobe, c)).begin());
  }
}

// Each lobe alone, and nothing but it, would fit the measurement best with the least-squares
// weight s = sum w rho* p / sum w p^2, p its profile; it gets its 1/lobes share of that.
void SetSpecularWeights(const std::vector<WeightedSample>& samples, FactorModel* model) {
  const int lobes = model->spec().lobes;
  FactorModel unit = *model;
  std::ranges::fill(unit.d(), 0.0);
  for (int m = 0; m < lobes; ++m) {
    for (int other = 0; other < lobes; ++other) {
      std::ranges::fill(unit.s(other), other == m ? 1.0 : 0.0);
    }
    for (int c = 0; c < kChannels; ++c) {
      double numerator = 0, denominator = 0;
      for (const WeightedSample& sample : samples) {
        const double profile = UnclampedValue(unit, sample.stencils, c);
        numerator += sample.weight[c] * std::max(0.0, sample.rho[c] - model->d()[c]) * profile;
        denominator += sample.weight[c] * profile * profile;
      }
      model->s(m)[c] = denominator > 0 ? numerator / denominator / lobes : 0;
    }
  }
}

Table GgxDistribution(const Axis& axis, double alpha) {
  Table D(axis.size);
  for (int h = 0; h < axis.size; ++h) {
    const double cos_h = std::cos(axis.Theta(h));
    const double t = (alpha * alpha - 1) * cos_h * cos_h + 1;
    D[h] = alpha * alpha / (kPi * t * t);
  }
  return D;
}

// Microfacet normals of an entry of D: a ring of them where it is a bin of theta_h.
struct Facets {
  double theta;             // [rad]
  std::vector<double> phi;  // [rad]
  double solid_angle;       // of each
};

Facets FacetsOf(const Axis& axis, int entry) {
  const double theta = axis.Theta(entry);
  if (axis.polar()) return {theta, {axis.Phi(entry)}, axis.CellOf(entry).SolidAngle()};
  constexpr int kPhi = 64;
  const MerlGrid grid{.theta_h = axis.size};
  Facets ring{theta, std::vector<double>(kPhi),
              std::sin(theta) * (grid.ThetaH(entry + 1) - grid.ThetaH(entry)) * (2 * kPi / kPhi)};
  for (int p = 0; p < kPhi; ++p) ring.phi[p] = (p + 0.5) * (2 * kPi / kPhi);
  return ring;
}

// Smith's masking of a tabulated distribution (Ashikhmin et al. 2000; Heitz 2014):
// G1(w) = cos theta * integral D cos theta_h d omega_h / integral D max(0, w.h) d omega_h.
Table SmithShadowing(const ModelSpec& spec, const Table& D) {
  const double normalization = ProjectedIntegral(spec.d_axis, D);
  Table G(spec.g_axis.size, 1.0);
  if (!(normalization > 0)) return G;
  std::vector<Facets> facets;
  for (int h = 0; h < spec.d_axis.size; ++h) facets.push_back(FacetsOf(spec.d_axis, h));
  for (int k = 0; k < spec.g_axis.size; ++k) {
    const double theta = spec.g_axis.Theta(k), phi_w = spec.g_axis.Phi(k);
    double area = 0;
    for (int h = 0; h < spec.d_axis.size; ++h) {
      double sum = 0;
      for (const double phi : facets[h].phi) {
        sum += std::max(0.0, std::sin(theta) * std::sin(facets[h].theta) * std::cos(phi - phi_w) +
                                 std::cos(theta) * std::cos(facets[h].theta));
      }
      area += D[h] * facets[h].solid_angle * sum;
    }
    if (area > 0) G[k] = std::min(1.0, std::cos(theta) * normalization / area);
  }
  return G;
}

// Schlick's curve of a half-reflective mirror: a mild start for both dielectrics and metals.
Table SchlickFresnel(int bins) {
  Table F(bins);
  for (int d = 0; d < bins; ++d) {
    const double theta_d = (d + 0.5) / bins * (kPi / 2);
    F[d] = 0.5 + 0.5 * std::pow(1 - std::cos(theta_d), 5);
  }
  return F;
}

// A model whose lobes have these distributions, Smith's G and Schlick's F; d from the data; s is 0.
FactorModel WithoutWeights(const std::vector<WeightedSample>& samples, const ModelSpec& spec,
                           const std::vector<Table>& D) {
  FactorModel model(spec);
  std::ranges::copy(QuantileOf(samples, 0.1), model.d().begin());
  for (int m = 0; m < spec.lobes; ++m) {
    SetTable(Factor::kD, m, D[m], &model);
    SetTable(Factor::kF, m, SchlickFresnel(spec.f_axis.size), &model);
    SetTable(Factor::kG, m, SmithShadowing(spec, D[m]), &model);
  }
  return model;
}

// The same with s from the data.
FactorModel FromDistributions(const Objective& objective, const std::vector<Table>& D) {
  const std::vector<WeightedSample> samples = Selection(objective);
  FactorModel model = WithoutWeights(samples, objective.spec(), D);
  SetSpecularWeights(samples, &model);
  return model;
}

// GGX, a lobe, with roughnesses spread evenly in the logarithm from `narrow` to `wide`.
std::vector<Table> SpreadDistributions(const ModelSpec& spec, double narrow, double wide) {
  std::vector<Table> D;
  for (int m = 0; m < spec.lobes; ++m) {
    const double t = spec.lobes == 1 ? 0.5 : m / (spec.lobes - 1.0);
    D.push_back(GgxDistribution(spec.d_axis, narrow * std::pow(wide / narrow, t)));
  }
  return D;
}

FactorModel ConstantModel(const Objective& objective, uint64_t /*seed*/) {
  FactorModel model(objective.spec());
  const std::vector<WeightedSample> samples = Selection(objective);
  std::ranges::copy(QuantileOf(samples, 0.1), model.d().begin());
  for (int m = 0; m < objective.spec().lobes; ++m) {
    for (const Factor factor : kFactors) {
      SetTable(factor, m, Table(objective.spec().table_size(factor), 1.0), &model);
    }
  }
  SetSpecularWeights(samples, &model);
  return model;
}

FactorModel AnalyticModel(const Objective& objective, uint64_t /*seed*/) {
  return FromDistributions(objective, SpreadDistributions(objective.spec(), 0.04, 0.5));
}

int Nearest(const Stencil& stencil) {
  int k = 0;
  for (int other = 1; other < stencil.size; ++other) {
    if (stencil.weight[other] > stencil.weight[k]) k = other;
  }
  return stencil.index[k];
}

// Mean over theta_d <= 45 degrees and the channels of (rho* - d) cos theta_i cos theta_o: what is
// left of a lobe there is its D, up to a factor. [d_axis.size]
Table HighlightProfile(const Objective& objective) {
  const std::vector<WeightedSample> samples = Selection(objective);
  const Rgb d = QuantileOf(samples, 0.1);
  const Axis& axis = objective.spec().d_axis;
  const int bins = axis.size, f_limit = objective.spec().f_axis.size / 2;
  Table sum(bins, 0.0), count(bins, 0.0);
  for (const WeightedSample& sample : samples) {
    if (sample.stencils.F.index[0] >= f_limit) continue;
    const int h = axis.polar() ? Nearest(sample.stencils.D) : sample.stencils.D.index[0];
    for (int c = 0; c < kChannels; ++c) {
      sum[h] += std::max(0.0, sample.rho[c] - d[c]) / sample.stencils.inverse_cosines;
      count[h] += 1;
    }
  }
  for (int h = bins - 1; h >= 0; --h) {  // an empty bin repeats its outer neighbour
    const int outer = h + axis.phi_nodes;
    sum[h] = count[h] > 0 ? sum[h] / count[h] : outer < bins ? sum[outer] : 0;
  }
  return sum;
}

FactorModel HighlightModel(const Objective& objective, uint64_t seed) {
  const int lobes = objective.spec().lobes;
  Table profile = HighlightProfile(objective);
  const double peak = std::ranges::max(profile);
  if (!(peak > 0)) return AnalyticModel(objective, seed);
  // Powers 2, 1, 1/2 of the profile: sharper than it, as it is, wider.
  std::vector<Table> D(lobes, Table(profile.size()));
  for (int m = 0; m < lobes; ++m) {
    const double power = std::exp2((lobes - 1) / 2.0 - m);
    for (size_t h = 0; h < profile.size(); ++h) {
      D[m][h] = std::pow(std::max(profile[h] / peak, 1e-6), power);
    }
  }
  return FromDistributions(objective, D);
}

// Lobes of the shape of the measured highlight: anisotropic GGX (Walter et al. 2007, Heitz 2014)
// whose slopes have the second moments of the profile's, and twice and half their width.
FactorModel MomentsModel(const Objective& objective, uint64_t seed) {
  const ModelSpec& spec = objective.spec();
  const Axis& axis = spec.d_axis;
  const Table profile = HighlightProfile(objective);
  // Second moments of slopes (tan theta cos phi, tan theta sin phi), weighted by the area of
  // facets. A GGX distribution has no second moments: with its tail cut off at a slope of 1 they
  // are near alpha^2 / 2 for the roughnesses of highlights that nodes resolve.
  double total = 0, xx = 0, xy = 0, yy = 0;
  for (int k = 0; k < axis.size; ++k) {
    const double theta = axis.Theta(k), slope = std::tan(theta);
    if (slope > 1) continue;
    const Facets facets = FacetsOf(axis, k);
    const double weight =
        profile[k] * facets.solid_angle * static_cast<double>(facets.phi.size()) * std::cos(theta);
    const double x = slope * std::cos(axis.Phi(k)), y = slope * std::sin(axis.Phi(k));
    total += weight;
    if (axis.polar()) {
      xx += weight * x * x;
      xy += weight * x * y;
      yy += weight * y * y;
    } else {
      xx += weight * slope * slope / 2;
      yy += weight * slope * slope / 2;
    }
  }
  if (!(total > 0)) return AnalyticModel(objective, seed);
  // Principal axes of the moments.
  const double angle = std::atan2(2 * xy, xx - yy) / 2, c = std::cos(angle), s = std::sin(angle);
  const auto alpha_of = [&](double moment) {
    return std::clamp(std::sqrt(2 * std::max(moment, 0.0) / total), 0.02, 1.0);
  };
  const double along = alpha_of(c * c * xx + 2 * c * s * xy + s * s * yy);
  const double across = alpha_of(s * s * xx - 2 * c * s * xy + c * c * yy);
  std::vector<Table> D(spec.lobes, Table(axis.size));
  for (int m = 0; m < spec.lobes; ++m) {
    const double width = std::exp2(m - (spec.lobes - 1) / 2.0);
    const double a = std::min(width * along, 1.0), b = std::min(width * across, 1.0);
    for (int k = 0; k < axis.size; ++k) {
      const double theta = axis.Theta(k), phi = axis.Phi(k) - angle;
      const double cos2 = std::cos(theta) * std::cos(theta);
      // If phi is not known, the slope is averaged over it.
      const double u2 = axis.polar()
                            ? std::pow(std::cos(phi) / a, 2) + std::pow(std::sin(phi) / b, 2)
                            : (1 / (a * a) + 1 / (b * b)) / 2;
      const double t = cos2 + (1 - cos2) * u2;
      D[m][k] = 1 / (kPi * a * b * t * t);
    }
  }
  return FromDistributions(objective, D);
}

// A parameter that is 0 could not move by a factor: it becomes a little of the mean of its kind, or
// of what that was at the start.
void LiftZeros(const FactorModel& start, FactorModel* model) {
  constexpr double kLittle = 1e-3;
  for (const auto [begin, size] : model->Parts()) {
    const auto part = model->parameters().subspan(begin, size);
    const auto before = start.parameters().subspan(begin, size);
    double mean = 0, mean_before = 0;
    for (int k = 0; k < size; ++k) {
      mean += part[k] / size;
      mean_before += before[k] / size;
    }
    const double least = kLittle * (mean > 0 ? mean : mean_before);
    for (double& x : part) x = std::max(x, least);
  }
}

// The isotropic model of the same samples, fitted a little, and freed: every azimuth begins alike.
FactorModel FreedModel(const Objective& objective, uint64_t seed) {
  constexpr int kSweeps = 10, kStride = 4;
  const ModelSpec& spec = objective.spec();
  ModelSpec round = spec;
  if (spec.anisotropic()) {
    const ModelSpec isotropic;
    round.d_axis = isotropic.d_axis;
    round.g_axis = isotropic.g_axis;
  }
  const Objective thinned(Thinned(objective.samples(), kStride), round, objective.weighting(), 1);
  const FactorModel start = HighlightModel(thinned, seed);
  FactorModel model = start;
  AwlsEntry().make()->Solve(thinned, {.max_iterations = kSweeps, .diagnose = false}, &model);
  Canonicalize(thinned, &model);  // which gives unobserved entries a value
  model = WithAxes(model, spec);
  LiftZeros(WithAxes(start, spec), &model);
  return model;
}

// Uniform in [0, 1). The standard leaves std::uniform_real_distribution's method open; this is the
// same everywhere.
double Uniform(std::mt19937_64* engine) { return static_cast<double>((*engine)() >> 11) * 0x1p-53; }

// Model with log-uniform roughnesses.
FactorModel RoughnessModel(const Objective& objective, std::mt19937_64* engine) {
  const ModelSpec& spec = objective.spec();
  std::vector<Table> D;
  for (int m = 0; m < spec.lobes; ++m) {
    D.push_back(GgxDistribution(spec.d_axis, 0.02 * std::pow(50.0, Uniform(engine))));
  }
  return FromDistributions(objective, D);
}

FactorModel RoughnessModel(const Objective& objective, uint64_t seed) {
  std::mt19937_64 engine(seed);
  return RoughnessModel(objective, &engine);
}

// RoughnessModel, and every parameter times a log-uniform factor in [1/2, 2].
FactorModel RandomModel(const Objective& objective, uint64_t seed) {
  std::mt19937_64 engine(seed);
  FactorModel model = RoughnessModel(objective, &engine);
  for (double& x : model.parameters()) x *= std::exp2(2 * Uniform(&engine) - 1);
  return model;
}

}  // namespace

FactorModel SpreadModel(const Objective& objective, double narrow, double wide) {
  constexpr double kReflected = 1.2;  // with F = 1 and G = 1; some half with these as they are
  const ModelSpec& spec = objective.spec();
  FactorModel model =
      WithoutWeights(Selection(objective), spec, SpreadDistributions(spec, narrow, wide));
  const Rgb mean = MeanColor(objective);
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) model.s(m)[c] = kReflected * kPi / 4 * mean[c];
  }
  return model;
}

const std::vector<InitialModel>& InitialModels() {
  static const std::vector<InitialModel> models = {
      {"analytic", "GGX lobes, roughnesses spread from 0.04 to 0.5, Smith G, Schlick F",
       AnalyticModel},
      {"highlight", "D from the measured highlight, averaged over theta_d <= 45 degrees",
       HighlightModel},
      {"moments", "anisotropic GGX lobes with the second moments of the measured highlight",
       MomentsModel},
      {"freed", "the isotropic model, fitted a little to a part of the data, and freed",
       FreedModel},
      {"constant", "all tables 1", ConstantModel},
      {"roughness", "as analytic, with random roughnesses (--seed)", RoughnessModel},
      {"random", "GGX lobes of random roughness, every number times a random factor (--seed)",
       RandomModel},
  };
  return models;
}

const InitialModel& FindInitialModel(std::string_view name) {
  return FindNamed("init", name, InitialModels());
}

}  // namespace trilobe
