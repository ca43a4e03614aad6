#include "trilobe/model/prepared_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/lanes.h"
#include "core/base/multiversion.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// f0, f1, a0, a1 as CatmullRom::Piece has them.
template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> Cubic(const Real* piece, Real u, Real t) {
  const Four<Real> around = u * Load(piece + 8) + t * Load(piece + 12);
  return u * Load(piece) + t * Load(piece + 4) + t * u * around;
}

}  // namespace

template <typename Real>
TRILOBE_ALWAYS_INLINE typename PreparedModel<Real>::Rings::Place PreparedModel<Real>::Rings::At(
    Real theta) const {
  const int bin = std::min(static_cast<int>(theta * scale_), static_cast<int>(first_.size()) - 1);
  const Interval* at = &intervals_[first_[bin]];
  while (theta >= at[1].begin) ++at;
  return {at->lower, at->upper, std::min((theta - at->begin) * at->inverse_width, Real{1})};
}

// Evaluation of a model at pairs of directions. All of it is inlined into its callers, which are
// compiled for each vector width.
template <typename Real, PreparedForm kForm>
class PairEvaluation {
 public:
  using Model = PreparedModel<Real>;
  using Vector = typename Model::Vector;
  using Colour = typename Model::Colour;

  TRILOBE_ALWAYS_INLINE explicit PairEvaluation(const Model& model) : model_(model) {}

  TRILOBE_ALWAYS_INLINE void Value(const Vector& wi, const Vector& wo, Colour* value) const {
    Readings at;
    at.D[0] = {};
    if (!Read(wi, wo, &at)) {
      *value = {};
      return;
    }
    Sum(at, value);
  }

  // The same from angles >= 0 and cosines > 0, without computing theta_h and theta_d.
  TRILOBE_ALWAYS_INLINE void ValueAt(const HalfDiffAngles& angles, const Cosines& cosines,
                                     Colour* value) const {
    static_assert(kForm == PreparedForm::kIsotropic);
    const auto i = static_cast<Real>(cosines.i), o = static_cast<Real>(cosines.o);
    Four<Real> places = PlacesOf(AboveZero(Four<Real>{0, 0, 1 - i * i, 1 - o * o}));
    const auto share = [](double theta) {
      return static_cast<Real>(std::min(theta * (2 / kPi), 1.0));
    };
    places[0] = model_.right_angle_.lane[0] * share(angles.theta_h);
    places[1] = model_.right_angle_.lane[1] * share(angles.theta_d);
    Readings at;
    ReadIsotropic(places, &at);
    Sum(at, value);
  }

  TRILOBE_ALWAYS_INLINE void LobeValues(const Vector& wi, const Vector& wo, Colour* values) const {
    Readings at;
    const bool above = Read(wi, wo, &at);
    for (int m = 0; m < model_.lobes_; ++m) {
      Four<Real> lobe{};
      if (above) {
        lobe = LobeOf(at, m) * at.scale;
      }
      for (int c = 0; c < kChannels; ++c) values[m][c] = lobe[c];
    }
  }

 private:
  using Quad = typename Model::Quad;
  using Tables = typename Model::Tables;
  using Rings = typename Model::Rings;

  static constexpr bool kPlain = kForm != PreparedForm::kAny;
  static constexpr int kVectors = kPlain ? 1 : kMaxLobes + 1;

  // The table coordinates of one pair of directions.
  struct Readings {
    Quad D[kVectors], F[kVectors], G[kVectors];
    Real scale;  // of their product: 1 / (cos theta_i cos theta_o)
  };

  TRILOBE_ALWAYS_INLINE static int VectorsOf(const Tables& tables) {
    return kPlain ? 1 : tables.vectors;
  }

  // Properties fixed by the form, else read from the model.
  TRILOBE_ALWAYS_INLINE static bool Is(PreparedForm form, bool any) {
    return kPlain ? kForm == form : any;
  }

  // One factor of a lobe, and the product of a lobe's factors, per channel.
  TRILOBE_ALWAYS_INLINE static Four<Real> FactorOf(const Tables& tables, const Quad* values,
                                                   int lobe) {
    const auto lane = static_cast<unsigned>(lobe * tables.lobe_stride);
    const Quad& at = values[lane / 4];
    return tables.per_channel ? Load(at.lane) : Broadcast(at.lane[lane % 4]);
  }
  TRILOBE_ALWAYS_INLINE Four<Real> LobeOf(const Readings& at, int lobe) const {
    return Load(model_.specular_[lobe].lane) * FactorOf(model_.d_, at.D, lobe) *
           FactorOf(model_.f_, at.F, lobe) * FactorOf(model_.g_, at.G, lobe);
  }

