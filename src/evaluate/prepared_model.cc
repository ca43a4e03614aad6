#include "trilobe/evaluate/prepared_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "trilobe/math/angles.h"
#include "trilobe/math/arc_cosine.h"

namespace trilobe {
namespace {

template <typename Real>
constexpr Real kRightAngles = static_cast<Real>(2 / kPi);  // of an angle in radians

}  // namespace

template <typename Real>
PreparedModel<Real>::PreparedModel(const FactorModel& model)
    : lobes_(model.spec().lobes),
      stretches_(model.spec().stretches.distinct()),
      stretched_(model.spec().stretches.any()),
      d_axis_(model.spec().d_axis),
      f_axis_(model.spec().f_axis),
      g_axis_(model.spec().g_axis) {
  CheckParameters(model);
  const ModelSpec& spec = model.spec();
  for (int c = 0; c < kChannels; ++c) diffuse_[c] = static_cast<Real>(model.d()[c]);
  for (int m = 0; m < lobes_; ++m) {
    Colour& s = specular_.emplace_back();
    for (int c = 0; c < kChannels; ++c) {
      s[c] = static_cast<Real>(model.s(m)[c]);
      table_.push_back({spec.table(Factor::kD, m, c), spec.table(Factor::kF, m, c),
                        spec.table(Factor::kG, m, c)});
    }
  }
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    stretch_of_.push_back(spec.StretchOfTable(t));
  }
  d_ = TablesOf(model, Factor::kD);
  f_ = TablesOf(model, Factor::kF);
  g_ = TablesOf(model, Factor::kG);
  if (g_axis_.rule == Axis::Rule::kSpline) SetSpline(model);
}

template <typename Real>
typename PreparedModel<Real>::Tables PreparedModel<Real>::TablesOf(const FactorModel& model,
                                                                   Factor factor) const {
  const int count = model.spec().num_tables(factor), size = model.spec().table_size(factor);
  Tables tables{.count = count, .entries = std::vector<Real>(static_cast<size_t>(count) * size)};
  for (int t = 0; t < count; ++t) {
    const std::span<const double> table = model.table(factor, t);
    for (int e = 0; e < size; ++e) tables.entries[e * count + t] = static_cast<Real>(table[e]);
  }
  return tables;
}

