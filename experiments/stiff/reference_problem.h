#ifndef TRILOBE_EXPERIMENTS_STIFF_REFERENCE_PROBLEM_H_
#define TRILOBE_EXPERIMENTS_STIFF_REFERENCE_PROBLEM_H_

#include <Eigen/Core>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
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

// The objective of docs/objective.md and its derivatives, written down from there sample by sample,
// for any real type: from the library come only the measured numbers, the nodes of tables, and the
// order of the parameters (FactorModel::parameters()). Isotropic models see samples on a grid,
// anisotropic ones, D and G over nodes (theta, phi), samples with azimuths.
template <typename Real>
class ReferenceProblem {
 public:
  // Throws Error if the samples are others than those, or the weighting is none that it knows.
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

  // The scale for work inside a fit (docs/file-formats.md), unobserved entries filled.
  VectorOf<Real> Canonical(VectorOf<Real> x) const;

 private:
  // An entry of a table, with its weight in what is read from there.
  struct Entry {
    int index = 0;
    Real weight = 0;
  };
  // A node of G with its weights in G(wi) and in G(wo).
  struct Node {
    int index = 0;
    Real in_i = 0, in_o = 0;
  };
  struct Sample {
    std::vector<Entry> D, F;
    std::vector<Node> nodes;
    Real cos_i = 0, inverse_cosines = 0;
    Real weight[kChannels], rho[kChannels];
  };
  // One lobe's share of a value, s D F G_i G_o / (cos cos), by the factors.
  struct Lobe {
    int s, D, F, G;  // places in x; those of tables are of their entry 0
    Real s_value, D_value, F_value, G_i, G_o;
  };

  Sample InBin(const MerlGrid& grid, int bin) const;
  Sample AtDirections(const SphericalAngles& angles) const;
  static Real Weight(const std::string& name, const Real& rho, const Real& cos_i);
  static void AddToNode(int index, const Real& amount, Real Node::*weight, Sample* sample);
  void ReadSpline(const Real& theta, Real Node::*weight, Sample* sample) const;
  static std::vector<Entry> Between(int lower, int upper, const Real& t);
  static std::vector<Entry> ReadBins(const Real& theta, int size);
  static std::vector<Entry> ReadNodes(const Axis& axis, const Real& theta, const Real& phi);
  Real NodeAngle(int k) const {
    return (k + Real{0.5}) / spec_.g_axis.size * boost::math::constants::half_pi<Real>();
  }
  VectorOf<Real> ProjectedAngles() const;
  bool FillUnobserved(Factor factor, int begin, VectorOf<Real>* x) const;
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
  const bool over_azimuths = spec.d_axis.polar() && spec.g_axis.polar();
  if (over_azimuths ? samples.directions.empty() : spec.anisotropic() || !samples.on_grid()) {
    throw ErrorIn(ErrorKind::kUnsupported, samples.source,
                  "the reference works on a grid, or with D and G over azimuths")
        .About("grid");
  }
  for (int j = 0; j < samples.size(); ++j) {
    Sample sample =
        over_azimuths ? AtDirections(samples.directions[j]) : InBin(samples.grid, samples.bins[j]);
    for (int c = 0; c < kChannels; ++c) {
      sample.rho[c] = samples.rho[j][c];
      sample.weight[c] = Weight(weighting, sample.rho[c], sample.cos_i);
    }
    AddCoverage(sample);
    samples_.push_back(std::move(sample));
  }
}

template <typename Real>
typename ReferenceProblem<Real>::Sample ReferenceProblem<Real>::InBin(const MerlGrid& grid,
                                                                      int bin) const {
  using std::acos, std::cos, std::sin;
  const Real& right_angle = boost::math::constants::half_pi<Real>();
  const Real half{0.5};
  Sample sample;
  const int h = bin / (grid.theta_d * grid.phi_d), d = bin / grid.phi_d % grid.theta_d;
  sample.D = {{h, Real{1}}};
  sample.F = {{d, Real{1}}};
  const Real root = (h + half) / grid.theta_h;
  const Real theta_h = root * root * right_angle;
  const Real theta_d = (d + half) / grid.theta_d * right_angle;
  const Real phi_d = (bin % grid.phi_d + half) / grid.phi_d * (2 * right_angle);
  const Real even = cos(theta_h) * cos(theta_d);
  const Real odd = sin(theta_h) * sin(theta_d) * cos(phi_d);
  const Real cos_o = even + odd;
  sample.cos_i = even - odd;
  ReadSpline(acos(sample.cos_i), &Node::in_i, &sample);
  ReadSpline(acos(cos_o), &Node::in_o, &sample);
  Real splined_i(0), splined_o(0);
  for (const Node& node : sample.nodes) {
    const Real cosine = cos(NodeAngle(node.index));
    splined_i += node.in_i * cosine;
    splined_o += node.in_o * cosine;
  }
  sample.inverse_cosines = 1 / (splined_i * splined_o);
  return sample;
}

