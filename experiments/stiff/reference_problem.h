#ifndef TRILOBE_EXPERIMENTS_STIFF_REFERENCE_PROBLEM_H_
#define TRILOBE_EXPERIMENTS_STIFF_REFERENCE_PROBLEM_H_

#include <Eigen/Core>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/brdf/brdf_samples.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// Fifty decimal digits: the square of a condition number of 1e15 leaves twenty of them.
using Big = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                          boost::multiprecision::et_off>;

}  // namespace trilobe

// Boost's own, of boost/multiprecision/eigen.hpp, lacks what Eigen 3.4 asks for.
template <>
struct Eigen::NumTraits<trilobe::Big> : Eigen::GenericNumTraits<trilobe::Big> {
  enum { RequireInitialization = 1, ReadCost = 10, AddCost = 50, MulCost = 100 };
};

namespace trilobe {

template <typename Real>
using VectorOf = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
template <typename Real>
using MatrixOf = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

// E / 2 near a point, with r = sqrt(w) (rho - rho*) and J = dr/dx. [n], [n x n]
template <typename Real>
struct Derivatives {
  Real objective = 0;       // E
  VectorOf<Real> gradient;  // J'r
  MatrixOf<Real> JtJ;       // lower triangle
  MatrixOf<Real> hessian;   // J'J + sum r d2r/dx2, lower triangle
};

// The objective of docs/method.md and its derivatives, written down from there sample by sample,
// for any real type: from the library come only the measured numbers and the order of the
// parameters (FactorModel::parameters()). Samples are on the grid.
template <typename Real>
class ReferenceProblem {
 public:
  // Throws Error if the samples are scattered, or the weighting is none that it knows.
  ReferenceProblem(const BrdfSamples& samples, const ModelSpec& spec, const std::string& weighting);

  const ModelSpec& spec() const { return spec_; }
  int num_parameters() const { return spec_.num_parameters(); }
  int num_samples() const { return static_cast<int>(samples_.size()); }

  // E, and sum w rho*^2.
  Real Value(const VectorOf<Real>& x) const;
  Real MeasuredEnergy() const;
  Derivatives<Real> Evaluate(const VectorOf<Real>& x) const;

  // Total weight of what reads each parameter; d and s read everything of their channel. [n]
  const VectorOf<Real>& coverage() const { return coverage_; }

  // The canonical form of docs/method.md, unobserved entries filled.
  VectorOf<Real> Canonical(VectorOf<Real> x) const;

 private:
  // A node of G with its weights in G(theta_i) and in G(theta_o).
  struct Node {
    int index = 0;
    Real in_i = 0, in_o = 0;
  };
  struct Sample {
    int h = 0, d = 0;
    std::vector<Node> nodes;
    Real inverse_cosines = 0;
    Real weight[kChannels], rho[kChannels];
  };
  // One lobe's share of a value, s D F G_i G_o / (cos cos), by the factors.
  struct Lobe {
    int s, D, F, G;  // places in x; that of G is its node 0
    Real s_value, D_value, F_value, G_i, G_o;
  };

  static Real Weight(const std::string& name, const Real& rho, const Real& cos_i);
  void ReadSpline(const Real& theta, Real Node::*weight, Sample* sample) const;
  Real NodeAngle(int k) const {
    return (k + Real{0.5}) / spec_.g_axis.size * boost::math::constants::half_pi<Real>();
  }
  Lobe LobeAt(const VectorOf<Real>& x, const Sample& sample, int m, int c) const;
  Real Residual(const VectorOf<Real>& x, const Sample& sample, int c) const;
  void AddCoverage(const Sample& sample);

