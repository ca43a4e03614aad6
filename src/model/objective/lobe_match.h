#ifndef TRILOBE_MODEL_OBJECTIVE_LOBE_MATCH_H_
#define TRILOBE_MODEL_OBJECTIVE_LOBE_MATCH_H_

#include <vector>

#include "trilobe/model/read_model.h"

namespace trilobe {

// Similarity of the lobes of two models, from 0 to 1 (docs/study.md). All of it is independent of
// the gauge and of the order of the lobes.
struct LobeMatch {
  // The mean match of all lobes of both models with their partners, weighted by the light that
  // they reflect (LobeLight). 1 if no lobe of either reflects any.
  double agreement = 1;
  // The partner in `model` of each lobe of `reference`, or -1 where `model` has fewer.
  std::vector<int> lobe;
  // Similarity of the two, 0 without a partner: the light that they share, in each channel the
  // smaller of the two, over the larger, summed over the channels; times the cosines between their
  // tables of D, F and G. A lobe that is five times as strong matches to 0.2 at most.
  std::vector<double> match;
};

// The partners are those of the largest agreement; of equal ones the first in lexical order. Throws
// Error unless both models share tables alike and have them on the same axes. Lobes whose stretches
// differ do not match.
LobeMatch MatchLobes(const ModelFile& reference, const ModelFile& model);

// Whether MatchLobes can compare models of these specs.
bool HaveComparableLobes(const ModelSpec& a, const ModelSpec& b);

// The cosine between the tables in which two lobes read a factor, entries weighted by the projected
// solid angle of their directions. Of tables a channel, the mean, weighted by the light of both
// lobes in the channel, `light`. Entries that are unobserved in either model do not count.
double FactorCosine(Factor factor, const ModelFile& a, int a_lobe, const ModelFile& b, int b_lobe,
                    const Rgb& light);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_LOBE_MATCH_H_
