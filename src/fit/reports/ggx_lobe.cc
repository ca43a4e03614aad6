#include "fit/reports/ggx_lobe.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/text.h"
#include "model/measurement/albedo_rule.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

// A node of a rule over the hemisphere of facets, and what stands there.
struct FacetNode {
  double x, y, z;   // its normal
  double weight;    // cos theta_h d omega
  double observed;  // D, of facets that add up to 1
};

// log alpha along and across, and the turn between.
constexpr int kIsotropic = 1, kAnisotropic = 3;
constexpr double kLeastAlpha = 1e-3;

// D of GGX at a normal that is turned into the frame of the two roughnesses.
template <typename T>
T Distribution(const FacetNode& node, const T& alpha_x, const T& alpha_y, const T& turn) {
  using std::cos;
  using std::sin;
  const T c = cos(turn), s = sin(turn);
  const T x = (c * node.x + s * node.y) / alpha_x, y = (c * node.y - s * node.x) / alpha_y;
  const T q = x * x + y * y + node.z * node.z;
  return 1.0 / (kPi * alpha_x * alpha_y * q * q);
}

struct DistributionCost {
  const std::vector<FacetNode>& nodes;
  int size;  // of the parameters

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    using std::exp;
    using std::sqrt;
    const T* const p = parameters[0];
    const T alpha_x = exp(p[0]), alpha_y = size == kIsotropic ? alpha_x : exp(p[1]);
    const T turn = size == kIsotropic ? T{0.0} : p[2];
    for (size_t k = 0; k < nodes.size(); ++k) {
      const FacetNode& node = nodes[k];
      residuals[k] = std::sqrt(node.weight) *
                     (sqrt(Distribution(node, alpha_x, alpha_y, turn)) - std::sqrt(node.observed));
    }
    return true;
  }
};

// Nodes by the rule of DirectionalAlbedo, with D of the lobe; none if it has no facets.
std::vector<FacetNode> FacetsOf(const FactorModel& model, int lobe) {
  constexpr int kAzimuths = 72;
  const ModelSpec& spec = model.spec();
  const HalfAngleNodes rule;
  const int azimuths = spec.anisotropic() ? kAzimuths : 1;
  std::vector<FacetNode> nodes;
  double total = 0;
  for (int bin = 0; bin < rule.grid.theta_h; ++bin) {
    const double width = rule.edges[bin + 1] - rule.edges[bin];
    for (int half = 0; half < 2; ++half) {
      const double theta = HalfAngleNode(half, rule.edges[bin], width);
      for (int k = 0; k < azimuths; ++k) {
        const double phi = 2 * kPi * (k + 0.5) / azimuths;
        const Stencil at = spec.d_axis.At(theta, phi);
        const double sine = std::sin(theta), cosine = std::cos(theta);
        double D = 0;
        for (int c = 0; c < kChannels; ++c) D += std::max(at(model.D(lobe, c)), 0.0) / kChannels;
        const double weight = cosine * sine * width / 2 * 2 * kPi / azimuths;
        nodes.push_back({sine * std::cos(phi), sine * std::sin(phi), cosine, weight, D});
        total += weight * D;
      }
    }
  }
  if (!(total > 0 && std::isfinite(total))) return {};
  for (FacetNode& node : nodes) node.observed /= total;
  return nodes;
}

