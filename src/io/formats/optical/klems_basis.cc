#include "io/formats/optical/klems_basis.h"

namespace trilobe {

const std::vector<KlemsBasis>& KlemsBases() {
  static const std::vector<KlemsBasis> bases = {
      {"LBNL/Klems Full",
       {{0, 5, 1},
        {5, 15, 8},
        {15, 25, 16},
        {25, 35, 20},
        {35, 45, 24},
        {45, 55, 24},
        {55, 65, 24},
        {65, 75, 16},
        {75, 90, 12}}},
      {"LBNL/Klems Half",
       {{0, 6.5, 1},
        {6.5, 19.5, 8},
        {19.5, 32.5, 12},
        {32.5, 46.5, 16},
        {46.5, 61.5, 20},
        {61.5, 76.5, 12},
        {76.5, 90, 4}}},
      {"LBNL/Klems Quarter", {{0, 9, 1}, {9, 27, 8}, {27, 46, 12}, {46, 66, 12}, {66, 90, 8}}},
  };
  return bases;
}

double MiddleOf(const KlemsRing& ring) {
  return ring.begin == 0 && ring.patches == 1 ? 0 : (ring.begin + ring.end) / 2;
}

std::vector<PolarAngles> PatchesOf(const KlemsBasis& basis) {
  std::vector<PolarAngles> patches;
  for (const KlemsRing& ring : basis.rings) {
    for (int k = 0; k < ring.patches; ++k) {
      patches.push_back({DegreesToRadians(MiddleOf(ring)), 2 * kPi * k / ring.patches});
    }
  }
  return patches;
}

}  // namespace trilobe
