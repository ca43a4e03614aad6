#include <algorithm>
#include <cmath>

#include "model/corruption/kinds.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/math/angles.h"

namespace trilobe {

void LoseAtRandom(double strength, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    if (UniformAt(seed, readings->number(j)) < strength) readings->Lose(j);
  });
}

void LoseCone(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    if (2 * readings->ThetaD(j) < DegreesToRadians(strength)) readings->Lose(j);
  });
}

void LoseBeyond(double strength, uint64_t /*seed*/, Readings* readings) {
  const double least = strength < 90 ? std::cos(DegreesToRadians(strength)) : 0;
  readings->ForEach([&](int j) {
    const Cosines cosines = readings->CosinesOf(j);
    if (std::min(cosines.i, cosines.o) < least) readings->Lose(j);
  });
}

void LoseSide(double strength, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    const DirectionPair pair = readings->Directions(j);
    const bool left = pair.wi[0] * pair.wo[1] > pair.wi[1] * pair.wo[0];
    // A bin stands for both sides, and for both orders of its directions: one of these is missing.
    const Cosines cosines = readings->CosinesOf(j);
    const bool there = readings->folds_sides() ? cosines.i > cosines.o : left;
    if (there && UniformAt(seed, readings->number(j)) < strength) readings->Lose(j);
  });
}

}  // namespace trilobe
