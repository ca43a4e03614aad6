#include "trilobe/model/appearance/appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "model/appearance/color.h"
#include "model/appearance/render_environment.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {
namespace {

// Marks also the bins around each marked one, 26 or fewer; phi_d is cyclic.
std::vector<bool> WithNeighbours(const MerlGrid& grid, std::vector<bool> marked) {
  const auto widen = [&](int size, int stride, bool cyclic) {
    const std::vector<bool> from = marked;
    const int around = (size - 1) * stride;
    for (int bin = 0; bin < grid.size(); ++bin) {
      const int place = bin / stride % size;
      const int before = place > 0 ? bin - stride : bin + (cyclic ? around : 0);
      const int after = place + 1 < size ? bin + stride : bin - (cyclic ? around : 0);
      marked[bin] = from[before] || from[bin] || from[after];
    }
  };
  widen(grid.phi_d, 1, true);
  widen(grid.theta_d, grid.phi_d, false);
  widen(grid.theta_h, grid.theta_d * grid.phi_d, false);
  return marked;
}

// The measured directions. A bin whose centre is below the surface has no sample; its part above
// the surface is measured if a bin around it is.
class MeasuredDirections {
 public:
  explicit MeasuredDirections(const BrdfTable& table)
      : grid_(table.grid), min_cosine_(std::cos(table.max_theta)) {
    const std::vector<bool> above = BinsAboveSurface(grid_), valid = ValidBins(table);
    if (valid != above) {
      measured_ = WithNeighbours(grid_, valid);
      for (int bin = 0; bin < grid_.size(); ++bin) {
        if (above[bin]) measured_[bin] = valid[bin];
      }
    }
    everything_ = measured_.empty() && table.max_theta >= kPi / 2;
  }

  bool operator()(const HalfDiffAngles& angles, const Cosines& cosines) const {
    if (everything_) return true;
    return cosines.i >= min_cosine_ && cosines.o >= min_cosine_ &&
           (measured_.empty() || measured_[grid_.Bin(angles)]);
  }

 private:
  MerlGrid grid_;
  double min_cosine_;
  std::vector<bool> measured_;  // [grid.size()], or empty if all are
  bool everything_ = false;
};

// The BRDF clamped at 0, as a renderer does.
AngularBrdf Clamped(const AngularBrdf& brdf) {
  CheckNotEmpty(brdf, "the material");
  return [&brdf](const HalfDiffAngles& angles, const Cosines& cosines) {
    Rgb rho = brdf(angles, cosines);
    for (double& x : rho) x = std::max(x, 0.0);
    return rho;
  };
}

// The BRDF, 0 at unmeasured directions.
BrdfFunction OfMeasured(const AngularBrdf& brdf, const MeasuredDirections& counts) {
  return [&brdf, &counts](const DirectionPair& pair) {
    const HalfDiffAngles angles = ToHalfDiff(pair);
    const Cosines cosines{pair.wi[2], std::min(pair.wo[2], 1.0)};
    return counts(angles, cosines) ? brdf(angles, cosines) : Rgb{};
  };
}

// At the centres of a subset of valid bins (offset 1/2), or at their upper corners (offset 1) if
// all bins around these are valid.
PointErrors CompareAtPoints(const BrdfTable& table, const std::vector<bool>& valid, double offset,
                            const AngularBrdf& measured, const AngularBrdf& fitted,
                            int num_threads) {
  constexpr int kStrideD = 3, kStrideP = 5;
  const MerlGrid& grid = table.grid;
  std::vector<PointErrorSum> sums(grid.theta_h - 1);
  ParallelFor(static_cast<int>(sums.size()), num_threads, [&](int h) {
    for (int d = h % kStrideD; d + 1 < grid.theta_d; d += kStrideD) {
      for (int p = (h + d) % kStrideP; p + 1 < grid.phi_d; p += kStrideP) {
        bool inside = true;
        for (int corner = 0; corner < 8; ++corner) {
          inside = inside &&
                   valid[grid.Index(h + (corner & 1), d + (corner >> 1 & 1), p + (corner >> 2))];
        }
        const HalfDiffAngles angles = {grid.ThetaH(h + offset), grid.ThetaD(d + offset),
                                       grid.PhiD(p + offset)};
        const Cosines cosines = ToCosines(angles);
        if (!inside || !(cosines.i > 0 && cosines.o > 0)) continue;
        sums[h].Add(measured(angles, cosines), fitted(angles, cosines), cosines.i);
      }
    }
  });
  return MeanOf(sums);
}

BeyondData LookBeyond(const BrdfTable& table, const std::vector<bool>& valid,
                      const AngularBrdf& fitted, int num_threads) {
  constexpr int kStride = 5;  // of phi_d
  const MerlGrid& grid = table.grid;
  const std::vector<bool> above = BinsAboveSurface(grid);
  struct Row {
    double largest_within = 0, largest = 0;
    int within = 0, beyond = 0;
  };
  std::vector<Row> rows(grid.theta_h);
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    for (int d = 0; d < grid.theta_d; ++d) {
      for (int p = 0; p < grid.phi_d; ++p) {
        const int bin = grid.Index(h, d, p);
        const bool beyond = above[bin] && ReasonOf(table, bin) != Unmeasured::kNo;
        if (!beyond && !valid[bin]) continue;
        ++(beyond ? rows[h].beyond : rows[h].within);
        if ((h + d + p) % kStride != 0) continue;
        const HalfDiffAngles angles = grid.Center(bin);
        const Cosines cosines = ToCosines(angles);
        const Rgb rho = fitted(angles, cosines);
        double& most = beyond ? rows[h].largest : rows[h].largest_within;
        most = std::max(most, std::ranges::max(rho) * std::max(cosines.i, cosines.o));
      }
    }
  });
  BeyondData data;
  int within = 0, beyond = 0;
  for (const Row& row : rows) {
    data.largest_within = std::max(data.largest_within, row.largest_within);
    data.largest = std::max(data.largest, row.largest);
    within += row.within;
    beyond += row.beyond;
  }
  data.share = static_cast<double>(beyond) / std::max(within + beyond, 1);
  return data;
}

