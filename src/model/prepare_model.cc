#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/base/lanes.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/model/prepared_model.h"

// Construction of a PreparedModel; prepared_model.cc evaluates it.
namespace trilobe {

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

// Rings of a polar axis repeat their first two nodes at the end.
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
  // Tables per channel leave the last lane of a vector unused, and so do three lobes' in the first
  // vector.
  cosine_lane_ = g_.per_channel ? 3 : std::max(g_.tables, 3);
  add(cosines, cosine_lane_);
  for (int t = 0; t < g_.tables; ++t) add(model.table(Factor::kG, t), g_.LaneOf(t));
}

#define TRILOBE_PREPARE(Real)                                                              \
  template PreparedModel<Real>::PreparedModel(const FactorModel&);                         \
  template PreparedModel<Real>::Tables::Tables(const ModelSpec&, Factor, int);             \
  template PreparedModel<Real>::Rings::Rings(const Axis&);                                 \
  template void PreparedModel<Real>::SetTables(const FactorModel&, Factor, Tables*) const; \
  template void PreparedModel<Real>::SetSpline(const FactorModel&);
TRILOBE_PREPARE(double)
TRILOBE_PREPARE(float)
#undef TRILOBE_PREPARE

}  // namespace trilobe
