#include "fit/reports/verdict_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "fit/reports/print.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/measurement/measured_share.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

std::string AdviceText(Advice advice, const FitFacts& facts) {
  switch (advice) {
    case Advice::kGoOn:
      return "interrupted, this is the best model so far; go on from it by --init=DIR/model.json";
    case Advice::kIterate:
      return "a limit stopped it before it converged; raise --max_iterations or --max_seconds";
    case Advice::kAnisotropic:
      return "try --model=anisotropic: an isotropic model leaves out " +
             Text(100 * facts.left_out.value_or(0), 3) +
             " % of the energy, what changes as the sample turns";
    case Advice::kChooseSolver:
      return "try the default solver: this one may be the limit, and not the form of the model";
    case Advice::kChooseForm:
      return "try --model=auto: it spends as many parameters where they show, and takes some four "
             "times as long";
    case Advice::kDataDiffer:
      return Text(100 * facts.irreducible, 2) +
             " % of E is what the data differ by when light and eye change places (noise, or not "
             "reciprocal)";
    case Advice::kGlows:
      return "it reflects " + Text(facts.glow, 3) + " times the light from " +
             Text(RadiansToDegrees(facts.glow_theta_i), 3) +
             " deg, as its last step was stopped; a renderer shows a glow there";
    case Advice::kRings:
      return "under even light a renderer shows rings: the reflected share jumps by " +
             Text(100 * facts.ripple, 2) + " % near " +
             Text(RadiansToDegrees(facts.ripple_theta_i), 3) + " deg; try another --model";
  }
  return "";
}

}  // namespace

Basis BasisOf(const BrdfSamples& samples, int parameters) {
  return {.measured_share = MeasuredShare(samples),
          .samples = samples.size(),
          .parameters = parameters,
          .black = std::ranges::none_of(samples.rho,
                                        [](const Rgb& rho) { return std::ranges::max(rho) > 0; })};
}

ReportedVerdict MakeVerdict(const std::optional<AppearanceReport>& appearance,
                            const std::optional<SeenError>& samples, const Basis& basis,
                            const FitFacts& facts) {
  ReportedVerdict reported;
  reported.of_sphere = appearance.has_value();
  if (appearance) {
    reported.seen = appearance->sphere;
  } else if (samples) {
    reported.seen = *samples;
  }
  reported.verdict = VerdictOf(reported.seen, basis);
  reported.facts = facts;
  reported.advice = AdviceOn(reported.verdict, facts);
  return reported;
}

std::string Describe(const ReportedVerdict& reported) {
  const SeenError& seen = reported.seen;
  std::string text = "verdict      " + Words(reported.verdict) + " (Delta E " +
                     (reported.of_sphere ? "" : "of samples ") + Text(seen.mean_delta_e, 2) +
                     ", 95 % below " + Text(seen.delta_e_95, 2) + "; PSNR " +
                     Text(seen.psnr_db, 3) + " dB)\n";
  for (const Advice advice : reported.advice) {
    text += "advice       " + AdviceText(advice, reported.facts) + "\n";
  }
  return text;
}

double IrreducibleShare(const ScoreReport& score) {
  return score.objective > 0 ? std::min(score.irreducible_objective / score.objective, 1.0) : 0;
}

std::string RelativeErrorText(double mean_relative_error) {
  return Text(100 * mean_relative_error) +
         " %, of dark samples mostly: |rho - rho*| over rho* + 0.001";
}

Json ToJson(const ReportedVerdict& reported) {
  const Verdict& verdict = reported.verdict;
  Json advice = Json::array();
  for (const Advice one : reported.advice) advice.push_back(NameOf(one));
  Json places;
  for (const SeenPlace place : {SeenPlace::kHighlights, SeenPlace::kGrazing, SeenPlace::kRest}) {
    const PlaceError& at = reported.seen.at(place);
    places[NameOf(place)] = {{"share", at.share},
                             {"squares", at.squares},
                             {"mean_delta_e", at.mean_delta_e},
                             {"lightness", at.lightness},
                             {"color", at.color}};
  }
  Json whole;
  if (verdict.basis.whole) {
    whole = {{"mean_delta_e", verdict.basis.whole->mean_delta_e},
             {"psnr_db", verdict.basis.whole->psnr_db}};
  }
  return {{"words", Words(verdict)},
          {"visibility", VisibilityName(verdict)},
          {"measured_share", verdict.basis.measured_share},
          {"whole", whole},
          {"place", NameOf(verdict.place)},
          {"fault", NameOf(verdict.fault)},
          {"of", reported.of_sphere ? "sphere" : "samples"},
          {"psnr_db", reported.seen.psnr_db},
          {"mean_delta_e", reported.seen.mean_delta_e},
          {"delta_e_95", reported.seen.delta_e_95},
          {"places", places},
          {"advice", advice}};
}

}  // namespace trilobe