template <typename Real>
typename ReferenceProblem<Real>::Sample ReferenceProblem<Real>::AtDirections(
    const SphericalAngles& angles) const {
  using std::atan2, std::cos, std::sin, std::sqrt;
  const Real theta_i(angles.theta_i), phi_i(angles.phi_i);
  const Real theta_o(angles.theta_o), phi_o(angles.phi_o);
  const Real wi[] = {sin(theta_i) * cos(phi_i), sin(theta_i) * sin(phi_i), cos(theta_i)};
  const Real wo[] = {sin(theta_o) * cos(phi_o), sin(theta_o) * sin(phi_o), cos(theta_o)};
  Real sum[3], square_of_sum(0), square_of_difference(0);
  for (int k = 0; k < 3; ++k) {
    sum[k] = wi[k] + wo[k];
    square_of_sum += sum[k] * sum[k];
    square_of_difference += (wi[k] - wo[k]) * (wi[k] - wo[k]);
  }
  const Real across = sqrt(static_cast<Real>(sum[0] * sum[0] + sum[1] * sum[1]));
  const Real theta_h = atan2(across, sum[2]);
  const Real phi_h = theta_h > Real{1e-9} ? static_cast<Real>(atan2(sum[1], sum[0])) : Real{0};
  // |wi - wo| = 2 sin theta_d, |wi + wo| = 2 cos theta_d.
  const Real theta_d =
      atan2(static_cast<Real>(sqrt(square_of_difference)), static_cast<Real>(sqrt(square_of_sum)));
  Sample sample;
  sample.D = ReadNodes(spec_.d_axis, theta_h, phi_h);
  sample.F = ReadBins(theta_d, spec_.f_axis.size);
  for (const auto& [index, weight] : ReadNodes(spec_.g_axis, theta_i, phi_i)) {
    AddToNode(index, weight, &Node::in_i, &sample);
  }
  for (const auto& [index, weight] : ReadNodes(spec_.g_axis, theta_o, phi_o)) {
    AddToNode(index, weight, &Node::in_o, &sample);
  }
  sample.cos_i = wi[2];
  sample.inverse_cosines = 1 / (wi[2] * wo[2]);
  return sample;
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
  throw Error(ErrorKind::kUnknown, "the reference has no weighting '" + name + "'")
      .About("weighting", name);
}

template <typename Real>
void ReferenceProblem<Real>::AddToNode(int index, const Real& amount, Real Node::*weight,
                                       Sample* sample) {
  for (Node& node : sample->nodes) {
    if (node.index != index) continue;
    node.*weight += amount;
    return;
  }
  sample->nodes.push_back({.index = index});
  sample->nodes.back().*weight = amount;
}

