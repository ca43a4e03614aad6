#include "model/appearance/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "trilobe/model/appearance/seen_error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The same differences everywhere: a tenth of the pixels in highlights, a fifth grazing.
SeenError Even(double mean, double at_95) {
  SeenError error{.psnr_db = 30, .mean_delta_e = mean, .delta_e_95 = at_95};
  const double shares[] = {0.1, 0.2, 0.7};
  for (size_t k = 0; k < kNumPlaces; ++k) {
    error.places[k] = {.share = shares[k], .squares = shares[k], .mean_delta_e = mean};
  }
  return error;
}

PlaceError& At(SeenPlace place, SeenError* error) {
  return error->places[static_cast<size_t>(place)];
}

// Three times the mean in one place, which has half of the squares.
SeenError MostIn(SeenPlace place, double mean, double at_95) {
  SeenError error = Even(mean, at_95);
  At(place, &error).mean_delta_e = 3 * mean;
  At(place, &error).squares = 0.5;
  return error;
}

TEST(Verdict, SaysHowMuchIsSeenByTheMeanAndByTheWorstOfIt) {
  const auto visibility = [](double mean, double at_95) {
    return VerdictOf(Even(mean, at_95)).visibility;
  };
  EXPECT_EQ(visibility(0, 0), Visibility::kNone);
  EXPECT_EQ(visibility(1, 2.3), Visibility::kNone);
  EXPECT_EQ(visibility(1.01, 1.5), Visibility::kHardly);
  EXPECT_EQ(visibility(0.5, 2.4), Visibility::kHardly);
  EXPECT_EQ(visibility(2.3, 5), Visibility::kHardly);
  EXPECT_EQ(visibility(2.4, 5), Visibility::kVisible);
  EXPECT_EQ(visibility(0.5, 9), Visibility::kVisible);  // a small highlight, far off
  EXPECT_EQ(visibility(5, 10), Visibility::kVisible);
  EXPECT_EQ(visibility(5.1, 9), Visibility::kPlain);
  EXPECT_EQ(visibility(2, 30), Visibility::kPlain);
}

TEST(Verdict, SaysWhere) {
  EXPECT_EQ(Words(VerdictOf(Even(0.4, 1))), "cannot be told apart");
  EXPECT_EQ(Words(VerdictOf(Even(2, 4))), "hardly visible side by side");
  EXPECT_EQ(Words(VerdictOf(Even(4, 8))), "visible all over");
  EXPECT_EQ(Words(VerdictOf(MostIn(SeenPlace::kGrazing, 2, 4))),
            "hardly visible side by side, most at grazing angles");
  EXPECT_EQ(Words(VerdictOf(MostIn(SeenPlace::kHighlights, 4, 8))), "visible in highlights");
  EXPECT_EQ(Words(VerdictOf(MostIn(SeenPlace::kGrazing, 6, 20))),
            "plainly visible at grazing angles");
  // Among two places, the one that stands out more is named.
  SeenError both = MostIn(SeenPlace::kHighlights, 4, 8);
  At(SeenPlace::kGrazing, &both) = {.share = 0.2, .squares = 0.4, .mean_delta_e = 8};
  EXPECT_EQ(VerdictOf(both).place, SeenPlace::kHighlights);
  // A few pixels are no place, however wrong they are.
  SeenError few = MostIn(SeenPlace::kHighlights, 4, 8);
  At(SeenPlace::kHighlights, &few).squares = 0.1;
  EXPECT_EQ(VerdictOf(few).place, SeenPlace::kRest);
}

