#include "io/formats/spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilobe {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

double Determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// x of m x = b, by Cramer's rule.
std::array<double, 3> SolveByCramer(const Matrix& m, const std::array<double, 3>& b) {
  const double whole = Determinant(m);
  std::array<double, 3> x{};
  for (int k = 0; k < 3; ++k) {
    Matrix replaced = m;
    for (int row = 0; row < 3; ++row) replaced[row][k] = b[row];
    x[k] = Determinant(replaced) / whole;
  }
  return x;
}

// Adds the colour of values that are all valid; else a sample that counts by what they are. Whether
// the sample is valid.
template <typename Color>
bool AddColorOf(const SphericalAngles& angles, std::span<const double> values, const Color& color,
                SampleCollector* collector) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!std::ranges::all_of(values, [](double x) { return std::isfinite(x); })) {
    collector->Add(angles, {kNan, kNan, kNan});
  } else if (std::ranges::any_of(values, [](double x) { return x < 0; })) {
    collector->Add(angles, {-1, -1, -1});
  } else {
    return collector->AddColor(angles, color(values));
  }
  return false;
}

}  // namespace

void AddSpectrum(const SphericalAngles& angles, std::span<const double> spectrum,
                 const SpectralColor& color, SampleCollector* collector) {
  if (AddColorOf(angles, spectrum, color, collector)) {
    collector->KeepSpectrum(color.wavelengths(), spectrum);
  }
}

void AddTristimulus(const SphericalAngles& angles, const std::array<double, 3>& xyz,
                    SampleCollector* collector) {
  const auto color = [](std::span<const double> values) {
    Rgb rgb{};
    for (int c = 0; c < kChannels; ++c) {
      for (int k = 0; k < 3; ++k) rgb[c] += kToSrgb[c][k] * kWhite[k] * values[k];
    }
    return rgb;
  };
  AddColorOf(angles, xyz, color, collector);
}

std::array<double, 3> TristimulusOf(const Rgb& rgb) {
  Matrix to_rgb{};
  for (int c = 0; c < kChannels; ++c) {
    for (int k = 0; k < 3; ++k) to_rgb[c][k] = kToSrgb[c][k] * kWhite[k];
  }
  return SolveByCramer(to_rgb, rgb);
}

// --- Smooth spectra ------------------------------------------------------------------------------

namespace {

double SquaredDistance(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (int c = 0; c < kChannels; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

}  // namespace

SmoothSpectra::SmoothSpectra(std::span<const double> wavelengths)
    : color_(wavelengths, "the spectra to be written"),
      spectrum_(wavelengths.size()),
      derivative_(wavelengths.size()) {
  const double middle = (wavelengths.front() + wavelengths.back()) / 2;
  const double half = (wavelengths.back() - wavelengths.front()) / 2;
  for (const double wavelength : wavelengths) t_.push_back((wavelength - middle) / half);
}

Rgb SmoothSpectra::ColorOf(const Coefficients& c) {
  for (size_t k = 0; k < t_.size(); ++k) {
    const double x = (c[0] * t_[k] + c[1]) * t_[k] + c[2];
    const double root = 1 / std::sqrt(1 + x * x);
    spectrum_[k] = 0.5 + 0.5 * x * root;
    derivative_[k] = 0.5 * root * root * root;
  }
  return color_(spectrum_);
}

// Levenberg and Marquardt's steps; ends with the spectrum of *c in spectrum_. Returns the distance.
double SmoothSpectra::Solve(const Rgb& target, Coefficients* c) {
  constexpr int kMostSteps = 60;
  constexpr double kNear = 1e-14;  // squared distance, of a colour whose largest channel is 1/2
  double damping = 1e-6;
  Rgb is = ColorOf(*c);
  double distance = SquaredDistance(is, target);
  for (int step = 0; step < kMostSteps && distance > kNear; ++step) {
    // J[k] is the derivative of the colour by c_k: the colour of t^(2-k) dS/dx.
    std::array<Rgb, 3> j{};
    for (int k = 0; k < 3; ++k) {
      if (k > 0) {
        for (size_t l = 0; l < t_.size(); ++l) derivative_[l] *= t_[l];
      }
      j[2 - k] = color_(derivative_);
    }
    Matrix normal{};
    std::array<double, 3> slope{};
    for (int a = 0; a < 3; ++a) {
      for (int channel = 0; channel < kChannels; ++channel) {
        slope[a] -= j[a][channel] * (is[channel] - target[channel]);
        for (int b = 0; b < 3; ++b) normal[a][b] += j[a][channel] * j[b][channel];
      }
    }
    bool lower = false;
    for (int attempt = 0; attempt < 12 && !lower; ++attempt) {
      Matrix damped = normal;
      for (int k = 0; k < 3; ++k) damped[k][k] += damping * normal[k][k] + 1e-18;
      const std::array<double, 3> by = SolveByCramer(damped, slope);
      const Coefficients next = {(*c)[0] + by[0], (*c)[1] + by[1], (*c)[2] + by[2]};
      const Rgb color = ColorOf(next);
      const double there = SquaredDistance(color, target);
      lower = there < distance;
      damping = lower ? std::max(damping / 10, 1e-12) : damping * 10;
      if (lower) {
        *c = next;
        is = color;
        distance = there;
      }
    }
    if (!lower) break;
  }
  ColorOf(*c);
  return std::sqrt(distance);
}

std::span<const double> SmoothSpectra::operator()(const Rgb& rgb) {
  const Rgb positive = AtLeastZero(rgb);
  const double largest = std::max({positive[0], positive[1], positive[2]});
  error_ = 0;
  if (!(largest > 0)) {
    std::ranges::fill(spectrum_, 0.0);
    return spectrum_;
  }
  const double scale = 2 * largest;
  Rgb target{};
  for (int c = 0; c < kChannels; ++c) target[c] = positive[c] / scale;
  constexpr double kGood = 1e-5;
  Coefficients c = last_;
  double distance = Solve(target, &c);
  if (distance > kGood) {  // from grey, lest the place before has led astray
    Coefficients from_grey{};
    const double other = Solve(target, &from_grey);
    if (other < distance) {
      c = from_grey;
      distance = other;
    } else {
      ColorOf(c);
    }
  }
  // Colours that are too saturated drive c far away, from where others would not find back.
  if (distance <= kGood) last_ = c;
  error_ = distance / std::hypot(target[0], target[1], target[2]);
  for (double& value : spectrum_) value *= scale;
  return spectrum_;
}

}  // namespace trilobe
