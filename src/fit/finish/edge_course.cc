#include "fit/finish/edge_course.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/robust_line.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/axis.h"

namespace trilobe {
namespace {

// A line through the last finite values, which levels off beyond them.
struct Continuation {
  RobustLine line;
  double from = 0;

  double operator()(double theta) const { return LevelledOff(line, from, theta); }
};

enum class Through { kAll, kLast };  // the middle of all values, or the last one

std::optional<Continuation> ContinuationOf(std::span<const double> theta,
                                           std::span<const double> values, size_t most,
                                           Through through) {
  constexpr size_t kFewest = 3;
  std::vector<double> x, y;
  for (size_t k = values.size() - std::min(most, values.size()); k < values.size(); ++k) {
    if (!std::isfinite(values[k])) continue;
    x.push_back(theta[k]);
    y.push_back(values[k]);
  }
  if (x.size() < kFewest) return std::nullopt;
  Continuation on{.line = FitRobustLine(x, y), .from = x.back()};
  if (through == Through::kLast) on.line.at_zero += y.back() - on.line(x.back());
  return on;
}

constexpr size_t kLine = 10;  // entries

std::vector<double> ThetasUpTo(double from, const Axis& axis) {
  std::vector<double> theta;
  while (std::ssize(theta) < axis.size && axis.Theta(static_cast<int>(theta.size())) <= from) {
    theta.push_back(axis.Theta(static_cast<int>(theta.size())));
  }
  return theta;
}

// phi of a lobe at the centres of the bins of F, which go on beyond the angle. [f_axis.size]
std::optional<std::vector<double>> HalfLogF(double from, const FactorModel& model, int lobe) {
  constexpr size_t kLast = 3;
  const Axis& axis = model.spec().f_axis;
  const std::vector<double> theta = ThetasUpTo(from, axis);
  std::vector<double> phi;
  for (size_t k = 0; k < theta.size(); ++k) {
    double sum = 0;
    for (int c = 0; c < kChannels; ++c) sum += std::log(model.F(lobe, c)[k]);
    phi.push_back(sum / (2 * kChannels));
  }
  const auto on = ContinuationOf(theta, phi, kLast, Through::kLast);
  if (!on) return std::nullopt;
  for (int k = static_cast<int>(phi.size()); k < axis.size; ++k) {
    phi.push_back((*on)(axis.Theta(k)));
  }
  return phi;
}

void ContinueF(double from, const std::vector<double>& phi, const Axis& axis, std::span<double> F) {
  const std::vector<double> theta = ThetasUpTo(from, axis);
  std::vector<double> ratio;
  for (size_t k = 0; k < theta.size(); ++k) ratio.push_back(std::log(F[k]) - 2 * phi[k]);
  const auto on = ContinuationOf(theta, ratio, kLine, Through::kAll);
  for (int k = static_cast<int>(theta.size()); on && k < axis.size; ++k) {
    F[k] = std::exp((*on)(axis.Theta(k)) + 2 * phi[k]);
  }
}

void ContinueG(double from, const std::vector<double>& phi_of_bins, const Axis& axis,
               std::span<double> G) {
  const auto bins = static_cast<double>(phi_of_bins.size());
  const auto phi = [&](double theta) {
    const double place = std::clamp(theta / (kPi / 2) * bins - 0.5, 0.0, bins - 1);
    const size_t k = std::min(static_cast<size_t>(place), phi_of_bins.size() - 2);
    return std::lerp(phi_of_bins[k], phi_of_bins[k + 1], place - static_cast<double>(k));
  };
  const std::vector<double> theta = ThetasUpTo(from, axis);
  std::vector<double> together;
  for (size_t k = 0; k < theta.size(); ++k) {
    together.push_back(std::log(G[k] / std::cos(theta[k])) + phi(theta[k]));
  }
  const auto on = ContinuationOf(theta, together, kLine, Through::kAll);
  for (int k = static_cast<int>(theta.size()); on && k < axis.size; ++k) {
    const double at = axis.Theta(k);
    G[k] = std::cos(at) * std::exp((*on)(at)-phi(at));
  }
}

constexpr double kStep = DegreesToRadians(0.5);
constexpr int kFirstStep = 100, kLastStep = 179, kFirstOfCourse = 128;  // 50, 89.5 and 64 degrees

// The course of albedos, which are at AnglesOfCourse(), at each half degree from 64 degrees.
std::vector<Rgb> CourseOf(double around, const std::vector<Rgb>& albedos) {
  constexpr double kBlack = 1e-300;
  const int wide = static_cast<int>(2 * around);
  std::vector<Rgb> course;
  for (int k = kFirstOfCourse; k <= kLastStep; ++k) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), g = H;  // a column a channel
    for (int j = std::max(k - wide, kFirstStep); j <= std::min(k + wide, kLastStep); ++j) {
      const double t = static_cast<double>(j - k) / (wide + 1);
      const double weight = std::pow(1 - std::pow(std::abs(t), 3), 3);
      const Eigen::Vector3d powers{1, t, t * t};
      H += weight * powers * powers.transpose();
      for (int c = 0; c < kChannels; ++c) {
        const double albedo = std::max(albedos[j - kFirstStep][c], kBlack);
        g.col(c) += weight * std::log(albedo) * powers;
      }
    }
    const Eigen::Vector3d at = H.ldlt().solve(g).row(0);
    course.push_back({std::exp(at[0]), std::exp(at[1]), std::exp(at[2])});
  }
  return course;
}