TEST(Verdict, SaysWhatIsWrong) {
  SeenError error = MostIn(SeenPlace::kHighlights, 4, 8);
  PlaceError& highlights = At(SeenPlace::kHighlights, &error);
  highlights.lightness = -8;
  EXPECT_EQ(Words(VerdictOf(error)), "visible in highlights: too dark");
  highlights.lightness = 8;
  EXPECT_EQ(Words(VerdictOf(error)), "visible in highlights: too bright");
  highlights.lightness = 3;  // in some too dark, in others too bright
  EXPECT_EQ(Words(VerdictOf(error)), "visible in highlights");
  highlights.color = 0.8;
  EXPECT_EQ(Words(VerdictOf(error)), "visible in highlights: wrong colour");
  // Faults elsewhere do not matter then.
  error = MostIn(SeenPlace::kGrazing, 4, 8);
  At(SeenPlace::kRest, &error).color = 1;
  EXPECT_EQ(VerdictOf(error).fault, Fault::kDifferent);
  // All over, all count.
  error = Even(4, 8);
  for (PlaceError& place : error.places) place.color = 0.6;
  EXPECT_EQ(Words(VerdictOf(error)), "visible all over: wrong colour");
  for (PlaceError& place : error.places) place = {place.share, place.squares, 4, -3, 0.1};
  EXPECT_EQ(Words(VerdictOf(error)), "visible all over: too dark");
}

// Faults of an invisible difference are not named.
TEST(Verdict, OfWhatCannotBeSeenSaysNoMore) {
  SeenError error = MostIn(SeenPlace::kHighlights, 0.3, 1);
  At(SeenPlace::kHighlights, &error).color = 1;
  EXPECT_EQ(VerdictOf(error), Verdict());
}

TEST(Advice, IsToChooseAFormWhereTheFormIsTheLimit) {
  const Verdict seen{Visibility::kHardly}, same;
  const FitFacts facts{.may_choose_form = true};
  EXPECT_THAT(AdviceOn(seen, facts), ElementsAre(Advice::kChooseForm));
  EXPECT_THAT(AdviceOn(same, facts), IsEmpty());
  EXPECT_THAT(AdviceOn(seen, {}), IsEmpty());  // it has been chosen, or there is no choice
}

TEST(Advice, IsToChooseTheSolverBeforeTheForm) {
  EXPECT_THAT(AdviceOn({Visibility::kHardly}, {.may_choose_form = true, .default_solver = false}),
              ElementsAre(Advice::kChooseSolver));
}

TEST(Advice, IsToGoOnBeforeAnythingElse) {
  const Verdict seen{Visibility::kVisible}, same;
  EXPECT_THAT(AdviceOn(seen, {.ended = false, .may_choose_form = true}),
              ElementsAre(Advice::kIterate));
  EXPECT_THAT(AdviceOn(same, {.ended = false}), IsEmpty());  // good enough
  const FitFacts interrupted{.interrupted = true, .ended = false, .may_choose_form = true};
  EXPECT_THAT(AdviceOn(seen, interrupted), ElementsAre(Advice::kGoOn));
  EXPECT_THAT(AdviceOn(same, interrupted), ElementsAre(Advice::kGoOn));
}

TEST(Advice, TellsWhatNoModelFollows) {
  const Verdict seen{Visibility::kVisible}, same;
  EXPECT_THAT(AdviceOn(seen, {.irreducible = 0.45}), ElementsAre(Advice::kDataDiffer));
  EXPECT_THAT(AdviceOn(same, {.irreducible = 0.5}), IsEmpty());  // nor need one
  EXPECT_THAT(AdviceOn(seen, {.irreducible = 0.1}), IsEmpty());
  EXPECT_THAT(AdviceOn(seen, {.may_choose_form = true, .irreducible = 0.45}),
              ElementsAre(Advice::kChooseForm, Advice::kDataDiffer));
  // How much it is of the rest is not known before the end.
  EXPECT_THAT(AdviceOn(seen, {.ended = false, .irreducible = 0.45}), ElementsAre(Advice::kIterate));
  EXPECT_THAT(AdviceOn(seen, {.left_out = 0.12}), ElementsAre(Advice::kAnisotropic));
  EXPECT_THAT(AdviceOn(seen, {.left_out = 0.001}), IsEmpty());
  EXPECT_THAT(AdviceOn({}, {.ripple = 0.012}), ElementsAre(Advice::kRings));
  EXPECT_THAT(AdviceOn({}, {.ripple = 0}), IsEmpty());
}

