#include "model/spectral_color.h"

#include <algorithm>
#include <sstream>
#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Every 5 nm: the colour-matching functions of the CIE 1931 standard observer (ISO/CIE 11664-1) and
// the relative power of illuminant D65 (ISO/CIE 11664-2; between multiples of 10 nm linear, as it
// is defined), both as in CIE 15:2004, tables T.4 and T.1.
struct Band {
  double x, y, z, d65;
};
constexpr double kFirst = 380, kBandStep = 5;  // [nm]
constexpr Band kBands[] = {
    {0.001368, 3.9e-05, 0.00645, 49.9755},  // 380
    {0.002236, 6.4e-05, 0.01055, 52.3118},  // 385
    {0.004243, 0.00012, 0.02005, 54.6482},  // 390
    {0.00765, 0.000217, 0.03621, 68.7015},  // 395
    {0.01431, 0.000396, 0.06785, 82.7549},  // 400
    {0.02319, 0.00064, 0.1102, 87.1205},    // 405
    {0.04351, 0.00121, 0.2074, 91.486},     // 410
    {0.07763, 0.00218, 0.3713, 92.4589},    // 415
    {0.13438, 0.004, 0.6456, 93.4318},      // 420
    {0.21477, 0.0073, 1.03905, 90.0571},    // 425
    {0.2839, 0.0116, 1.3856, 86.6823},      // 430
    {0.3285, 0.01684, 1.62296, 95.7736},    // 435
    {0.34828, 0.023, 1.74706, 104.865},     // 440
    {0.34806, 0.0298, 1.7826, 110.936},     // 445
    {0.3362, 0.038, 1.77211, 117.008},      // 450
    {0.3187, 0.048, 1.7441, 117.41},        // 455
    {0.2908, 0.06, 1.6692, 117.812},        // 460
    {0.2511, 0.0739, 1.5281, 116.337},      // 465
    {0.19536, 0.09098, 1.28764, 114.861},   // 470
    {0.1421, 0.1126, 1.0419, 115.392},      // 475
    {0.09564, 0.13902, 0.81295, 115.923},   // 480
    {0.05795, 0.1693, 0.6162, 112.367},     // 485
    {0.03201, 0.20802, 0.46518, 108.811},   // 490
    {0.0147, 0.2586, 0.3533, 109.083},      // 495
    {0.0049, 0.323, 0.272, 109.355},        // 500
    {0.0024, 0.4073, 0.2123, 108.578},      // 505
    {0.0093, 0.503, 0.1582, 107.802},       // 510
    {0.0291, 0.6082, 0.1117, 106.296},      // 515
    {0.06327, 0.71, 0.07825, 104.79},       // 520
    {0.1096, 0.7932, 0.05725, 106.24},      // 525
    {0.1655, 0.862, 0.04216, 107.689},      // 530
    {0.22575, 0.91485, 0.02984, 106.047},   // 535
    {0.2904, 0.954, 0.0203, 104.406},       // 540
    {0.3597, 0.9803, 0.0134, 104.226},      // 545
    {0.43345, 0.99495, 0.00875, 104.046},   // 550
    {0.51205, 1, 0.00575, 102.023},         // 555
    {0.5945, 0.995, 0.0039, 100},           // 560
    {0.6784, 0.9786, 0.00275, 98.1671},     // 565
    {0.7621, 0.952, 0.0021, 96.3342},       // 570
    {0.8425, 0.9154, 0.0018, 96.0611},      // 575
    {0.9163, 0.87, 0.00165, 95.788},        // 580
    {0.9786, 0.8163, 0.0014, 92.2368},      // 585
    {1.0263, 0.757, 0.0011, 88.6856},       // 590
    {1.0567, 0.6949, 0.001, 89.3459},       // 595
    {1.0622, 0.631, 0.0008, 90.0062},       // 600
    {1.0456, 0.5668, 0.0006, 89.8026},      // 605
    {1.0026, 0.503, 0.00034, 89.5991},      // 610
    {0.9384, 0.4412, 0.00024, 88.6489},     // 615
    {0.85445, 0.381, 0.00019, 87.6987},     // 620
    {0.7514, 0.321, 0.0001, 85.4937},       // 625
    {0.6424, 0.265, 5e-05, 83.2886},        // 630
    {0.5419, 0.217, 3e-05, 83.4939},        // 635
    {0.4479, 0.175, 2e-05, 83.6992},        // 640
    {0.3608, 0.1382, 1e-05, 81.863},        // 645
    {0.2835, 0.107, 0, 80.0268},            // 650
    {0.2187, 0.0816, 0, 80.1207},           // 655
    {0.1649, 0.061, 0, 80.2146},            // 660
    {0.1212, 0.04458, 0, 81.2462},          // 665
    {0.0874, 0.032, 0, 82.2778},            // 670
    {0.0636, 0.0232, 0, 80.281},            // 675
    {0.04677, 0.017, 0, 78.2842},           // 680
    {0.0329, 0.01192, 0, 74.0027},          // 685
    {0.0227, 0.00821, 0, 69.7213},          // 690
    {0.01584, 0.005723, 0, 70.6652},        // 695
    {0.011359, 0.004102, 0, 71.6091},       // 700
    {0.008111, 0.002929, 0, 72.9791},       // 705
    {0.00579, 0.002091, 0, 74.349},         // 710
    {0.004109, 0.001484, 0, 67.9765},       // 715
    {0.002899, 0.001047, 0, 61.604},        // 720
    {0.002049, 0.00074, 0, 65.7448},        // 725
    {0.00144, 0.00052, 0, 69.8856},         // 730
    {0.001, 0.000361, 0, 72.4863},          // 735
    {0.00069, 0.000249, 0, 75.087},         // 740
    {0.000476, 0.000172, 0, 69.3398},       // 745
    {0.000332, 0.00012, 0, 63.5927},        // 750
    {0.000235, 8.5e-05, 0, 55.0054},        // 755
    {0.000166, 6e-05, 0, 46.4182},          // 760
    {0.000117, 4.2e-05, 0, 56.6118},        // 765
    {8.3e-05, 3e-05, 0, 66.8054},           // 770
    {5.9e-05, 2.1e-05, 0, 65.0941},         // 775
    {4.2e-05, 1.5e-05, 0, 63.3828},         // 780
};

