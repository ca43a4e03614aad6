#include "experiments/limits/term_forms.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Indices of the diffuse term, and of the sets of F and G, in a model made by TermModel::Of.
constexpr int kDiffuse = 0, kSetOfF = 1, kSetOfG = 2;

// A model of a spec that keeps the terms and sets of `from` at their places, but for those that are
// of another size, and may have more. What is new is 0.
TermModel WithSpec(TermSpec spec, const TermModel& from) {
  TermModel model(std::move(spec));
  for (int t = 0; t < static_cast<int>(from.spec().terms.size()); ++t) {
    std::ranges::copy(from.strength(t), model.strength(t).begin());
  }
  for (int set = 0; set < static_cast<int>(from.spec().sets.size()); ++set) {
    const TableSet &was = from.spec().sets[set], &is = model.spec().sets[set];
    if (was.axis != is.axis) continue;
    for (int k = 0; k < is.count; ++k) {
      for (int c = 0; c < model.spec().channels; ++c) {
        std::ranges::copy(from.table(set, std::min(k, was.count - 1), c),
                          model.table(set, k, c).begin());
      }
    }
  }
  return model;
}

TermModel Paper(const TermModel& paper) { return paper; }

// d_c T(theta_i) T(theta_o), T by 12 entries, 1 to begin with.
TermModel DiffuseTable(const TermModel& paper) {
  constexpr int kEntries = 12;
  TermSpec spec = paper.spec();
  const int set = static_cast<int>(spec.sets.size());
  spec.sets.push_back({.name = "T", .axis = {.rule = Axis::Rule::kTheta, .size = kEntries}});
  spec.terms[kDiffuse].reads = {{.set = set, .site = Site::kInTimesOut}};
  TermModel model = WithSpec(std::move(spec), paper);
  std::ranges::fill(model.table(set, 0, 0), 1.0);
  return model;
}

// Light that a coating lets pass twice: T(theta) = 1 - (1 - cos theta / 2)^5 (Ashikhmin and Shirley
// 2000, eq. 5), here in units of that at 45 degrees.
TermModel CoupledDiffuse(const TermModel& paper) {
  constexpr int kEntries = 90;
  TermSpec spec = paper.spec();
  const int set = static_cast<int>(spec.sets.size());
  spec.sets.push_back(
      {.name = "T", .axis = {.rule = Axis::Rule::kTheta, .size = kEntries}, .fixed = true});
  spec.terms[kDiffuse].reads = {{.set = set, .site = Site::kInTimesOut}};
  TermModel model = WithSpec(std::move(spec), paper);
  const auto passed = [](double theta) { return 1 - std::pow(1 - std::cos(theta) / 2, 5); };
  for (int k = 0; k < kEntries; ++k) {
    model.table(set, 0, 0)[k] =
        passed(model.spec().sets[set].axis.Theta(k)) / passed(DegreesToRadians(45));
  }
  return model;
}

// G = G1(theta_i) G1(theta_o) becomes a function of Lambda = 1 / G1 - 1 at both, where the largest
// G1 is 1.
TermModel Correlated(const TermModel& paper, Site site) {
  constexpr double kLeast = 1e-3, kMost = 1e6;
  TermSpec spec = paper.spec();
  if (spec.terms.size() < 2) {
    throw Error(ErrorKind::kUnsupported, "a model without lobes has no G to correlate")
        .About("lobes", spec.terms.size() - 1);
  }
  const Axis was = spec.sets[kSetOfG].axis;
  Axis& axis = spec.sets[kSetOfG].axis;
  axis = {.rule = Axis::Rule::kTheta, .size = was.size};
  spec.sets[kSetOfG].name = "Lambda";
  for (Term& term : spec.terms) {
    for (TermRead& read : term.reads) {
      if (read.set == kSetOfG) read.site = site;
    }
  }
  TermModel model = WithSpec(std::move(spec), paper);
  const auto largest = [&](int table, int c) {
    return std::ranges::max(paper.table(kSetOfG, table, c));
  };
  const TableSet& set = model.spec().sets[kSetOfG];
  for (int t = 0; t < set.count; ++t) {
    for (int c = 0; c < (set.per_channel ? model.spec().channels : 1); ++c) {
      const double most = largest(t, c);
      for (int k = 0; k < set.axis.size; ++k) {
        const double G = was.At(set.axis.Theta(k), 0)(paper.table(kSetOfG, t, c));
        model.table(kSetOfG, t, c)[k] =
            G > 0 ? std::clamp(most / G - 1, kLeast, kMost) : (most > 0 ? kMost : kLeast);
      }
    }
  }
  for (int t = 1; t < static_cast<int>(model.spec().terms.size()); ++t) {
    for (const TermRead& read : model.spec().terms[t].reads) {
      if (read.set != kSetOfG) continue;
      for (int c = 0; c < model.spec().channels; ++c) {
        const double most = largest(read.table, c);
        model.strength(t)[c] *= most * most;
      }
    }
  }
  return model;
}

