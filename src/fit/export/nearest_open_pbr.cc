#include "fit/export/nearest_open_pbr.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "fit/export/gltf_material.h"
#include "model/appearance/color.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

// --- Parameters ----------------------------------------------------------------------------------

struct Bound {
  double least, most;
};
// In the order of Pack.
constexpr Bound kBounds[] = {{0, 1}, {0, 1},    {0, 1},      {0, 1}, {0, 1},    {0, 1},   {0, 1},
                             {0, 1}, {0.03, 1}, {1.05, 2.5}, {0, 1}, {0.03, 1}, {0, 0.95}};
constexpr int kMost = std::size(kBounds);

// Numbers of parameters that are free; the others keep what they start from.
using Free = std::vector<int>;

std::array<double, kMost> Pack(const OpenPbr& m) {
  return {m.base_color[0],
          m.base_color[1],
          m.base_color[2],
          m.base_diffuse_roughness,
          m.base_metalness,
          m.specular_color[0],
          m.specular_color[1],
          m.specular_color[2],
          m.specular_roughness,
          m.specular_ior,
          m.coat_weight,
          m.coat_roughness,
          m.specular_roughness_anisotropy};
}

OpenPbr Unpack(const double* of_free, const Free& free, const OpenPbr& start) {
  std::array<double, kMost> x = Pack(start);
  for (size_t k = 0; k < free.size(); ++k) x[free[k]] = of_free[k];
  OpenPbr m = start;
  m.base_color = {x[0], x[1], x[2]};
  m.base_diffuse_roughness = x[3];
  m.base_metalness = x[4];
  m.specular_color = {x[5], x[6], x[7]};
  m.specular_roughness = x[8];
  m.specular_ior = x[9];
  m.coat_weight = x[10];
  m.coat_roughness = x[11];
  m.specular_roughness_anisotropy = x[12];
  return m;
}

// --- Closures ------------------------------------------------------------------------------------

// A material of fewer closures: these parameters, and others that say that something is not there.
struct Closures {
  Free free;
  void (*pin)(OpenPbr* material);
  bool is_metal = false;
};

constexpr int kDiffuseRoughness = 3, kAnisotropy = 12;

// The diffuse term of glTF and of USD's preview is Lambert's.
Free WhatThereIs(bool anisotropic, StandardShading shading) {
  Free all(kMost);
  std::iota(all.begin(), all.end(), 0);
  if (!anisotropic) std::erase(all, kAnisotropy);
  if (shading != StandardShading::kOpenPbr) std::erase(all, kDiffuseRoughness);
  if (shading == StandardShading::kPreviewSurface) {
    for (const int k : {5, 6, 7, 10, 11, kAnisotropy}) std::erase(all, k);
  }
  return all;
}

void WithoutCoat(OpenPbr* m) { m->coat_weight = m->coat_roughness = 0; }
void WithoutTint(OpenPbr* m) {
  WithoutCoat(m);
  m->specular_color = {1, 1, 1};
  m->base_diffuse_roughness = 0;
}

// The fewest first. An engine has roughness, base colour and metalness alone; its metal is one GGX
// lobe whose F0 is the base colour.
std::vector<Closures> SimplerClosures(const Free& all) {
  std::vector<Closures> simpler = {{{0, 1, 2, 8},
                                    [](OpenPbr* m) {
                                      WithoutTint(m);
                                      m->base_metalness = 1;
                                    },
                                    /*is_metal=*/true},
                                   {{0, 1, 2, 8, 9},
                                    [](OpenPbr* m) {
                                      WithoutTint(m);
                                      m->base_metalness = 0;
                                    }},
                                   {{0, 1, 2, 4, 8, 9}, WithoutTint},
                                   {{0, 1, 2, 4, 5, 6, 7, 8, 9},
                                    [](OpenPbr* m) {
                                      WithoutCoat(m);
                                      m->base_diffuse_roughness = 0;
                                    }},
                                   {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, WithoutCoat}};
  const auto has = [&](int k) { return std::ranges::find(all, k) != all.end(); };
  for (Closures& one : simpler) {
    if (has(kAnisotropy)) one.free.push_back(kAnisotropy);
    std::erase_if(one.free, [&](int k) { return !has(k); });
  }
  return simpler;
}

// --- Comparison ----------------------------------------------------------------------------------

// Sums of BRDF times light, each compared with that of the model.
struct Sums {
  struct Term {
    DirectionPair pair;
    Rgb light{};
  };
  std::vector<Term> terms;  // one sum after the other
  std::vector<int> ends;    // of each sum
  bool lab = false;         // compared by CIELAB, or else by the cube root
  double exposure = 1;
  StandardShading shading = StandardShading::kOpenPbr;
  std::vector<Rgb> expected;  // of the model

