#include "fit/seen_design.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "model/appearance/color.h"
#include "model/objective/sample_derivatives.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

// The mean square of a weighted residual, of one channel; not 0 for black samples.
double ResidualSquare(const Objective& data, const FactorModel& model) {
  constexpr double kNoise = 0.02;  // of a value, that any device has
  const double least = kNoise * kNoise * data.MeasuredEnergy();
  const double sum = std::max(data.Value(model), least);
  return sum > 0 ? sum / (kChannels * data.num_samples()) : 1;
}

// L of the covariance (L L')^-1 of the parameters.
Eigen::LLT<Eigen::MatrixXd> Information(const FitProblem& problem, const FactorModel& model,
                                        double residual_square) {
  constexpr double kRelative = 1.0 / 3, kOfMean = 0.1;
  QuadraticModel about;
  NormalEquations(problem.solved()).Evaluate(model, Hessian::kGaussNewton, &about);
  const std::span<const double> x = model.parameters();
  const auto size = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd information =
      Eigen::Map<const Eigen::MatrixXd>(about.H.data(), size, size) / residual_square;
  for (const auto& [begin, count] : model.Parts()) {
    double mean = 0;
    for (int k = begin; k < begin + count; ++k) mean += x[k] / count;
    for (int k = begin; k < begin + count; ++k) {
      // A part that is all 0 has no light to tell of.
      constexpr double kNone = 1e-30;
      const double deviation = std::max(kRelative * std::hypot(x[k], kOfMean * mean), kNone);
      information(k, k) += 1 / (deviation * deviation);
    }
  }
  return Eigen::LLT<Eigen::MatrixXd>(information);
}

// What these directions read: the derivatives of their channels in units of the noise.
// [parameters][directions * kChannels]
Eigen::MatrixXd ReadsOf(std::span<const SphericalAngles> directions, const Objective& data,
                        const FactorModel& model, double residual_square) {
  const auto size = static_cast<int>(model.parameters().size());
  Eigen::MatrixXd reads = Eigen::MatrixXd::Zero(size, kChannels * std::ssize(directions));
  for (size_t j = 0; j < directions.size(); ++j) {
    const DirectionPair pair = ToDirections(directions[j]);
    const SampleStencils at = ScatteredStencils(model.spec(), ToHalfDiff(pair));
    const Rgb weight =
        data.weighting()({.rho = EvaluateAt(model, at), .cosines = {pair.wi[2], pair.wo[2]}});
    for (int c = 0; c < kChannels; ++c) {
      const double scale = std::sqrt(weight[c] / residual_square);
      const auto column = static_cast<Eigen::Index>(kChannels * j + c);
      SampleDerivatives::Visit(
          model, at, c, [&](int k, double derivative) { reads(k, column) += scale * derivative; });
    }
  }
  return reads;
}

// d Lab / d RGB of a linear colour. [Lab][RGB]
using ColourDerivatives = Eigen::Matrix<double, kChannels, kChannels>;
ColourDerivatives LabDerivatives(const Rgb& linear) {
  constexpr double kStep = 1e-4;
  ColourDerivatives derivatives;
  for (int c = 0; c < kChannels; ++c) {
    Rgb lower = linear, upper = linear;
    lower[c] = std::max(linear[c] - kStep, 0.0);
    upper[c] = linear[c] + kStep;
    const Lab below = ToLab(lower), above = ToLab(upper);
    for (int k = 0; k < kChannels; ++k) {
      derivatives(k, c) = (above[k] - below[k]) / (upper[c] - lower[c]);
    }
    // A camera clips it.
    if (linear[c] >= 1) derivatives.col(c).setZero();
  }
  return derivatives;
}

// Light on a pixel's point.
struct Lit {
  int pixel = 0;  // among those that are seen
  SampleStencils at;
  Rgb irradiance{};  // times cos theta_i
};

// What a sphere's pixels show: the derivatives of their colour in CIELAB.
// [parameters][pixels * kChannels]
Eigen::MatrixXd SeenOf(const FactorModel& model, const AppearanceOptions& options) {
  constexpr int kSize = 32, kEvery = 4, kLights = 300;
  const View view = ViewSphere(std::min(options.size, kSize), kEvery);
  const std::vector<Light> lights =
      DrawLights(EnvironmentOf(options), std::min(options.lights, kLights));
  const auto pixels = static_cast<int>(view.points.size());
  RenderedImage image{.size = pixels,
                      .radiance = std::vector<Rgb>(pixels),
                      .coverage = std::vector<double>(pixels, 1.0)};
  std::vector<Lit> all;
  for (int k = 0; k < pixels; ++k) {
    const SurfacePoint& point = view.points[k];
    for (const Light& light : lights) {
      const Cosines cosines = CosinesOver(point, light.direction);
      if (!(cosines.i > 0)) continue;
      const SphericalAngles angles{std::acos(cosines.i), PhiOver(point, light.direction),
                                   std::acos(cosines.o), PhiOver(point, kEye)};
      Lit lit{k, ScatteredStencils(model.spec(), ToHalfDiff(ToDirections(angles))), {}};
      const Rgb rho = EvaluateAt(model, lit.at);
      for (int c = 0; c < kChannels; ++c) {
        lit.irradiance[c] = cosines.i * light.irradiance[c];
        image.radiance[k][c] += rho[c] * lit.irradiance[c];
      }
      all.push_back(std::move(lit));
    }
  }
  const auto size = static_cast<int>(model.parameters().size());
  Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(size, kChannels * pixels);
  for (const Lit& lit : all) {
    for (int c = 0; c < kChannels; ++c) {
      SampleDerivatives::Visit(model, lit.at, c, [&](int k, double derivative) {
        seen(k, kChannels * lit.pixel + c) += lit.irradiance[c] * derivative;
      });
    }
  }
  const double exposure = CompareSpheres(image, image).exposure;
  for (int k = 0; k < pixels; ++k) {
    Rgb exposed = image.radiance[k];
    for (double& x : exposed) x = std::min(exposure * x, 1.0);
    auto of_pixel = seen.middleCols<kChannels>(kChannels * k);
    of_pixel = (of_pixel * (exposure * LabDerivatives(exposed).transpose())).eval();
  }
  return seen;
}

// Scales what each pixel shows by 1 / sqrt(2 sigma), sigma^2 its variance.
void CountAsDeltaE(Eigen::MatrixXd* seen) {
  for (Eigen::Index first = 0; first < seen->cols(); first += kChannels) {
    auto of_pixel = seen->middleCols<kChannels>(first);
    const double deviation = of_pixel.norm();
    if (deviation > 0) of_pixel /= std::sqrt(2 * deviation);
  }
}

}  // namespace

GreedyDesign SeenDesign(const FitProblem& problem, const FactorModel& model,
                        std::span<const SphericalAngles> directions,
                        const AppearanceOptions& appearance) {
  const double residual_square = ResidualSquare(problem.data, model);
  const Eigen::LLT<Eigen::MatrixXd> information = Information(problem, model, residual_square);
  Eigen::MatrixXd reads = ReadsOf(directions, problem.data, model, residual_square);
  Eigen::MatrixXd seen = SeenOf(model, appearance);
  information.matrixL().solveInPlace(reads);
  information.matrixL().solveInPlace(seen);
  CountAsDeltaE(&seen);
  return {reads.transpose(), seen.transpose()};
}

}  // namespace trilobe