  // The diffuse term plus all lobes, or 0 if that is negative.
  TRILOBE_ALWAYS_INLINE void Sum(const Readings& at, Colour* value) const {
    Four<Real> rho = Load(model_.diffuse_lanes_.lane);
    if constexpr (kPlain) {
      const Four<Real> lobes = Load(at.D->lane) * (Load(at.G->lane) * at.scale);
      constexpr int kMost = kForm == PreparedForm::kIsotropic ? 3 : 4;  // that have room
      for (int m = 0; m < kMost; ++m) {
        rho += Load(model_.specular_[m].lane) * Load(at.F->lane) * Broadcast<Real>(lobes[m]);
      }
    } else {
      for (int m = 0; m < model_.lobes_; ++m) rho += LobeOf(at, m) * at.scale;
    }
    rho = MaxOf(rho, Four<Real>{});
    for (int c = 0; c < kChannels; ++c) (*value)[c] = rho[c];
  }

  TRILOBE_ALWAYS_INLINE static Four<Real> AboveZero(const Four<Real>& sines2) {
    return MaxOf(sines2, Broadcast(std::numeric_limits<Real>::min()));
  }

  // Table coordinates from the squared sines of theta_h, theta_d, theta_i and theta_o, which are
  // not 0.
  TRILOBE_ALWAYS_INLINE Four<Real> PlacesOf(const Four<Real>& sines2) const {
    const Four<Real> m = MinOf(sines2, Four<Real>{1 - sines2});
    const auto term = [&](size_t k) __attribute__((always_inline)) {
      return Load(model_.terms_[k].lane);
    };
    const Four<Real> places = SqrtOf(m) * Polynomial<Model::kTerms, Four<Real>>(term, m);
    return sines2 > Broadcast<Real>(0.5) ? Load(model_.right_angle_.lane) - places : places;
  }

  // False if the value is 0 for any tables.
  TRILOBE_ALWAYS_INLINE bool Read(const Vector& wi, const Vector& wo, Readings* readings) const {
    if (!(wi[2] > 0 && wo[2] > 0)) return false;
    const Vector sum = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
    const Real across2 = sum[0] * sum[0] + sum[1] * sum[1], length2 = across2 + sum[2] * sum[2];
    // |wi + wo| = 2 cos theta_d. Rejects NaN and vectors far from unit length:
    if (!(length2 > 0 && length2 < 16)) return false;
    const Four<Real> sines2 = AboveZero(
        Four<Real>{across2 / length2, 1 - length2 / 4, 1 - wi[2] * wi[2], 1 - wo[2] * wo[2]});
    const Four<Real> angles = PlacesOf(sines2);
    if constexpr (kForm == PreparedForm::kIsotropic) {
      ReadIsotropic(angles, readings);
      return true;
    }
    const Parts<Real> at(angles);  // an entry later, as tables begin an entry before
    Four<Real> turn = Broadcast<Real>(-0.5);
    if (Is(PreparedForm::kAnisotropic, model_.anisotropic())) {
      const Four<Real> along = {sum[0], wi[0], wo[0], 1}, across = {sum[1], wi[1], wo[1], 0};
      // Directions within 1e-9 of the normal have azimuth 0 (HalfVector).
      const Four<Real> least = {length2 * static_cast<Real>(1e-18), static_cast<Real>(1e-18),
                                static_cast<Real>(1e-18), 0};
      const Four<Real> turns = Turns<Real>(along, across);
      turn = (along * along + across * across > least ? turns : Four<Real>{}) *
                 Load(model_.azimuths_.lane) -
             Real{0.5};
    }
    const Parts<Real> around(turn);
    if (!kPlain && model_.lobes_ == 0) {  // no table has entries
      readings->scale = 0;
      return true;
    }
    if (Is(PreparedForm::kAnisotropic, model_.d_axis_.polar())) {
      ReadPolar(model_.d_, model_.d_rings_, angles[0], around.whole(0), around.upper[0],
                readings->D);
    } else if (!kPlain && model_.stretched_) {
      ReadStretchedD(wi, wo, angles[0], std::sqrt(sines2[0]), std::sqrt(length2) / 2, readings->D);
    } else {
      ReadD(model_.by_root_ ? std::sqrt(angles[0]) : angles[0], readings->D);
    }
    ReadBins(model_.f_, at.whole(1), at.lower[1], at.upper[1], readings->F);
    Quad* const G = readings->G;
    if (Is(PreparedForm::kAnisotropic, model_.g_axis_.polar())) {
      Quad G_o[kVectors];
      ReadPolar(model_.g_, model_.g_rings_, angles[2], around.whole(1), around.upper[1], G);
      ReadPolar(model_.g_, model_.g_rings_, angles[3], around.whole(2), around.upper[2], G_o);
      for (int v = 0; v < VectorsOf(model_.g_); ++v) {
        Store<Real>(Load(G[v].lane) * Load(G_o[v].lane), G[v].lane);
      }
      readings->scale = 1 / std::max(wi[2] * wo[2], std::numeric_limits<Real>::min());
    } else {
      ReadSpline(at, readings);
    }
    return true;
  }

