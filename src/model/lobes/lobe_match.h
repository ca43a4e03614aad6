#ifndef TRILOBE_MODEL_LOBES_LOBE_MATCH_H_
#define TRILOBE_MODEL_LOBES_LOBE_MATCH_H_

#include <vector>

#include "trilobe/model/evaluate/read_model.h"

namespace trilobe {

// How alike two lobes are, from 0 to 1: the product of the congruences (cosines of the angle
// between two arrays) of D, weighted by the projected solid angles of its entries, of G, of s, and
// of F if lobes have their own (Tomasi and Bro 2006, "factor match score"). 1 for lobes that differ
// in scale alone; 0 if either is black. Entries that no data touch in either model do not count.
// Independent of the gauge.
double LobeMatch(const ModelFile& a, int a_lobe, const ModelFile& b, int b_lobe);

// The lobes of a model in the order of another's.
struct LobeOrderMatch {
  std::vector<int> lobe;      // of `model`, for each lobe of `reference`
  std::vector<double> match;  // LobeMatch of the two
  double least() const;       // 1 without lobes
};

// The assignment of the largest sum of matches; of equal ones the first in lexical order. Throws
// Error unless both models have the same spec.
LobeOrderMatch MatchLobes(const ModelFile& reference, const ModelFile& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_LOBE_MATCH_H_
