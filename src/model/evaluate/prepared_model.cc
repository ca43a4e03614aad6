#include "trilobe/model/evaluate/prepared_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/multiversion.h"
#include "core/math/lanes.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/core/math/catmull_rom.h"

namespace trilobe {

// The forms that most models have, with D and G by the lobe and F by the channel, of no more lobes
// than a vector has room for, are compiled by themselves: what depends on the form is decided then.
enum class PreparedForm : char {
  kAny,
  kIsotropic,    // D over the root of theta_h, unstretched; G a spline
  kAnisotropic,  // D and G over azimuths, too
};

namespace {

// f0, f1, a0, a1 as CatmullRom::Piece has them.
template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> Cubic(const Real* piece, Real u, Real t) {
  const Four<Real> around = u * Load(piece + 8) + t * Load(piece + 12);
  return u * Load(piece) + t * Load(piece + 4) + t * u * around;
}

}  // namespace

template <typename Real>
PreparedModel<Real>::Tables::Tables(const ModelSpec& spec, Factor factor, int more_lanes)
    : per_channel(spec.sharing(factor).per_channel), tables(spec.num_tables(factor)) {
  vectors = ((tables > 0 ? LaneOf(tables - 1) : 0) + 1 + more_lanes + 3) / 4;
  if (spec.sharing(factor).per_lobe) lobe_stride = per_channel ? 4 : 1;
}

template <typename Real>
PreparedModel<Real>::Rings::Rings(const Axis& axis) {
  std::vector<double> theta;
  for (const double degrees : axis.theta) theta.push_back(DegreesToRadians(degrees));
  const int last = static_cast<int>(theta.size()) - 1;
  double narrowest = kPi / 2;
  intervals_.push_back({.begin = -1, .inverse_width = 0, .lower = 0, .upper = 0});
  for (int k = 0; k <= last; ++k) {
    const double width = k < last ? theta[k + 1] - theta[k] : 0;
    if (width > 0) narrowest = std::min(narrowest, width);
    intervals_.push_back({.begin = static_cast<Real>(theta[k]),
                          .inverse_width = static_cast<Real>(width > 0 ? 1 / width : 0),
                          .lower = k,
                          .upper = std::min(k + 1, last)});
  }
  intervals_.push_back({.begin = std::numeric_limits<Real>::max(),
                        .inverse_width = 0,
                        .lower = last,
                        .upper = last});
  const int bins = std::clamp(static_cast<int>(kPi / narrowest), 64, 4096);
  scale_ = static_cast<Real>(bins / (kPi / 2));
  for (int k = 0; k <= bins; ++k) {
    int interval = 0;
    while (static_cast<double>(intervals_[interval + 1].begin) * bins <= kPi / 2 * (k - 0.5)) {
      ++interval;
    }
    first_.push_back(interval);
  }
}

template <typename Real>
TRILOBE_ALWAYS_INLINE typename PreparedModel<Real>::Rings::Place PreparedModel<Real>::Rings::At(
    Real theta) const {
  const int bin = std::min(static_cast<int>(theta * scale_), static_cast<int>(first_.size()) - 1);
  const Interval* at = &intervals_[first_[bin]];
  while (theta >= at[1].begin) ++at;
  return {at->lower, at->upper, std::min((theta - at->begin) * at->inverse_width, Real{1})};
}

template <typename Real>
PreparedModel<Real>::PreparedModel(const FactorModel& model)
    : lobes_(model.spec().lobes),
      stretches_(model.spec().stretches.distinct()),
      stretched_(model.spec().stretches.any()),
      d_axis_(model.spec().d_axis),
      f_axis_(model.spec().f_axis),
      g_axis_(model.spec().g_axis),
      d_(model.spec(), Factor::kD, 0),
      f_(model.spec(), Factor::kF, 0),
      g_(model.spec(), Factor::kG, 1) {
  CheckParameters(model);
  const ModelSpec& spec = model.spec();
  for (int c = 0; c < kChannels; ++c) {
    diffuse_[c] = diffuse_lanes_.lane[c] = static_cast<Real>(model.d()[c]);
  }
  for (int m = 0; m < lobes_; ++m) {
    Quad& s = specular_.emplace_back(Quad{});
    for (int c = 0; c < kChannels; ++c) s.lane[c] = static_cast<Real>(model.s(m)[c]);
  }
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    stretch_of_.push_back(spec.StretchOfTable(t));
  }
  const Axis* const axes[] = {&d_axis_, &f_axis_, &g_axis_, &g_axis_};
  by_root_ = d_axis_.rule == Axis::Rule::kRootTheta && !stretched_;
  for (int k = 0; k < 4; ++k) {
    const bool by_bins = !axes[k]->polar() && !(k == 0 && stretched_);
    const bool root = k == 0 && by_root_;
    const double bins = axes[k]->size,
                 at_right_angle = by_bins ? (root ? bins * bins : bins) : kPi / 2;
    right_angle_.lane[k] = static_cast<Real>(at_right_angle);
    for (int n = 0; n < kTerms; ++n) {
      terms_[n].lane[k] = static_cast<Real>(at_right_angle * (2 / kPi) * ArcSine<Real>::kTerms[n]);
    }
  }
  azimuths_ = {static_cast<Real>(d_axis_.phi_nodes), static_cast<Real>(g_axis_.phi_nodes),
               static_cast<Real>(g_axis_.phi_nodes), 0};
  if (d_axis_.polar()) d_rings_ = Rings(d_axis_);
  if (g_axis_.polar()) g_rings_ = Rings(g_axis_);
  SetTables(model, Factor::kD, &d_);
  SetTables(model, Factor::kF, &f_);
  const bool shared = !spec.D.per_channel && spec.D.per_lobe && spec.F.per_channel &&
                      !spec.F.per_lobe && !spec.G.per_channel && spec.G.per_lobe;
  if (shared && lobes_ > 0 && d_.vectors == 1 && g_.vectors == 1) {
    if (d_axis_.polar() && g_axis_.polar()) form_ = PreparedForm::kAnisotropic;
    if (by_root_ && g_axis_.rule == Axis::Rule::kSpline) form_ = PreparedForm::kIsotropic;
  }
  specular_.resize(std::max(lobes_, 4), Quad{});
  if (g_axis_.rule == Axis::Rule::kSpline) {
    SetSpline(model);
  } else {
    SetTables(model, Factor::kG, &g_);
  }
}

