#ifndef TRILOBE_MODEL_APPEARANCE_COLOR_H_
#define TRILOBE_MODEL_APPEARANCE_COLOR_H_

#include <array>

#include "trilobe/core/base/channels.h"

namespace trilobe {

// Luminance of linear sRGB colours (ITU-R BT.709).
double Luminance(const Rgb& linear);

// The sRGB curve (IEC 61966-2-1) and its inverse; the input is clipped to [0, 1].
double EncodeSrgb(double linear);
double LinearizeSrgb(double code);

// CIELAB of a linear sRGB colour, for the white of sRGB (D65, CIE 1931 observer): L from 0 to 100.
using Lab = std::array<double, 3>;
Lab ToLab(const Rgb& linear);

// CIE 1976 colour difference: the distance in CIELAB.
double LabDifference(const Lab& a, const Lab& b);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_COLOR_H_