  ModelSpec spec_;
  FactorModel layout_;
  std::vector<Sample> samples_;
  VectorOf<Real> coverage_;
};

// --- Implementation -----------------------------------------------------------------------------

template <typename Real>
ReferenceProblem<Real>::ReferenceProblem(const BrdfSamples& samples, const ModelSpec& spec,
                                         const std::string& weighting)
    : spec_(spec), layout_(spec), coverage_(VectorOf<Real>::Zero(spec.num_parameters())) {
  using std::acos, std::cos, std::sin;
  if (!samples.on_grid()) {
    throw Error(samples.source + ": the reference works on samples of a grid only");
  }
  const MerlGrid& grid = samples.grid;
  const Real& right_angle = boost::math::constants::half_pi<Real>();
  const Real half{0.5};
  for (int j = 0; j < samples.size(); ++j) {
    const int bin = samples.bins[j];
    Sample sample;
    sample.h = bin / (grid.theta_d * grid.phi_d);
    sample.d = bin / grid.phi_d % grid.theta_d;
    const Real root = (sample.h + half) / grid.theta_h;
    const Real theta_h = root * root * right_angle;
    const Real theta_d = (sample.d + half) / grid.theta_d * right_angle;
    const Real phi_d = (bin % grid.phi_d + half) / grid.phi_d * (2 * right_angle);
    const Real even = cos(theta_h) * cos(theta_d);
    const Real odd = sin(theta_h) * sin(theta_d) * cos(phi_d);
    const Real cos_i = even - odd, cos_o = even + odd;
    ReadSpline(acos(cos_i), &Node::in_i, &sample);
    ReadSpline(acos(cos_o), &Node::in_o, &sample);
    Real splined_i(0), splined_o(0);
    for (const Node& node : sample.nodes) {
      const Real cosine = cos(NodeAngle(node.index));
      splined_i += node.in_i * cosine;
      splined_o += node.in_o * cosine;
    }
    sample.inverse_cosines = 1 / (splined_i * splined_o);
    for (int c = 0; c < kChannels; ++c) {
      sample.rho[c] = samples.rho[j][c];
      sample.weight[c] = Weight(weighting, sample.rho[c], cos_i);
    }
    AddCoverage(sample);
    samples_.push_back(std::move(sample));
  }
}

template <typename Real>
Real ReferenceProblem<Real>::Weight(const std::string& name, const Real& rho, const Real& cos_i) {
  using std::log1p;
  const Real b = rho * cos_i;
  if (name == "uniform") return Real{1};
  if (name == "cosine") return cos_i * cos_i;
  if (name == "percentage") {
    const Real floor = Real{1e-3};  // the double that the library adds
    return 1 / ((rho + floor) * (rho + floor));
  }
  if (name == "log") return cos_i * cos_i / ((1 + b) * (1 + b));
  if (name == "compressive") {
    if (b == 0) return cos_i * cos_i;
    const Real chord = log1p(b) / rho;
    return chord * chord;
  }
  throw Error("the reference has no weighting '" + name + "'");
}

// Catmull-Rom: Hermite's cubics with slopes (f[k+1] - f[k-1]) / 2, one-sided at the ends, constant
// beyond the end nodes.
template <typename Real>
void ReferenceProblem<Real>::ReadSpline(const Real& theta, Real Node::*weight,
                                        Sample* sample) const {
  const int last = spec_.g_axis.size - 1;
  const Real place =
      theta / boost::math::constants::half_pi<Real>() * spec_.g_axis.size - Real{0.5};
  const auto add = [&](int index, const Real& amount) {
    for (Node& node : sample->nodes) {
      if (node.index != index) continue;
      node.*weight += amount;
      return;
    }
    sample->nodes.push_back({.index = index});
    sample->nodes.back().*weight = amount;
  };
  if (place <= 0) return add(0, Real{1});
  if (place >= last) return add(last, Real{1});
  const int k = static_cast<int>(place);
  const Real t = place - k;
  const auto add_slope = [&](int at, const Real& amount) {
    const int before = at == 0 ? 0 : at - 1, after = at == last ? last : at + 1;
    add(after, amount / (after - before));
    add(before, -amount / (after - before));
  };
  add(k, (1 + 2 * t) * (1 - t) * (1 - t));
  add(k + 1, t * t * (3 - 2 * t));
  add_slope(k, t * (1 - t) * (1 - t));
  add_slope(k + 1, t * t * (t - 1));
}

template <typename Real>
void ReferenceProblem<Real>::AddCoverage(const Sample& sample) {
  using std::abs;
  for (int c = 0; c < kChannels; ++c) {
    const Real& w = sample.weight[c];
    coverage_(c) += w;
    for (int m = 0; m < spec_.lobes; ++m) coverage_(kChannels * (1 + m) + c) += w;
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec_.num_tables(factor); ++t) {
        const auto [begin, end] = spec_.channels(factor, t);
        if (c < begin || c >= end) continue;
        const int table = layout_.TableOffset(factor, t);
        if (factor == Factor::kD) coverage_(table + sample.h) += w;
        if (factor == Factor::kF) coverage_(table + sample.d) += w;
        if (factor != Factor::kG) continue;
        for (const Node& node : sample.nodes) {
          coverage_(table + node.index) += w * (abs(node.in_i) + abs(node.in_o));
        }
      }
    }
  }
}