  int size() const { return static_cast<int>(ends.size()); }

  Rgb Seen(const Rgb& sum) const {
    Rgb exposed{};
    for (int c = 0; c < kChannels; ++c) exposed[c] = exposure * std::max(sum[c], 0.0);
    if (lab) {
      // Beyond white, on which judges look no further, by the square root.
      for (double& x : exposed) x = x > 1 ? std::sqrt(x) : x;
      return ToLab(exposed);
    }
    // The offset limits the slope of the cube root at 0.
    for (double& x : exposed) x = std::cbrt(x + 1e-3);
    return exposed;
  }

  template <typename Brdf>
  std::vector<Rgb> Evaluate(const Brdf& brdf) const {
    std::vector<Rgb> sums;
    int k = 0;
    for (const int end : ends) {
      Rgb sum{};
      for (; k < end; ++k) {
        const Rgb rho = brdf(terms[k].pair);
        for (int c = 0; c < kChannels; ++c) sum[c] += rho[c] * terms[k].light[c];
      }
      sums.push_back(Seen(sum));
    }
    return sums;
  }
};

class SumsCost : public ceres::CostFunction {
 public:
  SumsCost(const Sums& sums, const OpenPbr& start, const Free& free, int num_threads)
      : sums_(sums), start_(start), free_(free), num_threads_(num_threads) {
    set_num_residuals(kChannels * sums.size());
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const int size = parameter_block_sizes()[0];
    const bool with_slopes = jacobians != nullptr && jacobians[0] != nullptr;
    std::vector<std::vector<Rgb>> seen(with_slopes ? size + 1 : 1);
    std::vector<double> steps(size);
    ParallelFor(static_cast<int>(seen.size()), num_threads_, [&](int k) {
      std::vector<double> x(parameters[0], parameters[0] + size);
      if (k > 0) {
        // Differences towards the middle of the bounds.
        constexpr double kStep = 1e-5;
        const Bound& bound = kBounds[free_[k - 1]];
        const double middle = (bound.least + bound.most) / 2;
        steps[k - 1] = x[k - 1] > middle ? -kStep : kStep;
        x[k - 1] += steps[k - 1];
      }
      seen[k] = sums_.Evaluate(StandardBrdf(sums_.shading, Unpack(x.data(), free_, start_)));
    });
    for (int j = 0; j < sums_.size(); ++j) {
      for (int c = 0; c < kChannels; ++c) {
        residuals[kChannels * j + c] = seen[0][j][c] - sums_.expected[j][c];
        for (int k = 0; with_slopes && k < size; ++k) {
          jacobians[0][(kChannels * j + c) * size + k] =
              (seen[k + 1][j][c] - seen[0][j][c]) / steps[k];
        }
      }
    }
    return true;
  }

 private:
  const Sums& sums_;
  const OpenPbr start_;
  const Free free_;
  const int num_threads_;
};

OpenPbr Moved(const Sums& sums, const OpenPbr& start, const Free& free, int iterations,
              int num_threads) {
  const std::array<double, kMost> all = Pack(start);
  std::vector<double> x;
  for (const int k : free) x.push_back(std::clamp(all[k], kBounds[k].least, kBounds[k].most));
  ceres::Problem problem;
  problem.AddResidualBlock(new SumsCost(sums, start, free, num_threads),
                           new ceres::HuberLoss(sums.lab ? 10 : 0.5), x.data());
  for (size_t k = 0; k < x.size(); ++k) {
    problem.SetParameterLowerBound(x.data(), static_cast<int>(k), kBounds[free[k]].least);
    problem.SetParameterUpperBound(x.data(), static_cast<int>(k), kBounds[free[k]].most);
  }
  ceres::Solver::Options options;
  options.max_num_iterations = iterations;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-4;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return Unpack(x.data(), free, start);
}

// --- The model -----------------------------------------------------------------------------------

using Prepared = PreparedModel<double>;

