#ifndef TRILOBE_IO_FORMATS_OPTICAL_KLEMS_BASIS_H_
#define TRILOBE_IO_FORMATS_OPTICAL_KLEMS_BASIS_H_

#include <string>
#include <vector>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// A ring of patches; the azimuth 0 is in the middle of the first.
struct KlemsRing {
  double begin, end;  // of theta [degrees]
  int patches;
};

// A division of the hemisphere, in which the matrices of Radiance and WINDOW have their rows and
// columns (Klems 1994).
struct KlemsBasis {
  std::string name;
  std::vector<KlemsRing> rings;
};

// Full, half and quarter.
const std::vector<KlemsBasis>& KlemsBases();

// Theta of the middle of a ring [degrees].
double MiddleOf(const KlemsRing& ring);

// The middles of the patches.
std::vector<PolarAngles> PatchesOf(const KlemsBasis& basis);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_OPTICAL_KLEMS_BASIS_H_
