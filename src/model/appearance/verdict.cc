#include "model/appearance/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace trilobe {
namespace {

Visibility VisibilityOf(double mean_delta_e, double delta_e_95) {
  const auto within = [&](double mean, double at_95) {
    return mean_delta_e <= mean && delta_e_95 <= at_95;
  };
  if (within(1, 2.3)) return Visibility::kNone;
  if (within(2.3, 5)) return Visibility::kHardly;
  return within(5, 10) ? Visibility::kVisible : Visibility::kPlain;
}

// The mean difference in a region over that elsewhere.
double StandsOut(const SeenError& error, SeenPlace place) {
  const PlaceError& at = error.at(place);
  const double elsewhere = error.mean_delta_e - at.share * at.mean_delta_e;
  return elsewhere > 0 ? at.mean_delta_e * (1 - at.share) / elsewhere : 0;
}

// The region with differences at least half larger than elsewhere, and large enough to matter.
SeenPlace PlaceOf(const SeenError& error) {
  constexpr double kMore = 1.5, kMatters = 0.2;
  SeenPlace place = SeenPlace::kRest;
  double most = kMore;
  for (const SeenPlace other : {SeenPlace::kHighlights, SeenPlace::kGrazing}) {
    const double stands_out = StandsOut(error, other);
    if (stands_out < most || error.at(other).squares < kMatters) continue;
    most = stands_out;
    place = other;
  }
  return place;
}

// Kind of error in one region, or in all.
Fault FaultAt(const SeenError& error, SeenPlace place) {
  constexpr double kMost = 0.5;
  PlaceError at = error.at(place);
  if (place == SeenPlace::kRest) {
    at = {.mean_delta_e = error.mean_delta_e};
    for (const PlaceError& one : error.places) {
      at.lightness += one.share * one.lightness;
      at.color += one.squares * one.color;
    }
  }
  if (at.color > kMost) return Fault::kWrongColor;
  if (std::abs(at.lightness) <= kMost * at.mean_delta_e) return Fault::kDifferent;
  return at.lightness < 0 ? Fault::kTooDark : Fault::kTooBright;
}

std::string Where(SeenPlace place) {
  switch (place) {
    case SeenPlace::kHighlights:
      return "in highlights";
    case SeenPlace::kGrazing:
      return "at grazing angles";
    case SeenPlace::kRest:
      return "all over";
  }
  return "";
}

std::string What(Fault fault) {
  switch (fault) {
    case Fault::kDifferent:
      return "";
    case Fault::kTooDark:
      return ": too dark";
    case Fault::kTooBright:
      return ": too bright";
    case Fault::kWrongColor:
      return ": wrong colour";
  }
  return "";
}

constexpr double kLeastShare = 0.5;

std::string HowVisible(Visibility visibility) {
  switch (visibility) {
    case Visibility::kNone:
      return "cannot be told apart";
    case Visibility::kHardly:
      return "hardly visible side by side";
    case Visibility::kVisible:
      return "visible";
    case Visibility::kPlain:
      return "plainly visible";
  }
  return "";
}

// Words on what was compared.
std::string SeenWords(const Verdict& verdict) {
  const std::string place = Where(verdict.place), what = What(verdict.fault);
  std::string words = HowVisible(verdict.visibility);
  if (verdict.visibility == Visibility::kNone) return words;
  if (verdict.visibility != Visibility::kHardly) return words + " " + place + what;
  return words + (verdict.place == SeenPlace::kRest ? what : ", most " + place + what);
}

// Words on what is expected of all directions, or "".
std::string WholeWords(const std::optional<WholeSphere>& whole) {
  if (!whole) return "";
  char text[80];
  std::snprintf(text, sizeof(text), "the whole off by about Delta E %.2g, %.0f dB",
                whole->mean_delta_e, whole->psnr_db);
  return text;
}

}  // namespace

bool Verdict::of_the_whole() const {
  return !basis.black && basis.samples >= basis.parameters && basis.measured_share >= kLeastShare;
}

Visibility Verdict::visibility_of_whole() const {
  constexpr double kWithin = 2;
  if (!basis.whole) return visibility;
  return std::max(visibility, VisibilityOf(basis.whole->mean_delta_e / kWithin, 0));
}