// Whether a pixel is beyond kGrazingAngleDegrees on a sphere `size` pixels wide.
bool AtRim(size_t pixel, int size) {
  const auto place = [size](size_t k) { return (static_cast<double>(k) + 0.5) / size * 2 - 1; };
  return std::hypot(place(pixel % size), place(pixel / size)) >
         std::sin(DegreesToRadians(kGrazingAngleDegrees));
}

using Counts = std::function<bool(const HalfDiffAngles&, const Cosines&)>;
bool Everything(const HalfDiffAngles& /*angles*/, const Cosines& /*cosines*/) { return true; }

ImagePair RenderPair(const TabulatedBrdf& measured, const AngularBrdf& fitted, const Counts& counts,
                     const AppearanceOptions& options) {
  const std::vector<Light> lights = DrawLights(EnvironmentOf(options), options.lights);
  const AngularBrdf brdfs[] = {Interpolated(measured), Clamped(fitted)};
  std::vector<RenderedImage> spheres =
      RenderSpheres(brdfs, lights, options.size, counts, options.num_threads);
  return {std::move(spheres[0]), std::move(spheres[1])};
}

// Marks all bins as measured, so that the authors' values count.
BrdfTable AllMeasured(BrdfTable measured) {
  measured.unmeasured.clear();
  return measured;
}

ImagePair RenderEverywhere(const BrdfTable& measured, const AngularBrdf& fitted,
                           const AppearanceOptions& options) {
  return RenderPair(TabulatedBrdf(AllMeasured(measured), options.num_threads), fitted, Everything,
                    options);
}

}  // namespace

const Environment& EnvironmentOf(const AppearanceOptions& options) {
  return options.environment != nullptr ? *options.environment : StudioEnvironment();
}

void CheckFinite(const AppearanceReport& report, const std::string& source) {
  const double largest = report.beyond ? report.beyond->largest : 0;
  for (const double x : {report.sphere.mean_color_error, report.sphere.mean_delta_e,
                         report.albedo.mean, report.at_centers.log, report.at_centers.relative,
                         report.between_centers.log, report.between_centers.relative, largest}) {
    if (!std::isfinite(x)) {
      throw ErrorIn(ErrorKind::kData, source,
                    "the model's values overflow; its factors are too large")
          .About("model", "overflow");
    }
  }
}

SphereError CompareSpheres(const RenderedImage& measured, const RenderedImage& fitted) {
  for (const RenderedImage* const image : {&measured, &fitted}) {
    CheckSize("a picture", image->radiance.size(), measured.coverage.size());
  }
  std::vector<size_t> pixels;
  Rgb mean_measured{}, mean_fitted{};
  for (size_t k = 0; k < measured.radiance.size(); ++k) {
    if (!(measured.coverage[k] > 0)) continue;
    pixels.push_back(k);
    for (int c = 0; c < kChannels; ++c) {
      mean_measured[c] += measured.radiance[k][c];
      mean_fitted[c] += fitted.radiance[k][c];
    }
  }
  const auto n = static_cast<double>(std::max<size_t>(pixels.size(), 1));
  const double exposure = kMeanLuminance / (Luminance(mean_measured) / n);
  const auto exposed = [exposure](const Rgb& radiance) {
    Rgb light;
    for (int c = 0; c < kChannels; ++c) light[c] = radiance[c] > 0 ? exposure * radiance[c] : 0;
    return light;
  };
  SeenErrorSum sum;
  for (const size_t k : pixels) {
    sum.Add(exposed(measured.radiance[k]), exposed(fitted.radiance[k]), AtRim(k, measured.size));
  }
  return {sum.Total(), RelativeDistance(mean_fitted, mean_measured),
          std::isfinite(exposure) ? exposure : 0};
}

