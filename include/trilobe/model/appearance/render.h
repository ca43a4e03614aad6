#ifndef TRILOBE_MODEL_APPEARANCE_RENDER_H_
#define TRILOBE_MODEL_APPEARANCE_RENDER_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/view.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// Radiance of an object seen from afar, without shadows and reflections of itself.
struct RenderedImage {
  int size = 0;                  // pixels in a row
  std::vector<Rgb> radiance;     // row by row from the top; 0 off the object
  std::vector<double> coverage;  // the share of the light on a pixel that counts; below 0 off the
                                 // object
};

// One image a material: of the pairs of directions that count, and, if asked for, of all.
struct RenderedImages {
  std::vector<RenderedImage> counted, whole;  // of the same coverage
};

// Renders a view of an object of each material, all under the same lights; `counts` says which
// pairs of directions do. The same bits for any number of threads.
RenderedImages Render(const View& view, std::span<const SphericalBrdf> materials,
                      std::span<const Light> lights,
                      const std::function<bool(const SphericalAngles&)>& counts, bool whole_too,
                      int num_threads);

// Light that falls on a point from one direction, if cosines.i > 0.
template <typename Angles>
struct Incident {
  Cosines cosines{};  // from the normal to light and eye
  Angles angles{};
  Rgb irradiance{};   // on a surface that faces it
  double weight = 1;  // in the coverage
};

// Cosines between the normal of a point and a light and the eye; .i is 0 if either is below the
// surface.
inline Cosines CosinesOver(const SurfacePoint& point, const Direction& light) {
  const Cosines cosines{std::min(Dot(point.normal, light), 1.0),
                        std::min(Dot(point.normal, kEye), 1.0)};
  return cosines.i > 0 && cosines.o > 0 ? cosines : Cosines{};
}

// The azimuth of a direction over a point, from its x towards its y.
inline double PhiOver(const SurfacePoint& point, const Direction& direction) {
  return std::atan2(Dot(direction, point.y), Dot(direction, point.x));
}

// The same for any kind of angles and of light. `incident(k, l)` is what falls on view.points[k] as
// the l-th of so many `lights`, an Incident; `value(material, angles, cosines)` is the BRDF there,
// and `counts(angles, cosines)` as above.
template <typename IncidentOn, typename Value, typename Counts>
RenderedImages RenderBy(const View& view, int lights, int materials, const IncidentOn& incident,
                        const Value& value, const Counts& counts, bool whole_too, int num_threads) {
  const size_t pixels = static_cast<size_t>(view.width) * view.height;
  for (const SurfacePoint& point : view.points) {
    CheckIndex(point.pixel, static_cast<int64_t>(pixels), "the pixel of a point");
  }
  const RenderedImage black = {view.width, std::vector<Rgb>(pixels),
                               std::vector<double>(pixels, -1.0)};
  RenderedImages images{std::vector<RenderedImage>(materials, black),
                        std::vector<RenderedImage>(whole_too ? materials : 0, black)};
  constexpr int kPoints = 512;  // an item of work
  const int size = static_cast<int>(view.points.size());
  ParallelFor((size + kPoints - 1) / kPoints, num_threads, [&](int item) {
    const int begin = item * kPoints, end = std::min(size, begin + kPoints);
    struct Sum {
      double light = 0, counted = 0;
    };
    std::vector<Sum> sums(end - begin);
    // Pixel by pixel within a light: much of what is read for it stays.
    for (int l = 0; l < lights; ++l) {
      for (int k = begin; k < end; ++k) {
        const auto light = incident(k, l);
        const Cosines& cosines = light.cosines;
        if (!(cosines.i > 0)) continue;
        const SurfacePoint& point = view.points[k];
        const bool counted = counts(light.angles, cosines);
        Sum& sum = sums[k - begin];
        sum.light += cosines.i * light.weight;
        if (counted) sum.counted += cosines.i * light.weight;
        if (!counted && !whole_too) continue;
        for (int m = 0; m < materials; ++m) {
          const Rgb rho = value(m, light.angles, cosines);
          const auto add_to = [&](RenderedImage* image) {
            Rgb& radiance = image->radiance[point.pixel];
            for (int c = 0; c < kChannels; ++c) {
              radiance[c] += rho[c] * cosines.i * light.irradiance[c];
            }
          };
          if (counted) add_to(&images.counted[m]);
          if (whole_too) add_to(&images.whole[m]);
        }
      }
    }
    for (int k = begin; k < end; ++k) {
      const auto [light, counted] = sums[k - begin];
      const double coverage = light > 0 ? counted / light : 1;
      for (auto* const set : {&images.counted, &images.whole}) {
        for (RenderedImage& image : *set) image.coverage[view.points[k].pixel] = coverage;
      }
    }
  });
  return images;
}

// One sphere an isotropic material, all under the same lights, in size^2 pixels, whose sides it
// touches: what Render makes of them, faster. Pairs of directions for which `counts` is false are
// left out of all spheres. Of the pixels one in `every`, evenly spread; the others are as those
// beside the sphere. The same bits for any number of threads.
std::vector<RenderedImage> RenderSpheres(
    std::span<const AngularBrdf> materials, std::span<const Light> lights, int size,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads,
    int every = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_RENDER_H_