// Logarithms of factors at each half degree from 64 degrees.
struct Factors {
  std::vector<double> common;                         // of all channels, the mean
  std::array<std::vector<double>, kChannels> colour;  // beside it
};

// By how much the light of the lobes is short of the course.
Factors FactorsTo(const std::vector<Rgb>& course, const std::vector<Rgb>& albedos,
                  const FactorModel& model) {
  constexpr double kMost = 2;
  Factors factors;
  for (size_t k = 0; k < course.size(); ++k) {
    Rgb logs{};
    for (int c = 0; c < kChannels; ++c) {
      const double diffuse = kPi * model.d()[c], of_lobes = albedos[k][c] - diffuse;
      if (!(of_lobes > 0)) continue;
      logs[c] = std::log(std::clamp((course[k][c] - diffuse) / of_lobes, 1 / kMost, kMost));
    }
    factors.common.push_back((logs[0] + logs[1] + logs[2]) / kChannels);
    for (int c = 0; c < kChannels; ++c) {
      factors.colour[c].push_back(logs[c] - factors.common.back());
    }
  }
  return factors;
}

// Multiplies entries from 64 degrees on by powers of factors, whose logarithms are linear between.
void Scale(const std::vector<double>& logs, double power, const Axis& axis,
           std::span<double> table) {
  for (int k = 0; k < axis.size; ++k) {
    const double place = axis.Theta(k) / kStep - kFirstOfCourse;
    if (place < 0) continue;
    const size_t j = std::min(static_cast<size_t>(place), logs.size() - 2);
    const double t = std::min(place - static_cast<double>(j), 1.0);
    table[k] *= std::exp(power * std::lerp(logs[j], logs[j + 1], t));
  }
}

}  // namespace

void ContinueTogether(double from, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  const FactorModel before = *model;
  for (int m = 0; m < spec.lobes; ++m) {
    const std::optional<std::vector<double>> phi = HalfLogF(from, before, m);
    if (!phi) continue;
    for (int c = 0; c < kChannels; ++c) {
      const auto is_first = [&](Factor factor) {
        const int t = spec.table(factor, m, c);
        return (c == 0 || spec.table(factor, m, c - 1) != t) &&
               (m == 0 || spec.table(factor, m - 1, c) != t);
      };
      if (is_first(Factor::kF)) {
        ContinueF(from, *phi, spec.f_axis, model->table(Factor::kF, spec.table(Factor::kF, m, c)));
      }
      if (is_first(Factor::kG)) {
        ContinueG(from, *phi, spec.g_axis, model->table(Factor::kG, spec.table(Factor::kG, m, c)));
      }
    }
  }
}

std::vector<double> AnglesOfCourse() {
  std::vector<double> theta;
  for (int k = kFirstStep; k <= kLastStep; ++k) theta.push_back(k * kStep);
  return theta;
}

void FollowCourse(double around, const TableLayout& layout, const FactoredAlbedos& albedos,
                  FactorModel* model) {
  constexpr int kPasses = 5;
  const ModelSpec& spec = model->spec();
  const std::vector<Rgb> course = CourseOf(around, albedos(*model));
  for (int pass = 0; pass < kPasses; ++pass) {
    const Factors factors = FactorsTo(course, albedos(*model, kFirstOfCourse - kFirstStep), *model);
    for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
      Scale(factors.common, 0.5, spec.g_axis, model->table(Factor::kG, t));
    }
    for (int c = 0; c < kChannels && spec.F.per_channel; ++c) {
      for (int m = 0; m < (spec.F.per_lobe ? spec.lobes : 1); ++m) {
        const int t = spec.table(Factor::kF, m, c);
        Scale(factors.colour[c], 1, spec.f_axis, model->table(Factor::kF, t));
      }
    }
    ExpandStored(layout, model);
  }
}

}  // namespace trilobe