void CheckWavelengths(std::span<const double> wavelengths, const std::string& source) {
  constexpr double kMaxGap = 50;
  const auto fail = [&](ErrorKind kind, double wavelength, const auto&... parts) {
    std::ostringstream message;
    message << source << ": ";
    (message << ... << parts);
    throw Error(kind, message.str()).At(source).About("wavelengths", wavelength);
  };
  for (size_t k = 1; k < wavelengths.size(); ++k) {
    if (!(wavelengths[k] > wavelengths[k - 1])) {
      fail(ErrorKind::kRange, wavelengths[k], "wavelength ", wavelengths[k], " nm comes after ",
           wavelengths[k - 1], " nm; wavelengths must ascend");
    }
    if (wavelengths[k] - wavelengths[k - 1] > kMaxGap) {
      fail(ErrorKind::kMissing, wavelengths[k], "no wavelength between ", wavelengths[k - 1],
           " and ", wavelengths[k], " nm; a colour needs one every 50 nm");
    }
  }
  if (wavelengths.empty() || !(wavelengths.front() <= 400 + kMaxGap) ||
      !(wavelengths.back() >= 700 - kMaxGap)) {
    fail(ErrorKind::kMissing, wavelengths.empty() ? 0 : wavelengths.back(),
         "wavelengths do not reach from 450 to 650 nm or further, which a colour needs");
  }
}

}  // namespace

SpectralColor::SpectralColor(std::span<const double> wavelengths, const std::string& source)
    : wavelengths_(wavelengths.begin(), wavelengths.end()), weights_(wavelengths.size()) {
  CheckWavelengths(wavelengths, source);
  Rgb white{};
  double at = kFirst;
  for (const Band& band : kBands) {
    const auto above = std::ranges::upper_bound(wavelengths, at);
    const auto k = static_cast<size_t>(above - wavelengths.begin());
    const bool between = k > 0 && k < wavelengths.size();
    const double t =
        between ? (at - wavelengths[k - 1]) / (wavelengths[k] - wavelengths[k - 1]) : 0;
    for (int c = 0; c < kChannels; ++c) {
      const double weight =
          band.d65 * (kToSrgb[c][0] * band.x + kToSrgb[c][1] * band.y + kToSrgb[c][2] * band.z);
      weights_[k > 0 ? k - 1 : 0][c] += (1 - t) * weight;
      if (between) weights_[k][c] += t * weight;
      white[c] += weight;
    }
    at += kBandStep;
  }
  for (Rgb& weights : weights_) {
    for (int c = 0; c < kChannels; ++c) weights[c] /= white[c];
  }
}

SpectralColor SpectralColor::OfBands(std::span<const double> wavelengths,
                                     const std::string& source) {
  if (wavelengths.size() != 1) return {wavelengths, source};
  SpectralColor grey;
  grey.wavelengths_.assign(1, wavelengths[0]);
  grey.weights_.assign(1, {1, 1, 1});
  return grey;
}

Rgb SpectralColor::operator()(std::span<const double> spectrum) const {
  Rgb rgb{};
  for (size_t k = 0; k < weights_.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) rgb[c] += weights_[k][c] * spectrum[k];
  }
  return rgb;
}

}  // namespace trilobe