// The least of the cost, from a start.
double Minimize(const std::vector<FacetNode>& nodes, std::vector<double>* x) {
  ceres::Problem problem;
  const int size = static_cast<int>(x->size());
  auto* const cost = new ceres::DynamicAutoDiffCostFunction<DistributionCost, kAnisotropic>(
      new DistributionCost{nodes, size});
  cost->AddParameterBlock(size);
  cost->SetNumResiduals(static_cast<int>(nodes.size()));
  problem.AddResidualBlock(cost, nullptr, x->data());
  for (int k = 0; k < std::min(size, 2); ++k) {
    problem.SetParameterLowerBound(x->data(), k, std::log(kLeastAlpha));
    problem.SetParameterUpperBound(x->data(), k, 0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

// The light of the lobe from the normal, and that of GGX with F = 1 and with F = (1 - cos)^5.
struct FromNormal {
  Rgb lobe{};
  double whole = 0, rise = 0;
};

FromNormal LightFromNormal(const FactorModel& model, int lobe, const GgxLobe& ggx) {
  const PreparedModel<double> prepared(model);
  std::vector<Rgb> values(model.spec().lobes);
  const int azimuths = model.spec().anisotropic() ? 72 : 1;
  const double c = std::cos(ggx.turn), s = std::sin(ggx.turn);
  FromNormal light;
  VisitReflected(0, azimuths, [&](const DirectionPair& pair, double weight) {
    prepared.LobeValues(pair.wi, pair.wo, values.data());
    for (int channel = 0; channel < kChannels; ++channel) {
      light.lobe[channel] += weight * values[lobe][channel];
    }
    const Direction& wo = pair.wo;
    const double cosine = std::sqrt((1 + wo[2]) / 2);  // of theta_h, and of theta_d
    const FacetNode half = {wo[0] / (2 * cosine), wo[1] / (2 * cosine), cosine, 0, 0};
    // Smith's term of both directions over 4 cos cos, where the first is the normal.
    const double x = ggx.alpha_x * (c * wo[0] + s * wo[1]);
    const double y = ggx.alpha_y * (c * wo[1] - s * wo[0]);
    const double shadow = 0.5 / (wo[2] + std::hypot(x, y, wo[2]));
    const double value = weight * shadow * Distribution(half, ggx.alpha_x, ggx.alpha_y, ggx.turn);
    light.whole += value;
    light.rise += value * std::pow(1 - cosine, 5);
  });
  return light;
}

}  // namespace

std::optional<GgxLobe> NearestGgx(const FactorModel& model, int lobe) {
  const std::vector<FacetNode> nodes = FacetsOf(model, lobe);
  if (nodes.empty() || std::ranges::max(model.s(lobe)) <= 0) return std::nullopt;
  std::vector<std::vector<double>> starts;
  for (const double alpha : {0.02, 0.1, 0.4}) {
    if (!model.spec().anisotropic()) {
      starts.push_back({std::log(alpha)});
      continue;
    }
    for (const double turn : {0.0, kPi / 4, kPi / 2, 3 * kPi / 4}) {
      starts.push_back({std::log(alpha / 2), std::log(alpha), turn});
    }
  }
  double least = std::numeric_limits<double>::infinity();
  GgxLobe ggx;
  for (std::vector<double>& x : starts) {
    const double cost = Minimize(nodes, &x);
    if (!(cost < least)) continue;
    least = cost;
    ggx.alpha_x = ggx.alpha_y = std::exp(x[0]);
    if (x.size() == kIsotropic) continue;
    ggx.alpha_y = std::exp(x[1]);
    ggx.turn = std::remainder(x[2], kPi);
  }
  for (const FacetNode& node : nodes) {
    const double D = Distribution(node, ggx.alpha_x, ggx.alpha_y, ggx.turn);
    ggx.elsewhere += node.weight * std::abs(D - node.observed) / 2;
  }
  ggx.elsewhere = std::min(ggx.elsewhere, 1.0);
  const FromNormal light = LightFromNormal(model, lobe, ggx);
  for (int c = 0; c < kChannels; ++c) {
    ggx.f0[c] = std::max((light.lobe[c] - light.rise) / (light.whole - light.rise), 0.0);
  }
  return ggx;
}

std::string GgxText(const GgxLobe& lobe) {
  const auto of = [](double alpha) {
    return Text(alpha, 3) + " (roughness " + Text(std::sqrt(alpha), 3) + ")";
  };
  std::string text = "alpha " + of(lobe.alpha_x);
  if (lobe.alpha_y != lobe.alpha_x) {
    text += " along " + Text(std::round(RadiansToDegrees(lobe.turn)) + 0.0, 3) + " deg, " +
            of(lobe.alpha_y) + " across";
  }
  return text + ", F0 " + Text(lobe.f0[0], 3) + ", " + Text(lobe.f0[1], 3) + ", " +
         Text(lobe.f0[2], 3) +
         (std::ranges::max(lobe.f0) > 1 ? ", above 1 as of no such lobe; " : "; ") +
         Text(100 * lobe.elsewhere, 2) + " % of its facets stand elsewhere";
}

}  // namespace trilobe