TermModel CorrelatedG(const TermModel& paper) { return Correlated(paper, Site::kHeightCorrelated); }
TermModel DirectionCorrelatedG(const TermModel& paper) {
  return Correlated(paper, Site::kDirectionCorrelated);
}

// The first lobe, which is the narrowest or brightest, has an F of its own.
TermModel OwnF(const TermModel& paper) {
  TermSpec spec = paper.spec();
  if (spec.terms.size() < 3) {
    throw Error(ErrorKind::kUnsupported, "an F of its own wants two lobes or more")
        .About("lobes", spec.terms.size() - 1);
  }
  if (spec.sets[kSetOfF].count > 1) {
    throw Error(ErrorKind::kConflict, "each lobe has an F of its own already")
        .About("F", spec.sets[kSetOfF].count);
  }
  spec.sets[kSetOfF].count = 2;
  for (TermRead& read : spec.terms[1].reads) {
    if (read.set == kSetOfF) read.table = 1;
  }
  return WithSpec(std::move(spec), paper);
}

// s_c B(theta_r), theta_r the angle of the half vector of wo and the mirrored wi.
TermModel Retro(const TermModel& paper) {
  constexpr int kEntries = 30;
  constexpr double kWidthDegrees = 10, kFirst = 1e-3;  // of d
  TermSpec spec = paper.spec();
  const int set = static_cast<int>(spec.sets.size());
  const int term = static_cast<int>(spec.terms.size());
  spec.sets.push_back({.name = "B", .axis = {.rule = Axis::Rule::kRootTheta, .size = kEntries}});
  spec.terms.push_back(
      {.name = "retroreflection", .reads = {{.set = set, .site = Site::kRetroHalf}}});
  TermModel model = WithSpec(std::move(spec), paper);
  for (int k = 0; k < kEntries; ++k) {
    const double at = RadiansToDegrees(model.spec().sets[set].axis.Theta(k)) / kWidthDegrees;
    model.table(set, 0, 0)[k] = std::exp(-at * at / 2) + kFirst;
  }
  for (int c = 0; c < model.spec().channels; ++c) {
    model.strength(term)[c] = kFirst * (model.strength(kDiffuse)[c] + kFirst);
  }
  return model;
}

}  // namespace

const std::vector<TermForm>& TermForms() {
  static const std::vector<TermForm> forms = {
      {"paper", "the form of the fit itself (paper eq. 3)", Paper},
      {"diffuse_table", "diffuse light d T(theta_i) T(theta_o), T by 12 entries", DiffuseTable},
      {"coupled_diffuse", "diffuse light as below a coating (Ashikhmin and Shirley 2000)",
       CoupledDiffuse},
      {"correlated_g", "G2 = 1 / (1 + L(theta_i) + L(theta_o)), heights correlated", CorrelatedG},
      {"direction_correlated_g", "G2 by heights and directions (Heitz 2014)", DirectionCorrelatedG},
      {"own_f", "an F of its own for the first lobe", OwnF},
      {"retro", "one more term, which reflects light back to where it comes from", Retro}};
  return forms;
}

}  // namespace trilobe