  // The same from table coordinates.
  TRILOBE_ALWAYS_INLINE void ReadIsotropic(const Four<Real>& places, Readings* readings) const {
    const Parts<Real> at(places);
    ReadD(std::sqrt(places[0]), readings->D);
    ReadBins(model_.f_, at.whole(1), at.lower[1], at.upper[1], readings->F);
    ReadSpline(at, readings);
  }

  // Separate, because of the latency of a root.
  TRILOBE_ALWAYS_INLINE void ReadD(Real place, Quad* values) const {
    const Parts<Real> at(Broadcast(place));
    ReadBins(model_.d_, at.whole(0), at.lower[0], at.upper[0], values);
  }

  TRILOBE_ALWAYS_INLINE void ReadSpline(const Parts<Real>& at, Readings* readings) const {
    const Quad* const at_i = &model_.g_pieces_[at.whole(2) * VectorsOf(model_.g_) * 4];
    const Quad* const at_o = &model_.g_pieces_[at.whole(3) * VectorsOf(model_.g_) * 4];
    Quad* const G = readings->G;
    for (int v = 0; v < VectorsOf(model_.g_); ++v) {
      Store<Real>(Cubic(at_i[4 * v].lane, Real{at.lower[2]}, Real{at.upper[2]}) *
                      Cubic(at_o[4 * v].lane, Real{at.lower[3]}, Real{at.upper[3]}),
                  G[v].lane);
    }
    const int lane = kPlain ? 3 : model_.cosine_lane_;
    readings->scale = 1 / G[lane / 4].lane[lane % 4];
  }

  TRILOBE_ALWAYS_INLINE static void ReadBins(const Tables& tables, int entry, Real lower,
                                             Real upper, Quad* values) {
    const int vectors = VectorsOf(tables);
    const Quad* const at = &tables.entries[static_cast<size_t>(entry) * vectors];
    for (int v = 0; v < vectors; ++v) {
      Store<Real>(lower * Load(at[v].lane) + upper * Load(at[v + vectors].lane), values[v].lane);
    }
  }

  TRILOBE_ALWAYS_INLINE void ReadPolar(const Tables& tables, const Rings& rings, Real theta,
                                       int column, Real t, Quad* values) const {
    const typename Rings::Place at = rings.At(theta);
    const int columns = (&tables == &model_.d_ ? model_.d_axis_ : model_.g_axis_).phi_nodes + 2,
              vectors = VectorsOf(tables);
    const auto node = [&](int ring) __attribute__((always_inline)) {
      return &tables.entries[static_cast<size_t>(ring * columns + column) * vectors];
    };
    const Quad* const lower = node(at.lower);
    const Quad* const upper = node(at.upper);
    const Real w00 = (1 - at.t) * (1 - t), w01 = (1 - at.t) * t;
    const Real w10 = at.t * (1 - t), w11 = at.t * t;
    for (int v = 0; v < vectors; ++v) {
      Store<Real>(w00 * Load(lower[v].lane) + w01 * Load(lower[v + vectors].lane) +
                      w10 * Load(upper[v].lane) + w11 * Load(upper[v + vectors].lane),
                  values[v].lane);
    }
  }

  [[gnu::noinline]] void ReadStretchedD(const Vector& wi, const Vector& wo, Real theta_h,
                                        Real sin_h, Real cos_d, Quad* values) const {
    // cos theta_o - cos theta_i = 2 sin theta_h sin theta_d cos phi_d.
    const Real twice_sines = 2 * sin_h * SineOf(cos_d);
    const Real cos_phi = twice_sines > 0 ? (wo[2] - wi[2]) / twice_sines : Real{1};
    const Stretch::Place place(
        Stretch::Place::Cosines{cos_d, std::clamp(cos_phi, Real{-1}, Real{1})});
    std::array<Real, kMaxLobes> at;
    for (size_t k = 0; k < model_.stretches_.size(); ++k) {
      const Real right_angles =
          static_cast<Real>(model_.stretches_[k].ThetaH(theta_h, place) * (2 / kPi));
      const bool root = model_.d_axis_.rule == Axis::Rule::kRootTheta;
      const Real x =
          static_cast<Real>(model_.d_axis_.size) * (root ? std::sqrt(right_angles) : right_angles);
      at[k] = std::clamp(x + Real{0.5}, Real{1}, static_cast<Real>(model_.d_axis_.size));
    }
    for (int table = 0; table < model_.d_.tables; ++table) {
      const Real x = at[model_.stretch_of_[table]];
      const int lower = static_cast<int>(x), lane = model_.d_.LaneOf(table);
      const Real t = x - static_cast<Real>(lower);
      const Quad* const entry = &model_.d_.entries[lower * model_.d_.vectors + lane / 4];
      values[lane / 4].lane[lane % 4] =
          (1 - t) * entry->lane[lane % 4] + t * entry[model_.d_.vectors].lane[lane % 4];
    }
  }

