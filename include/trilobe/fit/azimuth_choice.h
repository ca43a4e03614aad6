#ifndef TRILOBE_FIT_AZIMUTH_CHOICE_H_
#define TRILOBE_FIT_AZIMUTH_CHOICE_H_

#include <string>

namespace trilobe {

// Choice of an isotropic or an anisotropic model for samples whose azimuths are given.
struct AzimuthChoice {
  bool matter = true;  // the material depends on the azimuth of the light: the model is anisotropic
  std::string why;     // "held-out samples are predicted better: ..."
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_AZIMUTH_CHOICE_H_