template <typename Real>
typename ReferenceProblem<Real>::Lobe ReferenceProblem<Real>::LobeAt(const VectorOf<Real>& x,
                                                                     const Sample& sample, int m,
                                                                     int c) const {
  const auto table = [&](Factor factor) {
    return layout_.TableOffset(factor, spec_.table(factor, m, c));
  };
  Lobe lobe{.s = kChannels * (1 + m) + c,
            .D = table(Factor::kD) + sample.h,
            .F = table(Factor::kF) + sample.d,
            .G = table(Factor::kG),
            .s_value = 0,
            .D_value = 0,
            .F_value = 0,
            .G_i = 0,
            .G_o = 0};
  lobe.s_value = x(lobe.s);
  lobe.D_value = x(lobe.D);
  lobe.F_value = x(lobe.F);
  for (const Node& node : sample.nodes) {
    lobe.G_i += node.in_i * x(lobe.G + node.index);
    lobe.G_o += node.in_o * x(lobe.G + node.index);
  }
  return lobe;
}

template <typename Real>
Real ReferenceProblem<Real>::Residual(const VectorOf<Real>& x, const Sample& sample, int c) const {
  Real rho = x(c);
  for (int m = 0; m < spec_.lobes; ++m) {
    const Lobe at = LobeAt(x, sample, m, c);
    rho += at.s_value * at.D_value * at.F_value * at.G_i * at.G_o * sample.inverse_cosines;
  }
  return rho - sample.rho[c];
}

template <typename Real>
Real ReferenceProblem<Real>::Value(const VectorOf<Real>& x) const {
  Real sum{0};
  for (const Sample& sample : samples_) {
    for (int c = 0; c < kChannels; ++c) {
      const Real residual = Residual(x, sample, c);
      sum += sample.weight[c] * residual * residual;
    }
  }
  return sum;
}

template <typename Real>
Real ReferenceProblem<Real>::MeasuredEnergy() const {
  return Value(VectorOf<Real>::Zero(num_parameters()));
}