  const Model& model_;
};

namespace {

// Multiversioned functions cannot be templates.
#define TRILOBE_EVALUATE_FORM(Real, kForm)                                                       \
  TRILOBE_MULTIVERSION void EvaluateValues(                                                      \
      const PairEvaluation<Real, kForm>& evaluation, size_t size, const std::array<Real, 3>* wi, \
      const std::array<Real, 3>* wo, std::array<Real, 3>* values) {                              \
    for (size_t k = 0; k < size; ++k) evaluation.Value(wi[k], wo[k], &values[k]);                \
  }
#define TRILOBE_EVALUATE(Real)                                                                   \
  TRILOBE_MULTIVERSION void EvaluateAngles(                                                      \
      const PairEvaluation<Real, PreparedForm::kIsotropic>& evaluation,                          \
      const HalfDiffAngles& angles, const Cosines& cosines, std::array<Real, 3>* value) {        \
    evaluation.ValueAt(angles, cosines, value);                                                  \
  }                                                                                              \
  TRILOBE_EVALUATE_FORM(Real, PreparedForm::kAny)                                                \
  TRILOBE_EVALUATE_FORM(Real, PreparedForm::kIsotropic)                                          \
  TRILOBE_EVALUATE_FORM(Real, PreparedForm::kAnisotropic)                                        \
  TRILOBE_MULTIVERSION void EvaluateLobes(                                                       \
      const PairEvaluation<Real, PreparedForm::kAny>& evaluation, const std::array<Real, 3>& wi, \
      const std::array<Real, 3>& wo, std::array<Real, 3>* values) {                              \
    evaluation.LobeValues(wi, wo, values);                                                       \
  }
TRILOBE_EVALUATE(double)
TRILOBE_EVALUATE(float)
#undef TRILOBE_EVALUATE
#undef TRILOBE_EVALUATE_FORM

}  // namespace

template <typename Real>
void PreparedModel<Real>::Evaluate(size_t size, const Vector* wi, const Vector* wo,
                                   Colour* values) const {
  switch (form_) {
    case PreparedForm::kIsotropic:
      return EvaluateValues(PairEvaluation<Real, PreparedForm::kIsotropic>(*this), size, wi, wo,
                            values);
    case PreparedForm::kAnisotropic:
      return EvaluateValues(PairEvaluation<Real, PreparedForm::kAnisotropic>(*this), size, wi, wo,
                            values);
    case PreparedForm::kAny:
      return EvaluateValues(PairEvaluation<Real, PreparedForm::kAny>(*this), size, wi, wo, values);
  }
}

template <typename Real>
void PreparedModel<Real>::Values(std::span<const Vector> wi, std::span<const Vector> wo,
                                 std::span<Colour> values) const {
  if (wi.size() != values.size() || wo.size() != values.size()) {
    throw Error(ErrorKind::kMismatch, "there are " + std::to_string(wi.size()) + " wi, " +
                                          std::to_string(wo.size()) + " wo and room for " +
                                          std::to_string(values.size()) +
                                          " values; give as many of each")
        .About("wi", wi.size());
  }
  Evaluate(values.size(), wi.data(), wo.data(), values.data());
}

template <typename Real>
typename PreparedModel<Real>::Colour PreparedModel<Real>::Value(const HalfDiffAngles& angles,
                                                                const Cosines& cosines) const {
  if (!(angles.theta_h >= 0 && angles.theta_d >= 0 && cosines.i > 0 && cosines.o > 0)) return {};
  if (form_ == PreparedForm::kIsotropic) {
    Colour value;
    EvaluateAngles(PairEvaluation<Real, PreparedForm::kIsotropic>(*this), angles, cosines, &value);
    return value;
  }
  const auto [wi, wo] = ToDirections(angles);
  const auto real = [](const Direction& w) {
    return Vector{static_cast<Real>(w[0]), static_cast<Real>(w[1]), static_cast<Real>(w[2])};
  };
  return Value(real(wi), real(wo));
}

template <typename Real>
void PreparedModel<Real>::LobeValues(const Vector& wi, const Vector& wo, Colour* values) const {
  EvaluateLobes(PairEvaluation<Real, PreparedForm::kAny>(*this), wi, wo, values);
}

template class PreparedModel<double>;
template class PreparedModel<float>;

}  // namespace trilobe