Verdict VerdictOf(const SeenError& error, const Basis& basis) {
  const Visibility visibility = VisibilityOf(error.mean_delta_e, error.delta_e_95);
  if (visibility == Visibility::kNone) return {.basis = basis};
  const SeenPlace place = PlaceOf(error);
  return {visibility, place, FaultAt(error, place), basis};
}

std::string Words(const Verdict& verdict) {
  constexpr double kNearlyAll = 0.95;
  const Basis& basis = verdict.basis;
  const std::string of_whole = WholeWords(basis.whole);
  const std::string percent =
      std::to_string(static_cast<int>(std::lround(100 * basis.measured_share))) + " %";
  if (basis.black) return "no verdict: what was measured reflects nothing";
  if (basis.samples < basis.parameters) {
    return "no verdict: " + std::to_string(basis.samples) + " samples are fewer than " +
           std::to_string(basis.parameters) + " parameters; at the samples " + SeenWords(verdict) +
           (basis.whole ? "; " + of_whole : "");
  }
  if (!verdict.of_the_whole()) {
    return "no verdict: only " + percent + " of what a renderer reads was measured; there " +
           SeenWords(verdict) + (basis.whole ? "; " + of_whole : "");
  }
  const Visibility visibility = verdict.visibility_of_whole();
  const bool bounded = visibility != verdict.visibility;
  if (basis.measured_share >= kNearlyAll && !bounded) return SeenWords(verdict);
  return (bounded ? HowVisible(visibility) + " as a whole: " : "") + SeenWords(verdict) +
         " where it was measured, at " + percent +
         " of what a renderer reads; the rest is a guess" +
         (basis.whole ? ", and " + of_whole : "");
}

std::string VisibilityName(const Verdict& verdict) {
  return verdict.of_the_whole() ? NameOf(verdict.visibility_of_whole()) : "unknown";
}

std::string NameOf(Visibility visibility) {
  switch (visibility) {
    case Visibility::kNone:
      return "none";
    case Visibility::kHardly:
      return "hardly";
    case Visibility::kVisible:
      return "visible";
    case Visibility::kPlain:
      return "plain";
  }
  return "";
}

std::string NameOf(Fault fault) {
  switch (fault) {
    case Fault::kDifferent:
      return "different";
    case Fault::kTooDark:
      return "too_dark";
    case Fault::kTooBright:
      return "too_bright";
    case Fault::kWrongColor:
      return "wrong_color";
  }
  return "";
}

std::vector<Advice> AdviceOn(const Verdict& verdict, const FitFacts& facts) {
  constexpr double kMuchLeftOut = 0.01, kMuchIrreducible = 0.3;
  std::vector<Advice> advice;
  if (facts.interrupted) advice.push_back(Advice::kGoOn);
  if (facts.glow > 0) advice.push_back(Advice::kGlows);
  if (facts.ripple > 0) advice.push_back(Advice::kRings);
  if (verdict.visibility == Visibility::kNone) return advice;
  if (!facts.ended) {
    if (!facts.interrupted) advice.push_back(Advice::kIterate);
    return advice;
  }
  if (facts.left_out && *facts.left_out > kMuchLeftOut) advice.push_back(Advice::kAnisotropic);
  if (facts.may_choose_form) {
    advice.push_back(facts.default_solver ? Advice::kChooseForm : Advice::kChooseSolver);
  }
  if (facts.irreducible > kMuchIrreducible) advice.push_back(Advice::kDataDiffer);
  return advice;
}

std::string NameOf(Advice advice) {
  switch (advice) {
    case Advice::kGoOn:
      return "go_on";
    case Advice::kIterate:
      return "iterate";
    case Advice::kAnisotropic:
      return "anisotropic";
    case Advice::kChooseSolver:
      return "choose_solver";
    case Advice::kChooseForm:
      return "choose_form";
    case Advice::kDataDiffer:
      return "data_differ";
    case Advice::kGlows:
      return "glows";
    case Advice::kRings:
      return "rings";
  }
  return "";
}

}  // namespace trilobe