template <typename Real>
Derivatives<Real> ReferenceProblem<Real>::Evaluate(const VectorOf<Real>& x) const {
  const int n = num_parameters();
  Derivatives<Real> at{.gradient = VectorOf<Real>::Zero(n),
                       .JtJ = MatrixOf<Real>::Zero(n, n),
                       .hessian = MatrixOf<Real>::Zero(n, n)};
  MatrixOf<Real> second = MatrixOf<Real>::Zero(n, n);
  std::vector<std::pair<int, Real>> row;  // d rho / dx, a parameter perhaps more than once
  const auto add = [](MatrixOf<Real>* to, int i, int j, const Real& value) {
    if (i >= j) (*to)(i, j) += value;
  };
  for (const Sample& sample : samples_) {
    for (int c = 0; c < kChannels; ++c) {
      const Real& w = sample.weight[c];
      const Real residual = Residual(x, sample, c), w_r = w * residual;
      row.assign(1, {c, Real{1}});
      for (int m = 0; m < spec_.lobes; ++m) {
        const Lobe l = LobeAt(x, sample, m, c);
        const Real K = l.G_i * l.G_o * sample.inverse_cosines;
        const Real a = l.s_value * l.D_value * l.F_value * sample.inverse_cosines;
        const std::pair<int, Real> factors[] = {
            {l.s, l.s_value}, {l.D, l.D_value}, {l.F, l.F_value}};
        for (int p = 0; p < 3; ++p) {
          const Real& q1 = factors[(p + 1) % 3].second;
          const Real& q2 = factors[(p + 2) % 3].second;
          row.emplace_back(factors[p].first, q1 * q2 * K);
          for (int q = 0; q < 3; ++q) {
            if (p != q) {
              add(&second, factors[p].first, factors[q].first, w_r * factors[3 - p - q].second * K);
            }
          }
        }
        for (const Node& k : sample.nodes) {
          const int index = l.G + k.index;
          const Real slope = k.in_i * l.G_o + k.in_o * l.G_i;  // d(G_i G_o)
          row.emplace_back(index, a * slope);
          for (int p = 0; p < 3; ++p) {
            const Real value = w_r * factors[(p + 1) % 3].second * factors[(p + 2) % 3].second *
                               sample.inverse_cosines * slope;
            add(&second, index, factors[p].first, value);
            add(&second, factors[p].first, index, value);
          }
          for (const Node& other : sample.nodes) {
            add(&second, index, l.G + other.index,
                w_r * a * (k.in_i * other.in_o + k.in_o * other.in_i));
          }
        }
      }
      at.objective += w_r * residual;
      for (const auto& [i, J_i] : row) {
        at.gradient(i) += w_r * J_i;
        const Real w_J = w * J_i;
        for (const auto& [j, J_j] : row) add(&at.JtJ, i, j, w_J * J_j);
      }
    }
  }
  at.hessian = at.JtJ + second;
  return at;
}

template <typename Real>
VectorOf<Real> ReferenceProblem<Real>::Canonical(VectorOf<Real> x) const {
  using std::sin;
  const auto fill_unobserved = [&](int begin, int size) {
    const auto observed = [&](int k) { return coverage_(begin + k) > 0; };
    for (int k = 0; k < size; ++k) {
      if (observed(k)) continue;
      int before = k, after = k;
      while (before >= 0 && !observed(before)) --before;
      while (after < size && !observed(after)) ++after;
      if (before < 0 && after == size) return false;
      if (before < 0) {
        x(begin + k) = x(begin + after);
      } else if (after == size) {
        x(begin + k) = x(begin + before);
      } else {
        const Real t = static_cast<Real>(k - before) / (after - before);
        x(begin + k) = (1 - t) * x(begin + before) + t * x(begin + after);
      }
    }
    return true;
  };
  for (const Factor factor : kFactors) {
    const int size = spec_.table_size(factor);
    for (int t = 0; t < spec_.num_tables(factor); ++t) {
      const int begin = layout_.TableOffset(factor, t);
      if (!fill_unobserved(begin, size)) continue;
      VectorOf<Real> measure = coverage_.segment(begin, size);
      Real wanted = measure.sum();
      if (factor == Factor::kD) {
        wanted = 1;
        for (int k = 0; k < size; ++k) {
          const auto sin2_edge = [&](int edge) {
            const Real root = static_cast<Real>(edge) / size;
            const Real sine = sin(root * root * boost::math::constants::half_pi<Real>());
            return static_cast<Real>(sine * sine);
          };
          measure(k) = boost::math::constants::pi<Real>() * (sin2_edge(k + 1) - sin2_edge(k));
        }
      }
      const Real norm = measure.dot(x.segment(begin, size)) / wanted;
      Real gain = factor == Factor::kG ? static_cast<Real>(norm * norm) : norm;
      if (norm > 0) {
        x.segment(begin, size) /= norm;
      } else {
        x.segment(begin, size).setConstant(wanted / measure.sum());
        gain = 0;
      }
      for (int m = 0; m < spec_.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          if (spec_.serves(factor, t, m, c)) x(kChannels * (1 + m) + c) *= gain;
        }
      }
    }
  }
  return x;
}

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_REFERENCE_PROBLEM_H_