// rho cos theta_i over half vectors and difference angles, even steps of the square root of
// theta_h.
Sums OverHalfVectors(const Prepared& model, double max_theta) {
  const bool anisotropic = model.anisotropic();
  const int across = anisotropic ? 20 : 32, along = anisotropic ? 6 : 9;
  const int around = anisotropic ? 6 : 1;
  Sums sums;
  double mean = 0;
  for (int h = 0; h < across; ++h) {
    const double u = (h + 0.5) / across;
    for (int a = 0; a < around; ++a) {
      const double phi_h = 2 * kPi * a / around, theta_h = u * u * kPi / 2;
      const Direction half = {std::sin(theta_h) * std::cos(phi_h),
                              std::sin(theta_h) * std::sin(phi_h), std::cos(theta_h)};
      for (int d = 0; d < along; ++d) {
        for (const double phi_d : {0.5, 1.5, 2.5}) {
          // wi about half, by a frame along and across the way that it leans.
          const double theta_d = (d + 0.5) / along * kPi / 2;
          const Direction x = {std::cos(theta_h) * std::cos(phi_h),
                               std::cos(theta_h) * std::sin(phi_h), -std::sin(theta_h)};
          const Direction y = {-std::sin(phi_h), std::cos(phi_h), 0};
          Sums::Term term;
          for (int axis = 0; axis < 3; ++axis) {
            term.pair.wi[axis] =
                std::sin(theta_d) * (std::cos(phi_d) * x[axis] + std::sin(phi_d) * y[axis]) +
                std::cos(theta_d) * half[axis];
            term.pair.wo[axis] = 2 * std::cos(theta_d) * half[axis] - term.pair.wi[axis];
          }
          const double least = std::max(std::cos(max_theta), 0.05);
          if (std::min(term.pair.wi[2], term.pair.wo[2]) < least) continue;
          const double cosine = term.pair.wi[2];
          term.light = {cosine, cosine, cosine};
          mean += Mean(model.Value(term.pair.wi, term.pair.wo)) * cosine;
          sums.terms.push_back(term);
          sums.ends.push_back(static_cast<int>(sums.terms.size()));
        }
      }
    }
  }
  if (!(mean > 0)) {
    throw Error(ErrorKind::kData, "the model is black; there is nothing to match")
        .About("model", "black");
  }
  // A cube root of around one for a diffuse surface as bright as the model, so that loss and offset
  // mean the same for any.
  const Rgb white = model.diffuse();
  sums.exposure = 1 / std::max(Mean(white), 0.01);
  return sums;
}

// A small sphere under few lights.
Sums OverSphere(const Prepared& model, double max_theta, const AppearanceOptions& options) {
  constexpr int kSize = 20, kLights = 80;
  const View view = ViewSphere(kSize);
  const std::vector<Light> lights =
      DrawLights(EnvironmentOf(options), std::min(kLights, options.lights));
  Sums sums;
  sums.lab = true;
  double luminance = 0;
  for (const SurfacePoint& point : view.points) {
    const auto local = [&](const Direction& w) {
      return Direction{Dot(w, point.x), Dot(w, point.y), Dot(w, point.normal)};
    };
    const Direction wo = local(kEye);
    const size_t before = sums.terms.size();
    Rgb seen{};
    for (const Light& light : lights) {
      const Direction wi = local(light.direction);
      if (std::min(wi[2], wo[2]) < std::max(std::cos(max_theta), 1e-3)) continue;
      Rgb irradiance = light.irradiance;
      const Rgb rho = model.Value(wi, wo);
      for (int c = 0; c < kChannels; ++c) {
        irradiance[c] *= wi[2];
        seen[c] += rho[c] * irradiance[c];
      }
      sums.terms.push_back({{wi, wo}, irradiance});
    }
    if (sums.terms.size() == before) continue;
    sums.ends.push_back(static_cast<int>(sums.terms.size()));
    luminance += Luminance(seen);
  }
  if (!(luminance > 0)) {
    throw Error(ErrorKind::kData, "the model is black; there is nothing to match")
        .About("model", "black");
  }
  sums.exposure = kMeanLuminance * sums.size() / luminance;
  return sums;
}

// Albedo at the normal of the diffuse term, and the mean color of all.
std::vector<OpenPbr> Starts(const Prepared& model, StandardShading shading) {
  Rgb diffuse = model.diffuse();
  for (double& x : diffuse) x = std::clamp(x * kPi, 0.02, 0.95);
  const Direction up = {0, 0, 1};
  Rgb bright = model.Value(up, up);
  const double most = std::max({bright[0], bright[1], bright[2], 1e-9});
  for (double& x : bright) x = std::clamp(x / most, 0.1, 1.0) * 0.8;
  std::vector<OpenPbr> starts;
  for (const double roughness : {0.2, 0.5}) {
    starts.push_back({.base_color = diffuse,
                      .base_metalness = 0.05,
                      .specular_color = {0.9, 0.9, 0.9},
                      .specular_roughness = roughness,
                      .coat_weight = 0.1,
                      .coat_roughness = roughness / 2});
    starts.push_back({.base_color = bright,
                      .base_metalness = 0.95,
                      .specular_color = {0.9, 0.9, 0.9},
                      .specular_roughness = roughness,
                      .coat_weight = 0.1,
                      .coat_roughness = roughness / 2});
  }
  if (shading == StandardShading::kPreviewSurface) {
    for (OpenPbr& start : starts) WithoutTint(&start);
    return starts;
  }
  if (!model.anisotropic()) return starts;
  std::vector<OpenPbr> turned;
  for (OpenPbr start : starts) {
    // glTF's strength counts by its square.
    start.specular_roughness_anisotropy = shading == StandardShading::kGltf ? 0.6 : 0.3;
    for (const double turn : {0.0, kPi / 2}) {
      start.turn = turn;
      turned.push_back(start);
    }
  }
  return turned;
}

}  // namespace