template <typename Real>
void PreparedModel<Real>::SetSpline(const FactorModel& model) {
  const CatmullRom spline(g_axis_.size);
  const auto add = [](const std::vector<CatmullRom::Piece>& from, int stride, int offset,
                      std::vector<Piece>* to) {
    for (size_t k = 0; k < from.size(); ++k) {
      const CatmullRom::Piece& piece = from[k];
      (*to)[k * stride + offset] = {static_cast<Real>(piece.f0), static_cast<Real>(piece.f1),
                                    static_cast<Real>(piece.a0), static_cast<Real>(piece.a1)};
    }
  };
  std::vector<double> cosines(spline.nodes());
  for (int k = 0; k < spline.nodes(); ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  cosines_.resize(spline.nodes() - 1);
  add(spline.Pieces(cosines), 1, 0, &cosines_);
  g_pieces_.resize(cosines_.size() * g_.count);
  for (int t = 0; t < g_.count; ++t) {
    add(spline.Pieces(model.table(Factor::kG, t)), g_.count, t, &g_pieces_);
  }
}

// Of bins of unit width, constant beyond the outer centres.
template <typename Real>
typename PreparedModel<Real>::Place PreparedModel<Real>::Linear(Real coordinate, int bins) {
  const Real x = std::min(std::max(coordinate - Real{0.5}, Real{0}), static_cast<Real>(bins - 1));
  const int lower = std::min(static_cast<int>(x), bins - 2);
  return {lower, lower + 1, x - static_cast<Real>(lower)};
}

template <typename Real>
typename PreparedModel<Real>::Place PreparedModel<Real>::PlaceInTheta(const Axis& axis,
                                                                      Real theta) {
  switch (axis.rule) {
    case Axis::Rule::kRootTheta:
      return Linear(static_cast<Real>(axis.size) * std::sqrt(theta * kRightAngles<Real>),
                    axis.size);
    case Axis::Rule::kTheta:
    case Axis::Rule::kSpline:
      return Linear(static_cast<Real>(axis.size) * (theta * kRightAngles<Real>), axis.size);
    case Axis::Rule::kPolar:
      break;
  }
  const int last = static_cast<int>(axis.theta.size()) - 1;
  const Real degrees = theta * static_cast<Real>(180 / kPi);
  int upper = 0;
  while (upper <= last && degrees >= static_cast<Real>(axis.theta[upper])) ++upper;
  if (upper == 0) return {0, 0, 0};
  if (upper > last) return {last, last, 0};
  const Real begin = static_cast<Real>(axis.theta[upper - 1]);
  return {upper - 1, upper, (degrees - begin) / (static_cast<Real>(axis.theta[upper]) - begin)};
}

// A direction within 1e-9 of the normal has the azimuth 0 (HalfVector).
template <typename Real>
typename PreparedModel<Real>::Place PreparedModel<Real>::PlaceInPhi(const Axis& axis,
                                                                    const Vector& direction,
                                                                    Real sin_theta) {
  if (axis.phi_nodes == 1 || !(sin_theta > static_cast<Real>(1e-9))) return {0, 0, 0};
  const Real turns = std::atan2(direction[1], direction[0]) * static_cast<Real>(0.5 / kPi);
  const Real x = (turns < 0 ? turns + 1 : turns) * static_cast<Real>(axis.phi_nodes);
  const int lower = std::min(static_cast<int>(x), axis.phi_nodes - 1);
  return {lower, lower + 1 < axis.phi_nodes ? lower + 1 : 0, x - static_cast<Real>(lower)};
}

template <typename Real>
void PreparedModel<Real>::ReadPolar(const Tables& tables, const Axis& axis, const Vector& direction,
                                    Real theta, Real sin_theta, Real* values) {
  const Place a = PlaceInTheta(axis, theta), b = PlaceInPhi(axis, direction, sin_theta);
  const auto row = [&](int ring, int node) {
    return &tables.entries[static_cast<size_t>(ring * axis.phi_nodes + node) * tables.count];
  };
  const Real* const e00 = row(a.lower, b.lower);
  const Real* const e01 = row(a.lower, b.upper);
  const Real* const e10 = row(a.upper, b.lower);
  const Real* const e11 = row(a.upper, b.upper);
  const Real w00 = (1 - a.t) * (1 - b.t), w01 = (1 - a.t) * b.t;
  const Real w10 = a.t * (1 - b.t), w11 = a.t * b.t;
  for (int t = 0; t < tables.count; ++t) {
    values[t] = w00 * e00[t] + w01 * e01[t] + w10 * e10[t] + w11 * e11[t];
  }
}

template <typename Real>
void PreparedModel<Real>::ReadAt(const Tables& tables, const Place& at, Real* values) {
  const Real* const lower = &tables.entries[static_cast<size_t>(at.lower) * tables.count];
  const Real* const upper = &tables.entries[static_cast<size_t>(at.upper) * tables.count];
  for (int t = 0; t < tables.count; ++t) values[t] = (1 - at.t) * lower[t] + at.t * upper[t];
}

template <typename Real>
void PreparedModel<Real>::ReadD(const Pair& pair, Real* values) const {
  if (d_axis_.polar()) {
    ReadPolar(d_, d_axis_, pair.half, pair.theta_h, std::sqrt(pair.sin2_h), values);
    return;
  }
  if (!stretched_) {
    ReadAt(d_, PlaceInTheta(d_axis_, pair.theta_h), values);
    return;
  }
  // cos theta_o - cos theta_i = 2 sin theta_h sin theta_d cos phi_d.
  const Real twice_sines = 2 * std::sqrt(pair.sin2_h) * SineOf(pair.cos_d);
  const Real cos_phi = twice_sines > 0 ? (pair.wo[2] - pair.wi[2]) / twice_sines : Real{1};
  const Stretch::Place place(
      Stretch::Place::Cosines{pair.cos_d, std::clamp(cos_phi, Real{-1}, Real{1})});
  std::array<Place, kMaxLobes> at;
  for (size_t k = 0; k < stretches_.size(); ++k) {
    at[k] = PlaceInTheta(d_axis_, static_cast<Real>(stretches_[k].ThetaH(pair.theta_h, place)));
  }
  for (int t = 0; t < d_.count; ++t) {
    const Place& of_t = at[stretch_of_[t]];
    values[t] = (1 - of_t.t) * d_.entries[of_t.lower * d_.count + t] +
                of_t.t * d_.entries[of_t.upper * d_.count + t];
  }
}

template <typename Real>
void PreparedModel<Real>::ReadG(const Pair& pair, Real* values) const {
  if (g_axis_.rule == Axis::Rule::kSpline) {
    const Place i = PlaceInTheta(g_axis_, pair.theta_i), o = PlaceInTheta(g_axis_, pair.theta_o);
    const Real scale = 1 / (cosines_[i.lower](i.t) * cosines_[o.lower](o.t));
    const Piece* const piece_i = &g_pieces_[static_cast<size_t>(i.lower) * g_.count];
    const Piece* const piece_o = &g_pieces_[static_cast<size_t>(o.lower) * g_.count];
    for (int t = 0; t < g_.count; ++t) {
      values[t] = piece_i[t](i.t) * piece_o[t](o.t) * scale;
    }
    return;
  }
  const Real cos_i = pair.wi[2], cos_o = pair.wo[2];
  std::array<Real, kMaxLobes * kChannels> at_o;
  ReadPolar(g_, g_axis_, pair.wi, pair.theta_i, SineOf(cos_i), values);
  ReadPolar(g_, g_axis_, pair.wo, pair.theta_o, SineOf(cos_o), at_o.data());
  const Real scale = 1 / std::max(cos_i * cos_o, std::numeric_limits<Real>::min());
  for (int t = 0; t < g_.count; ++t) values[t] *= at_o[t] * scale;
}

template <typename Real>
bool PreparedModel<Real>::Read(const Vector& wi, const Vector& wo, Readings* readings) const {
  if (!(wi[2] > 0 && wo[2] > 0)) return false;
  const Vector sum = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const Real across2 = sum[0] * sum[0] + sum[1] * sum[1];
  const Real length = std::sqrt(across2 + sum[2] * sum[2]);
  // |wi + wo| = 2 cos theta_d.
  if (!(length > 0 && length < 4)) return false;  // not numbers, or nothing like unit vectors
  const Real scale = 1 / length;
  Pair pair{.wi = wi,
            .wo = wo,
            .half = {sum[0] * scale, sum[1] * scale, sum[2] * scale},
            .sin2_h = across2 * scale * scale,
            .cos_d = length / 2};
  // 1 - cos = sin^2 / (1 + cos).
  std::array<Real, 4> angles = {pair.sin2_h / (1 + pair.half[2]), 1 - pair.cos_d, 1 - wi[2],
                                1 - wo[2]};
  for (Real& y : angles) y = std::max(y, Real{0});
  ArcCosinesOfOneMinus(&angles);
  std::tie(pair.theta_h, pair.theta_d, pair.theta_i, pair.theta_o) = std::tuple_cat(angles);
  if (lobes_ == 0) return true;  // no table has entries
  ReadD(pair, readings->D.data());
  ReadAt(f_, PlaceInTheta(f_axis_, pair.theta_d), readings->F.data());
  ReadG(pair, readings->G.data());
  return true;
}

template <typename Real>
typename PreparedModel<Real>::Colour PreparedModel<Real>::Value(const Vector& wi,
                                                                const Vector& wo) const {
  Readings at;
  if (!Read(wi, wo, &at)) return {};
  Colour rho = diffuse_;
  const std::array<int, 3>* table = table_.data();
  for (int m = 0; m < lobes_; ++m) {
    for (int c = 0; c < kChannels; ++c, ++table) {
      const auto [d, f, g] = *table;
      rho[c] += specular_[m][c] * at.D[d] * at.F[f] * at.G[g];
    }
  }
  for (Real& x : rho) x = std::max(x, Real{0});
  return rho;
}

template <typename Real>
void PreparedModel<Real>::LobeValues(const Vector& wi, const Vector& wo, Colour* values) const {
  Readings at;
  const bool above = Read(wi, wo, &at);
  for (int m = 0; m < lobes_; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const auto [d, f, g] = table_[m * kChannels + c];
      values[m][c] = above ? specular_[m][c] * at.D[d] * at.F[f] * at.G[g] : Real{0};
    }
  }
}

template class PreparedModel<double>;
template class PreparedModel<float>;

}  // namespace trilobe