// Rings of a polar axis go two nodes beyond the circle, the first ones again.
template <typename Real>
void PreparedModel<Real>::SetTables(const FactorModel& model, Factor factor, Tables* tables) const {
  const Axis& axis = model.spec().axis(factor);
  const int rings = axis.polar() ? static_cast<int>(axis.theta.size()) : 1;
  const int nodes = axis.polar() ? axis.phi_nodes : axis.size, more = axis.polar() ? 2 : 3;
  tables->entries.resize(static_cast<size_t>(rings) * (nodes + more) * tables->vectors);
  for (int t = 0; t < tables->tables; ++t) {
    const std::span<const double> table = model.table(factor, t);
    const int lane = tables->LaneOf(t);
    Quad* target = &tables->entries[lane / 4];
    for (int ring = 0; ring < rings; ++ring) {
      for (int k = 0; k < nodes + more; ++k, target += tables->vectors) {
        const int node = axis.polar() ? k % nodes : std::clamp(k - 1, 0, nodes - 1);
        target->lane[lane % 4] = static_cast<Real>(table[ring * nodes + node]);
      }
    }
  }
}

template <typename Real>
void PreparedModel<Real>::SetSpline(const FactorModel& model) {
  const CatmullRom spline(g_axis_.size);
  g_pieces_.resize(static_cast<size_t>(spline.nodes() + 2) * g_.vectors * 4);
  const auto add = [&](std::span<const double> values, int lane) {
    std::vector<CatmullRom::Piece> pieces = spline.Pieces(values);
    pieces.insert(pieces.begin(), {values.front(), values.front(), 0, 0});
    pieces.insert(pieces.end(), 2, {values.back(), values.back(), 0, 0});
    for (size_t k = 0; k < pieces.size(); ++k) {
      const CatmullRom::Piece& piece = pieces[k];
      Quad* const target = &g_pieces_[(k * g_.vectors + lane / 4) * 4];
      const double numbers[] = {piece.f0, piece.f1, piece.a0, piece.a1};
      for (int n = 0; n < 4; ++n) target[n].lane[lane % 4] = static_cast<Real>(numbers[n]);
    }
  };
  std::vector<double> cosines(spline.nodes());
  for (int k = 0; k < spline.nodes(); ++k) cosines[k] = std::cos(spline.NodeAngle(k));
  // A channel's tables leave the last lane of a vector free, and so do three lobes' of the first.
  cosine_lane_ = g_.per_channel ? 3 : std::max(g_.tables, 3);
  add(cosines, cosine_lane_);
  for (int t = 0; t < g_.tables; ++t) add(model.table(Factor::kG, t), g_.LaneOf(t));
}

