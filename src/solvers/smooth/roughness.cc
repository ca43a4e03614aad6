#include "solvers/smooth/roughness.h"

#include <cmath>

#include "core/algebra/cholesky.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {
namespace {

// Where an entry stands, in units of the paper's 90 bins. Highlights are as wide in the root of
// theta_h wherever they end.
double Place(Factor factor, double theta) {
  const double t = theta / (kPi / 2);
  return 90 * (factor == Factor::kD ? std::sqrt(t) : t);
}

}  // namespace

Roughness::Roughness(const ModelSpec& spec, std::span<const double> coverage, double slope)
    : slope_(slope) {
  const FactorModel model(spec);
  std::vector<int> line;
  std::vector<double> places;
  for (const Factor factor : kFactors) {
    const Axis& axis = spec.axis(factor);
    const int phis = axis.phi_nodes, thetas = axis.size / phis;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const int offset = model.TableOffset(factor, t);
      const auto add = [&](int entry, double place) {
        if (!(coverage[offset + entry] > 0)) return;
        line.push_back(offset + entry);
        places.push_back(place);
      };
      for (int b = 0; b < phis; ++b) {
        line.clear();
        places.clear();
        for (int a = 0; a < thetas; ++a) {
          add(a * phis + b, Place(factor, axis.Theta(a * phis + b)));
        }
        AddLine(line, places, 0, 1.0 / phis);
      }
      if (phis < 3) continue;
      for (int a = 0; a < thetas; ++a) {
        line.clear();
        places.clear();
        for (int b = 0; b < phis; ++b) add(a * phis + b, RadiansToDegrees(axis.Phi(a * phis + b)));
        AddLine(line, places, 360, 1.0 / thetas);
      }
    }
  }
}

void Roughness::AddLine(std::span<const int> parameters, std::span<const double> places,
                        double period, double share) {
  const int n = static_cast<int>(parameters.size());
  if (n < 3) return;
  const bool closed = period > 0;
  for (int k = 0; slope_ > 0 && k < (closed ? n : n - 1); ++k) {
    const int after = (k + 1) % n;
    const double h = places[after] - places[k] + (after == 0 ? period : 0);
    const double weight = std::sqrt(slope_ * share / h);
    differences_.push_back(
        {{parameters[k], parameters[after], parameters[k]}, {-weight, weight, 0}});
  }
  for (int k = closed ? 0 : 1; k < (closed ? n : n - 1); ++k) {
    const int before = (k + n - 1) % n, after = (k + 1) % n;
    const double h1 = places[k] - places[before] + (k == 0 ? period : 0);
    const double h2 = places[after] - places[k] + (k == n - 1 ? period : 0);
    const double width = (h1 + h2) / 2, root = std::sqrt(share * width);
    const double w1 = root / (h1 * width), w2 = root / (h2 * width);
    differences_.push_back(
        {{parameters[before], parameters[k], parameters[after]}, {w1, -(w1 + w2), w2}});
  }
}

double Roughness::operator()(std::span<const double> log_parameters) const {
  double sum = 0;
  for (const Difference& difference : differences_) {
    const double value = difference(log_parameters);
    sum += value * value;
  }
  return sum;
}

void Roughness::AddTo(double factor, std::span<const double> log_parameters,
                      QuadraticModel* at) const {
  const size_t n = at->gradient.size();
  at->objective += factor * (*this)(log_parameters);
  for (const Difference& difference : differences_) {
    const double value = factor * difference(log_parameters);
    for (int a = 0; a < 3; ++a) {
      const int k = difference.parameter[a];
      at->gradient[k] += difference.weight[a] * value;
      for (int b = 0; b < 3; ++b) {
        at->H[k * n + difference.parameter[b]] +=
            factor * difference.weight[a] * difference.weight[b];
      }
    }
  }
}

std::optional<std::vector<double>> Roughness::Interpolated(
    std::span<const int> parameters, std::span<const double> log_parameters) const {
  std::vector<int> place(log_parameters.size(), -1);
  const size_t n = parameters.size();
  for (size_t k = 0; k < n; ++k) place[parameters[k]] = static_cast<int>(k);
  std::vector<double> H(n * n, 0.0), change(n, 0.0);
  for (const Difference& difference : differences_) {
    const double value = difference(log_parameters);
    for (int a = 0; a < 3; ++a) {
      const int k = place[difference.parameter[a]];
      if (k < 0) continue;
      change[k] -= difference.weight[a] * value;
      for (int b = 0; b < 3; ++b) {
        const int l = place[difference.parameter[b]];
        if (l >= 0) H[k * n + l] += difference.weight[a] * difference.weight[b];
      }
    }
  }
  const int size = static_cast<int>(n);
  if (!FactorCholesky(size, H.data(), 1)) return std::nullopt;
  SolveLower(size, H.data(), 1, change.data());
  SolveLowerTransposed(size, H.data(), change.data());
  for (size_t k = 0; k < n; ++k) change[k] += log_parameters[parameters[k]];
  return change;
}

}  // namespace trilobe