AppearanceReport CompareAppearance(const BrdfTable& measured, const AngularBrdf& fitted,
                                   const AppearanceOptions& options) {
  const Environment& environment = EnvironmentOf(options);
  const TabulatedBrdf table(measured, options.num_threads);
  const MeasuredDirections counts(measured);
  const std::vector<bool> valid = ValidBins(measured);
  const AngularBrdf brdfs[] = {Interpolated(table), Clamped(fitted)};

  AppearanceReport report;
  report.environment = environment.name;
  report.lights = options.lights;
  report.size = options.size;
  const ImagePair pair = RenderPair(table, fitted, std::cref(counts), options);
  report.sphere = CompareSpheres(pair.measured, pair.fitted);
  const double phi_i[] = {0};
  report.albedo = CompareAlbedos(OfMeasured(brdfs[0], counts), OfMeasured(brdfs[1], counts), phi_i,
                                 options.num_threads);
  report.at_centers =
      CompareAtPoints(measured, valid, 0.5, brdfs[0], brdfs[1], options.num_threads);
  report.between_centers =
      CompareAtPoints(measured, valid, 1, brdfs[0], brdfs[1], options.num_threads);
  if (!measured.unmeasured.empty()) {
    report.beyond = LookBeyond(measured, valid, brdfs[1], options.num_threads);
    const ImagePair whole = RenderEverywhere(measured, fitted, options);
    report.beyond->psnr_db = CompareSpheres(whole.measured, whole.fitted).psnr_db;
  }
  CheckFinite(report, measured.source);
  return report;
}

ImagePair RenderMeasuredPair(const BrdfTable& measured, const AngularBrdf& fitted,
                             const AppearanceOptions& options) {
  return RenderPair(TabulatedBrdf(measured, options.num_threads), fitted,
                    MeasuredDirections(measured), options);
}

SphereJudge::SphereJudge(const BrdfTable& measured, const AppearanceOptions& options)
    : SphereJudge(measured, MeasuredDirections(measured), options) {}

SphereJudge::SphereJudge(const BrdfTable& measured,
                         std::function<bool(const HalfDiffAngles&, const Cosines&)> counts,
                         const AppearanceOptions& options)
    : size_(options.size),
      num_threads_(options.num_threads),
      lights_(DrawLights(EnvironmentOf(options), options.lights)),
      counts_(std::move(counts)),
      measured_(Render(Interpolated(TabulatedBrdf(measured, options.num_threads)))) {}

SphereJudge SphereJudge::OfAllDirections(const BrdfTable& measured,
                                         const AppearanceOptions& options) {
  return {AllMeasured(measured), Everything, options};
}

SphereError SphereJudge::operator()(const AngularBrdf& fitted) const {
  return CompareSpheres(measured_, Render(Clamped(fitted)));
}

RenderedImage SphereJudge::Render(const AngularBrdf& brdf) const {
  constexpr int kEvery = 4;
  return std::move(RenderSpheres({&brdf, 1}, lights_, size_, counts_, num_threads_, kEvery)[0]);
}

ImagePairs PairsOf(RenderedImages&& images) {
  auto& [counted, whole] = images;
  return {{std::move(counted[0]), std::move(counted[1])},
          {std::move(whole[0]), std::move(whole[1])}};
}

ImagePairs RenderPicture(const BrdfTable& measured, const AngularBrdf& fitted,
                         const AppearanceOptions& options) {
  const TabulatedBrdf table(measured, options.num_threads);
  const AngularBrdf brdfs[] = {Interpolated(table), Clamped(fitted)};
  return PairsOf(RenderSphereUnder(EnvironmentOf(options), options.size, brdfs,
                                   MeasuredDirections(measured), options.num_threads));
}

RenderedImage RenderPicture(const Material& material, const AppearanceOptions& options) {
  const Environment& environment = EnvironmentOf(options);
  if (material.angular) {
    const AngularBrdf brdf = Clamped(material.angular);
    return std::move(
        RenderSphereUnder(environment, options.size, {&brdf, 1}, Everything, options.num_threads)
            .whole[0]);
  }
  CheckNotEmpty(material.spherical, "the material");
  const auto everything = [](const SphericalAngles&) { return true; };
  return std::move(RenderUnder(environment, ViewSphere(options.size), {&material.spherical, 1},
                               everything, options.num_threads)
                       .whole[0]);
}

}  // namespace trilobe