// Catmull-Rom: Hermite's cubics with slopes (f[k+1] - f[k-1]) / 2, one-sided at the ends, constant
// beyond the end nodes.
template <typename Real>
void ReferenceProblem<Real>::ReadSpline(const Real& theta, Real Node::*weight,
                                        Sample* sample) const {
  const int last = spec_.g_axis.size - 1;
  const Real place =
      theta / boost::math::constants::half_pi<Real>() * spec_.g_axis.size - Real{0.5};
  const auto add = [&](int index, const Real& amount) { AddToNode(index, amount, weight, sample); };
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

// Linear between two entries; what is within 1e-9 of the way from one of them stands at it.
template <typename Real>
std::vector<typename ReferenceProblem<Real>::Entry> ReferenceProblem<Real>::Between(int lower,
                                                                                    int upper,
                                                                                    const Real& t) {
  const Real near{1e-9};
  if (t < near) return {{lower, Real{1}}};
  if (t > 1 - near) return {{upper, Real{1}}};
  return {{lower, 1 - t}, {upper, t}};
}

// Bins of equal width in theta: linear between their centres, constant beyond the outer ones.
template <typename Real>
std::vector<typename ReferenceProblem<Real>::Entry> ReferenceProblem<Real>::ReadBins(
    const Real& theta, int size) {
  const Real place = theta / boost::math::constants::half_pi<Real>() * size - Real{0.5};
  if (place <= 0) return {{0, Real{1}}};
  if (place >= size - 1) return {{size - 1, Real{1}}};
  const int k = static_cast<int>(place);
  return Between(k, k + 1, place - k);
}

// Bilinear between nodes (theta, phi), constant beyond the first and the last theta.
template <typename Real>
std::vector<typename ReferenceProblem<Real>::Entry> ReferenceProblem<Real>::ReadNodes(
    const Axis& axis, const Real& theta, const Real& phi) {
  using std::floor;
  const int last = static_cast<int>(axis.theta.size()) - 1, columns = axis.phi_nodes;
  const Real degrees = theta * 90 / boost::math::constants::half_pi<Real>();
  int a = 0;
  while (a < last && degrees >= axis.theta[a + 1]) ++a;
  const bool inside = a < last && degrees > axis.theta[a];
  const std::vector<Entry> rings =
      inside ? Between(a, a + 1,
                       static_cast<Real>((degrees - axis.theta[a]) /
                                         (Real{axis.theta[a + 1]} - Real{axis.theta[a]})))
             : Between(a, a, Real{0});
  const Real turns = phi / (4 * boost::math::constants::half_pi<Real>());
  const Real place = (turns - floor(turns)) * columns;
  const int b = static_cast<int>(place);
  std::vector<Entry> entries;
  for (const Entry& ring : rings) {
    for (const Entry& column :
         Between(b % columns, (b + 1) % columns, static_cast<Real>(place - b))) {
      entries.push_back({ring.index * columns + column.index, ring.weight * column.weight});
    }
  }
  return entries;
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
        if (factor == Factor::kG) {
          for (const Node& node : sample.nodes) {
            coverage_(table + node.index) += w * (abs(node.in_i) + abs(node.in_o));
          }
          continue;
        }
        for (const Entry& entry : factor == Factor::kD ? sample.D : sample.F) {
          coverage_(table + entry.index) += w * entry.weight;
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
            .D = table(Factor::kD),
            .F = table(Factor::kF),
            .G = table(Factor::kG),
            .s_value = 0,
            .D_value = 0,
            .F_value = 0,
            .G_i = 0,
            .G_o = 0};
  lobe.s_value = x(lobe.s);
  for (const Entry& entry : sample.D) lobe.D_value += entry.weight * x(lobe.D + entry.index);
  for (const Entry& entry : sample.F) lobe.F_value += entry.weight * x(lobe.F + entry.index);
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
  const std::vector<Entry> kItself = {{0, Real{1}}};
  const auto add = [](MatrixOf<Real>* target, int i, int j, const Real& value) {
    if (i >= j) (*target)(i, j) += value;
  };
  for (const Sample& sample : samples_) {
    for (int c = 0; c < kChannels; ++c) {
      const Real& w = sample.weight[c];
      const Real residual = Residual(x, sample, c), w_r = w * residual;
      row.assign(1, {c, Real{1}});
      for (int m = 0; m < spec_.lobes; ++m) {
        const Lobe l = LobeAt(x, sample, m, c);
        const Real K = l.G_i * l.G_o * sample.inverse_cosines;
        const Real of_G = l.s_value * l.D_value * l.F_value * sample.inverse_cosines;
        const struct {
          int begin;
          const Real& value;
          const std::vector<Entry>& entries;
        } factors[] = {
            {l.s, l.s_value, kItself}, {l.D, l.D_value, sample.D}, {l.F, l.F_value, sample.F}};
        for (int p = 0; p < 3; ++p) {
          const Real of_others = factors[(p + 1) % 3].value * factors[(p + 2) % 3].value;
          for (const Entry& a : factors[p].entries) {
            row.emplace_back(factors[p].begin + a.index, a.weight * of_others * K);
            for (int q = 0; q < 3; ++q) {
              if (p == q) continue;
              const Real w_r_third = w_r * a.weight * factors[3 - p - q].value * K;
              for (const Entry& b : factors[q].entries) {
                add(&second, factors[p].begin + a.index, factors[q].begin + b.index,
                    w_r_third * b.weight);
              }
            }
          }
        }
        for (const Node& k : sample.nodes) {
          const int index = l.G + k.index;
          const Real slope = k.in_i * l.G_o + k.in_o * l.G_i;  // d(G_i G_o)
          row.emplace_back(index, of_G * slope);
          for (int p = 0; p < 3; ++p) {
            const Real of_others = w_r * factors[(p + 1) % 3].value * factors[(p + 2) % 3].value *
                                   sample.inverse_cosines * slope;
            for (const Entry& a : factors[p].entries) {
              const Real value = of_others * a.weight;
              add(&second, index, factors[p].begin + a.index, value);
              add(&second, factors[p].begin + a.index, index, value);
            }
          }
          for (const Node& other : sample.nodes) {
            add(&second, index, l.G + other.index,
                w_r * of_G * (k.in_i * other.in_o + k.in_o * other.in_i));
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

// Solid angle that each entry of D stands for, projected on the surface.
template <typename Real>
VectorOf<Real> ReferenceProblem<Real>::ProjectedAngles() const {
  using std::sin;
  const Axis& axis = spec_.d_axis;
  const Real& right_angle = boost::math::constants::half_pi<Real>();
  const auto sin2 = [](const Real& angle) {
    const Real sine = sin(angle);
    return static_cast<Real>(sine * sine);
  };
  VectorOf<Real> result(axis.size);
  for (int k = 0; k < axis.size; ++k) {
    if (!axis.polar()) {
      const auto edge = [&](int bin) {
        const Real root = static_cast<Real>(bin) / axis.size;
        return static_cast<Real>(root * root * right_angle);
      };
      result(k) = 2 * right_angle * (sin2(edge(k + 1)) - sin2(edge(k)));
      continue;
    }
    // A ring reaches halfway to the one before and to the one after; the last is as wide on both
    // sides.
    const std::vector<double>& theta = axis.theta;
    const int a = k / axis.phi_nodes, last = static_cast<int>(theta.size()) - 1;
    const Real before = (Real{theta[a]} - theta[a > 0 ? a - 1 : 0]) / 2;
    const Real after = a < last ? (Real{theta[a + 1]} - theta[a]) / 2 : before;
    const Real degree = right_angle / 90, end = theta[a] + after;
    const Real upper = (end < 90 ? end : Real{90}) * degree;
    const Real lower = (theta[a] - before) * degree;
    result(k) = 2 * right_angle / axis.phi_nodes * (sin2(upper) - sin2(lower));
  }
  return result;
}

// Entries that no data touch: linear between those that some do, along theta, or around the ring
// of a theta; beyond the last one as that. A ring without any is as the one inside it, or else the
// one outside it. False where no entry of the table is touched.
template <typename Real>
bool ReferenceProblem<Real>::FillUnobserved(Factor factor, int begin, VectorOf<Real>* x) const {
  const Axis& axis = spec_.axis(factor);
  const int columns = axis.polar() ? axis.phi_nodes : axis.size, rings = axis.size / columns;
  std::vector<bool> filled(rings, false);
  for (int a = 0; a < rings; ++a) {
    const int ring = begin + a * columns;
    // Index of entry k in its ring, which wraps around; without azimuths negative beyond an end.
    const auto place = [&](int k) {
      return axis.polar() ? (k + columns) % columns : k < columns ? k : -1;
    };
    const auto observed = [&](int k) { return coverage_(ring + k) > 0; };
    // The distance to the next observed entry that way; 0 where there is none.
    const auto distance = [&](int k, int way) {
      for (int steps = 1; steps < columns; ++steps) {
        const int at = place(k + way * steps);
        if (at < 0) return 0;
        if (observed(at)) return steps;
      }
      return 0;
    };
    for (int k = 0; k < columns; ++k) {
      if (observed(k)) {
        filled[a] = true;
        continue;
      }
      const int back = distance(k, -1), forth = distance(k, 1);
      if (back == 0 && forth == 0) break;
      const Real before = back > 0 ? (*x)(ring + place(k - back)) : Real{0};
      const Real after = forth > 0 ? (*x)(ring + place(k + forth)) : Real{0};
      const Real t = back == 0    ? Real{1}
                     : forth == 0 ? Real{0}
                                  : static_cast<Real>(back) / (back + forth);
      (*x)(ring + k) = (1 - t) * before + t * after;
    }
  }
  const auto copy = [&](int from, int target) {
    if (from < 0 || from >= rings || !filled[from] || filled[target]) return;
    for (int k = 0; k < columns; ++k) {
      (*x)(begin + target * columns + k) = (*x)(begin + from * columns + k);
    }
    filled[target] = true;
  };
  for (int a = 1; a < rings; ++a) copy(a - 1, a);
  for (int a = rings - 2; a >= 0; --a) copy(a + 1, a);
  return filled[0];
}

template <typename Real>
VectorOf<Real> ReferenceProblem<Real>::Canonical(VectorOf<Real> x) const {
  for (const Factor factor : kFactors) {
    const int size = spec_.table_size(factor);
    for (int t = 0; t < spec_.num_tables(factor); ++t) {
      const int begin = layout_.TableOffset(factor, t);
      if (!FillUnobserved(factor, begin, &x)) continue;
      VectorOf<Real> measure = coverage_.segment(begin, size);
      Real wanted = measure.sum();
      if (factor == Factor::kD) {
        wanted = 1;
        measure = ProjectedAngles();
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
