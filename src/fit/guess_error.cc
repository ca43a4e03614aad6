#include "fit/guess_error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "fit/finish/albedo_limit.h"
#include "fit/finish/shown_light.h"
#include "model/appearance/node_appearance.h"
#include "model/objective/beyond_data.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {
namespace {

// The coverage without the last `width` [rad] of what is well covered in each table.
std::vector<double> HideEnds(std::span<const double> coverage, const FactorModel& model,
                             double width) {
  std::vector<double> hidden(coverage.begin(), coverage.end());
  const ModelSpec& spec = model.spec();
  for (const Factor factor : kFactors) {
    const Axis& axis = spec.axis(factor);
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = std::span(hidden).subspan(model.TableOffset(factor, t), axis.size);
      int last = axis.size - 1;
      while (last > 0 && !(table[last] > 0 && IsWellCovered(table, last))) --last;
      const double end = axis.Theta(last) - width;
      for (int k = 0; k < axis.size; ++k) {
        if (axis.Theta(k) > end) table[k] = 0;
      }
    }
  }
  return hidden;
}

constexpr int kEvery = 4;  // pixels: tell the same as all would

SphereError CompareWhole(const FactorModel& model, const FactorModel& other,
                         const AppearanceOptions& options) {
  const auto everything = [](const HalfDiffAngles&, const Cosines&) { return true; };
  const AngularBrdf materials[] = {MaterialOf(model).angular, MaterialOf(other).angular};
  const std::vector<RenderedImage> spheres =
      RenderSpheres(materials, DrawLights(EnvironmentOf(options), options.lights), options.size,
                    everything, options.num_threads, kEvery);
  return CompareSpheres(spheres[0], spheres[1]);
}

double SumInDecibels(double a, double b) {
  return -10 * std::log10(std::pow(10, -a / 10) + std::pow(10, -b / 10));
}

// Error of the measured part and of a guess, whose error is `share` times `guess`.
WholeSphere Joined(const SeenError& seen, const SphereError& guess, double share) {
  return {.mean_delta_e = std::hypot(seen.mean_delta_e, share * guess.mean_delta_e),
          .psnr_db = SumInDecibels(seen.psnr_db, guess.psnr_db - 20 * std::log10(share))};
}

constexpr double kNextToAll = 0.98;  // of what a renderer reads

// The incidences of samples, from 0 in ascending order of theta_i. [n]
std::vector<int> IncidencesOf(const BrdfSamples& samples) {
  constexpr double kSame = DegreesToRadians(1), kWide = DegreesToRadians(10);
  constexpr int kFew = 8;  // samples of an incidence, which then is none
  const auto numbers = [&](double step) {
    std::vector<int> number;
    for (const SphericalAngles& at : samples.directions) {
      number.push_back(static_cast<int>(std::lround(at.theta_i / step)));
    }
    return number;
  };
  std::vector<int> number = numbers(kSame);
  std::set<int> different(number.begin(), number.end());
  if (different.size() * kFew > number.size()) {
    number = numbers(kWide);
    different = {number.begin(), number.end()};
  }
  for (int& at : number) {
    at = static_cast<int>(std::distance(different.begin(), different.find(at)));
  }
  return number;
}

// The samples of the first or of the second of each two incidences.
BrdfSamples EveryOther(const BrdfSamples& samples, const std::vector<int>& incidences, int which) {
  std::vector<int> kept;
  for (int j = 0; j < samples.size(); ++j) {
    if (incidences[j] % 2 == which) kept.push_back(j);
  }
  return Selected(samples, kept);
}

// How far fits to halves are off, over what the fit to all is off by. Where all samples are of the
// highlight, both halves guess the rest alike; where a half is one incidence, it knows much less.
double HalvesOff(const BrdfSamples& samples, const std::vector<int>& incidences) {
  if (std::ranges::max(incidences) == 1) return 2.25;
  return ShowsMoreThanHighlight(samples) ? 1.25 : 1;
}

}  // namespace

std::optional<WholeSphere> EstimateWholeSphere(const Objective& data, const FactorModel& model,
                                               double measured_share, const SeenError& seen,
                                               const AppearanceOptions& options) {
  constexpr double kHidden = 1.0 / 3;
  if (!(measured_share < kNextToAll) || model.spec().anisotropic()) return std::nullopt;
  const double end = std::asin(std::pow(measured_share, 0.25));
  const double width = kHidden * (kPi / 2 - end);
  FactorModel rehearsed = model;
  ContinueBeyondData(HideEnds(data.coverage(), model, width), options.num_threads, &rehearsed);
  AlbedoLimits limits = AlbedoLimitsOf(data, model);
  limits.beyond_theta -= width;
  LimitAlbedo(limits, kAllAngles, TableLayout::Full(model.spec()), options.num_threads, {},
              &rehearsed);
  return Joined(seen, CompareWhole(model, rehearsed, options), 1);
}

WholeSphere EstimateWholeOfNodes(const NodeBrdf& measured, const FactorModel& model,
                                 const SeenError& seen, const AppearanceOptions& options) {
  constexpr double kShare = 1.0 / 4;
  const SphericalBrdf fitted = MaterialOf(model).spherical;
  const NodeBrdf at_nodes = AtNodesOf(measured, fitted, options.num_threads);
  const SphericalBrdf materials[] = {fitted, std::cref(at_nodes)};
  const std::vector<RenderedImage> spheres =
      Render(
          ViewSphere(options.size, kEvery), materials,
          DrawLights(EnvironmentOf(options), options.lights),
          [](const SphericalAngles&) { return true; }, /*whole_too=*/false, options.num_threads)
          .counted;
  return Joined(seen, CompareSpheres(spheres[0], spheres[1]), kShare);
}

std::optional<WholeSphere> EstimateWholeOfSamples(const BrdfSamples& samples,
                                                  const FactorModel& model, int parameters,
                                                  double measured_share, const SeenError& seen,
                                                  const FitTo& fit_to,
                                                  const AppearanceOptions& options) {
  const bool next_to_all = samples.size() >= parameters && !(measured_share < kNextToAll);
  constexpr int kLeast = 32;  // samples, of which halves tell something
  if (next_to_all || samples.size() < kLeast || samples.directions.empty() ||
      model.spec().anisotropic()) {
    return std::nullopt;
  }
  const std::vector<int> incidences = IncidencesOf(samples);
  if (std::ranges::max(incidences) == 0) return std::nullopt;
  const double halves_off = HalvesOff(samples, incidences);
  double squares = 0, errors = 0;  // of the colours, of the encoded values; means of the halves
  for (const int which : {0, 1}) {
    const FactorModel half = fit_to(EveryOther(samples, incidences, which));
    const SphereError guess = CompareWhole(model, half, options);
    squares += std::pow(guess.mean_delta_e, 2) / 2;
    errors += std::pow(10, -guess.psnr_db / 10) / 2;
  }
  return WholeSphere{
      .mean_delta_e = std::hypot(seen.mean_delta_e, std::sqrt(squares) / halves_off),
      .psnr_db = SumInDecibels(seen.psnr_db, -10 * std::log10(errors / std::pow(halves_off, 2)))};
}

}  // namespace trilobe
