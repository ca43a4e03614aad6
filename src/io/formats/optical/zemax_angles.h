#ifndef TRILOBE_IO_FORMATS_OPTICAL_ZEMAX_ANGLES_H_
#define TRILOBE_IO_FORMATS_OPTICAL_ZEMAX_ANGLES_H_

#include "trilobe/core/base/directions.h"

namespace trilobe {

// The four angles of Zemax's files [rad]. The light comes from theta = `incidence`, phi = 180
// degrees - `rotation`. wo is at the angle `radial` from the mirror direction, and at `azimuth`
// about it: 0 is towards the normal, and azimuths run counterclockwise about that direction as it
// leaves the sample.
struct ZemaxAngles {
  double rotation = 0, incidence = 0, azimuth = 0, radial = 0;
};
SphericalAngles ToSphericalAngles(const ZemaxAngles& at);

// The inverse: rotation and azimuth from 0 to 2 pi, radial from 0 to pi.
ZemaxAngles ToZemaxAngles(const DirectionPair& pair);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_OPTICAL_ZEMAX_ANGLES_H_