// The evaluation of a model at pairs of directions. All of it becomes part of its callers, which
// are compiled for each vector width.
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

  // The same by angles of 0 or more, so that theta_h and theta_d need not be found, and by cosines
  // above 0.
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

  // What one pair of directions reads.
  struct Readings {
    Quad D[kVectors], F[kVectors], G[kVectors];
    Real scale;  // of their product: 1 / (cos theta_i cos theta_o)
  };

  TRILOBE_ALWAYS_INLINE static int VectorsOf(const Tables& tables) {
    return kPlain ? 1 : tables.vectors;
  }

  // What is known of a form, and what the model says of any.
  TRILOBE_ALWAYS_INLINE static bool Is(PreparedForm form, bool any) {
    return kPlain ? kForm == form : any;
  }

  // A factor of one lobe, and the product of a lobe's, for each channel.
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

  // The diffuse term and all lobes, if that is not negative.
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

  // Where the tables are read, by the squares of the sines of theta_h, theta_d, theta_i and
  // theta_o, which are not 0.
  TRILOBE_ALWAYS_INLINE Four<Real> PlacesOf(const Four<Real>& sines2) const {
    const Four<Real> m = MinOf(sines2, Four<Real>{1 - sines2});
    const auto term = [&](size_t k) __attribute__((always_inline)) {
      return Load(model_.terms_[k].lane);
    };
    const Four<Real> places = SqrtOf(m) * Polynomial<Model::kTerms, Four<Real>>(term, m);
    return sines2 > Broadcast<Real>(0.5) ? Load(model_.right_angle_.lane) - places : places;
  }

  // False where the value is 0 whatever the tables say.
  TRILOBE_ALWAYS_INLINE bool Read(const Vector& wi, const Vector& wo, Readings* readings) const {
    if (!(wi[2] > 0 && wo[2] > 0)) return false;
    const Vector sum = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
    const Real across2 = sum[0] * sum[0] + sum[1] * sum[1], length2 = across2 + sum[2] * sum[2];
    // |wi + wo| = 2 cos theta_d. No numbers, or nothing like unit vectors:
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
      // A direction within 1e-9 of the normal has the azimuth 0 (HalfVector).
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

  // The same from where the tables are read.
  TRILOBE_ALWAYS_INLINE void ReadIsotropic(const Four<Real>& places, Readings* readings) const {
    const Parts<Real> at(places);
    ReadD(std::sqrt(places[0]), readings->D);
    ReadBins(model_.f_, at.whole(1), at.lower[1], at.upper[1], readings->F);
    ReadSpline(at, readings);
  }

  // By itself, as a root comes late.
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

// What is compiled for each vector width may not be a template.
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
    throw Error("there are " + std::to_string(wi.size()) + " wi, " + std::to_string(wo.size()) +
                " wo and room for " + std::to_string(values.size()) +
                " values; give as many of each");
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