// A renderer asks for all directions, and a verdict is of what was measured.
TEST(Verdict, SaysWhatItRestsOn) {
  const SeenError same;  // no difference
  const auto words = [&](const Basis& basis) { return Words(VerdictOf(same, basis)); };
  const auto visibility = [&](const Basis& basis) {
    return VisibilityName(VerdictOf(same, basis));
  };
  EXPECT_EQ(words({}), "cannot be told apart");
  EXPECT_EQ(words({.measured_share = 0.97}), "cannot be told apart");
  EXPECT_EQ(
      words({.measured_share = 0.8}),
      "cannot be told apart where it was measured, at 80 % of what a renderer reads; the rest "
      "is a guess");
  EXPECT_EQ(visibility({.measured_share = 0.8}), "none");
  const Basis scans{.measured_share = 0.2};
  EXPECT_EQ(words(scans),
            "no verdict: only 20 % of what a renderer reads was measured; there cannot be told "
            "apart");
  EXPECT_EQ(visibility(scans), "unknown");
  const Basis few{.measured_share = 1, .samples = 300, .parameters = 339};
  EXPECT_EQ(words(few),
            "no verdict: 300 samples are fewer than 339 parameters; at the samples cannot be told "
            "apart");
  EXPECT_EQ(visibility(few), "unknown");
  const Basis rehearsed{.measured_share = 0.3, .whole = WholeSphere{3.14, 26.4}};
  EXPECT_EQ(words(rehearsed),
            "no verdict: only 30 % of what a renderer reads was measured; there cannot be told "
            "apart; the whole off by about Delta E 3.1, 26 dB");
  EXPECT_EQ(visibility(rehearsed), "unknown");
  const Basis black{.black = true};
  EXPECT_EQ(words(black), "no verdict: what was measured reflects nothing");
  EXPECT_EQ(visibility(black), "unknown");
}

// The guess is probably as wrong as estimated, within a factor of two.
TEST(Verdict, IsBoundedByWhatTheGuessIsWorth) {
  const SeenError same;
  const auto verdict = [&](double mean_delta_e, double share) {
    return VerdictOf(same, {.measured_share = share, .whole = WholeSphere{mean_delta_e, 31.4}});
  };
  EXPECT_EQ(Words(verdict(0.84, 0.8)),
            "cannot be told apart where it was measured, at 80 % of what a renderer reads; the "
            "rest is a guess, and the whole off by about Delta E 0.84, 31 dB");
  EXPECT_EQ(VisibilityName(verdict(1.9, 0.8)), "none");
  EXPECT_EQ(Words(verdict(1.9, 0.97)), "cannot be told apart");
  EXPECT_EQ(Words(verdict(2.1, 0.97)),
            "hardly visible side by side as a whole: cannot be told apart where it was measured, "
            "at 97 % of what a renderer reads; the rest is a guess, and the whole off by about "
            "Delta E 2.1, 31 dB");
  EXPECT_EQ(VisibilityName(verdict(2.1, 0.97)), "hardly");
  EXPECT_EQ(VisibilityName(verdict(6, 0.8)), "visible");
  EXPECT_EQ(VisibilityName(verdict(12, 0.8)), "plain");
  EXPECT_EQ(VisibilityName(verdict(12, 0.4)), "unknown");
  // It makes nothing better, and advice is on what was measured.
  const Verdict seen{Visibility::kPlain, {}, {}, {.whole = WholeSphere{0.5, 50}}};
  EXPECT_EQ(VisibilityName(seen), "plain");
  EXPECT_THAT(AdviceOn(verdict(12, 0.8), {.irreducible = 0.5}), IsEmpty());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
