#ifndef TRILOBE_MODEL_APPEARANCE_VERDICT_H_
#define TRILOBE_MODEL_APPEARANCE_VERDICT_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/model/appearance/seen_error.h"

namespace trilobe {

// How visible the difference of a fit and its measurement is side by side, by the CIELAB difference
// of 1976. Thresholds of the mean and of the 95th percentile over the pixels:
//
//   kNone     1, 2.3   1 is about the smallest difference of two patches side by side that a
//                      trained eye sees; 2.3 is just noticeable: Mahy, Van Eycken and Oosterlinck,
//                      Evaluation of Uniform Color Spaces, Color Research & Application 19(2), 1994
//   kHardly   2.3, 5   from 5 on patches are seen as two colours: Mokrzycki and Tatol, Colour
//                      difference Delta E: a survey, Machine Graphics & Vision 20(4), 2011
//   kVisible  5, 10
//   kPlain    beyond
//
// The thresholds were measured on patches, not spheres; docs/appearance.md tests them on images.
enum class Visibility { kNone, kHardly, kVisible, kPlain };

// Kind of error in the region that differs most: `place`, or kRest if none stands out.
enum class Fault { kDifferent, kTooDark, kTooBright, kWrongColor };

// Evidence for a verdict.
struct Basis {
  double measured_share = 1;        // of what a renderer reads (MeasuredShare)
  int samples = 0, parameters = 0;  // of the fit
  bool black = false;               // the measurement reflects nothing
  // Error expected over all directions, including those not measured; nothing if unknown.
  std::optional<WholeSphere> whole = {};

  bool operator==(const Basis&) const = default;
};

// A verdict on what was measured. It says nothing about the whole material if less than half of
// what a renderer reads was measured, if the model has more parameters than there were samples, or
// if all is black.
struct Verdict {
  Visibility visibility = Visibility::kNone;
  SeenPlace place = SeenPlace::kRest;
  Fault fault = Fault::kDifferent;
  Basis basis = {};

  bool of_the_whole() const;
  // At least kHardly, kVisible or kPlain if the mean difference expected of the whole exceeds 2,
  // 4.6 or 10, twice the bounds for what was compared; such estimates are right within a factor of
  // two.
  Visibility visibility_of_whole() const;
  bool operator==(const Verdict&) const = default;
};

Verdict VerdictOf(const SeenError& error, const Basis& basis = {});

// "cannot be told apart"; "visible in highlights: too dark where it was measured, at 80 % of what a
// renderer reads; the rest is a guess, ..."; "no verdict: ..."
std::string Words(const Verdict& verdict);
// Name of visibility_of_whole(); "unknown" unless of_the_whole().
std::string VisibilityName(const Verdict& verdict);
std::string NameOf(Visibility visibility);  // "none", "hardly", "visible", "plain"
std::string NameOf(Fault fault);            // "different", "too_dark", ...

// Other facts about a fit, on which advice depends.
struct FitFacts {
  bool interrupted = false;
  bool ended = true;  // the solver found what it looks for; false: a limit stopped it
  // The form is the default one of an isotropic table, and --model=auto could be asked for.
  bool may_choose_form = false;
  bool default_solver = true;
  double irreducible = 0;  // share of E due to exchanged directions that differ in the data
  // Share of the energy that an isotropic model of anisotropic data leaves out; nothing for other
  // models.
  std::optional<double> left_out = {};
  // The largest directional albedo of a model that makes light, and its theta_i [rad].
  double glow = 0, glow_theta_i = 0;
  // Relative deviation of the directional albedo from its course over neighbouring angles, if
  // uniform light shows it; and its theta_i [rad].
  double ripple = 0, ripple_theta_i = 0;
};

// Things to do or to know, most urgent first.
enum class Advice {
  kGoOn,          // it was interrupted
  kIterate,       // a limit stopped it
  kAnisotropic,   // the form ignores azimuths
  kChooseSolver,  // another solver than the default one may be the limit
  kChooseForm,    // the form is the limit
  kDataDiffer,    // the remaining error is largely noise or not reciprocal
  kGlows,         // it reflects more light than it receives
  kRings,         // what it reflects jumps with the angle
};
std::vector<Advice> AdviceOn(const Verdict& verdict, const FitFacts& facts);
std::string NameOf(Advice advice);  // "go_on", "iterate", ...

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_VERDICT_H_