BrdfFunction StandardBrdf(StandardShading shading, const OpenPbr& material) {
  if (shading == StandardShading::kOpenPbr) return OpenPbrBrdf(material);
  return GltfBrdf(material);
}

NearestOpenPbr FindNearestOpenPbr(const FactorModel& model, double max_theta,
                                  const AppearanceOptions& options, StandardShading shading) {
  const Prepared prepared(model);
  const auto value = [&](const DirectionPair& pair) { return prepared.Value(pair.wi, pair.wo); };
  Sums half_vectors = OverHalfVectors(prepared, max_theta);
  half_vectors.expected = half_vectors.Evaluate(value);
  Sums sphere = OverSphere(prepared, max_theta, options);
  sphere.expected = sphere.Evaluate(value);
  half_vectors.shading = sphere.shading = shading;

  const double least = std::cos(max_theta) - 1e-12;
  const auto counts = [&](const SphericalAngles& at) {
    return std::cos(at.theta_i) >= least && std::cos(at.theta_o) >= least;
  };
  const std::vector<Light> lights = DrawLights(EnvironmentOf(options), options.lights);
  const auto distance = [&](const OpenPbr& material) {
    double sum = 0;
    const std::vector<Rgb> seen = sphere.Evaluate(StandardBrdf(shading, material));
    for (int j = 0; j < sphere.size(); ++j) sum += LabDifference(seen[j], sphere.expected[j]);
    return sum;
  };
  const auto rendered = [&](const OpenPbr& material) {
    const BrdfFunction brdf = StandardBrdf(shading, material);
    const SphericalBrdf materials[] = {
        [&](const SphericalAngles& at) { return value(ToDirections(at)); },
        [&](const SphericalAngles& at) { return brdf(ToDirections(at)); }};
    const RenderedImages images =
        Render(ViewSphere(options.size, 4), materials, lights, counts, false, options.num_threads);
    return NearestOpenPbr{material, CompareSpheres(images.counted[0], images.counted[1])};
  };
  // The best of what so many of all starts lead to, with these parameters free.
  const auto nearest_of = [&](const std::vector<OpenPbr>& starts, const Free& free,
                              size_t refined) {
    std::vector<std::pair<double, OpenPbr>> near;
    for (const OpenPbr& start : starts) {
      OpenPbr material = Moved(half_vectors, start, free, 12, options.num_threads);
      material = Moved(sphere, material, free, 8, options.num_threads);
      near.emplace_back(distance(material), material);
    }
    std::ranges::stable_sort(near, {}, &std::pair<double, OpenPbr>::first);
    near.resize(std::min(near.size(), refined));
    std::optional<NearestOpenPbr> nearest;
    for (const auto& start : near) {
      const NearestOpenPbr found =
          rendered(Moved(sphere, start.second, free, 40, options.num_threads));
      if (!nearest || found.error.mean_delta_e < nearest->error.mean_delta_e) nearest = found;
    }
    return *nearest;
  };
  const std::vector<OpenPbr> starts = Starts(prepared, shading);
  const Free all = WhatThereIs(prepared.anisotropic(), shading);
  const NearestOpenPbr nearest = nearest_of(starts, all, 2);
  // What is not seen to be there is left out.
  constexpr double kNotSeen = 0.5;  // [dB]
  const auto is_alike = [&](const SphereError& error) {
    return error.psnr_db >= nearest.error.psnr_db - kNotSeen ||
           VerdictOf(error).visibility == Visibility::kNone;
  };
  std::optional<NearestOpenPbr> metal;  // or a dielectric, whichever is nearer
  for (const Closures& closures : SimplerClosures(all)) {
    // From what has all closures, and the nearest of the starts without these.
    std::vector<OpenPbr> simple = starts;
    for (OpenPbr& start : simple) closures.pin(&start);
    std::ranges::stable_sort(simple, {}, distance);
    simple.resize(1);
    simple.push_back(nearest.material);
    closures.pin(&simple.back());
    NearestOpenPbr found = nearest_of(simple, closures.free, 1);
    if (closures.is_metal) {
      metal = found;
      continue;
    }
    if (metal && metal->error.psnr_db > found.error.psnr_db) found = *metal;
    if (is_alike(found.error)) return found;
  }
  return nearest;
}

}  // namespace trilobe
