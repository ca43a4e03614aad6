#include "io/formats/spectrum_bands.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "core/base/text.h"
#include "core/files/text_lines.h"
#include "io/formats/spectrum.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr int kDigits = 6;

std::string Nm(double wavelength) { return Text(wavelength, kDigits) + " nm"; }

// Text such as "405, 532 and 650 nm"; of many wavelengths, the two nearest to `at`.
std::string Known(std::span<const double> wavelengths, double at) {
  constexpr size_t kMost = 12;
  std::string text;
  if (wavelengths.size() <= kMost) {
    for (size_t k = 0; k < wavelengths.size(); ++k) {
      text += k == 0 ? "" : k + 1 == wavelengths.size() ? " and " : ", ";
      text += Text(wavelengths[k], kDigits);
    }
    return text + " nm";
  }
  std::vector<double> near(wavelengths.begin(), wavelengths.end());
  std::ranges::sort(near, {}, [at](double x) { return std::abs(x - at); });
  const auto [low, high] = std::ranges::minmax(wavelengths);
  return std::to_string(wavelengths.size()) + " from " + Text(low, kDigits) + " to " + Nm(high) +
         ", of which " + Text(near[0], kDigits) + " and " + Nm(near[1]) + " are the nearest";
}

// The index of the wavelength that a person means by this number.
size_t Nearest(std::span<const double> wavelengths, double chosen, const std::string& source) {
  constexpr double kMeant = 0.5;
  const auto off = [&](double wavelength) { return std::abs(wavelength - chosen); };
  const auto nearest = std::ranges::min_element(wavelengths, {}, off);
  if (nearest == wavelengths.end() || !(off(*nearest) <= kMeant)) {
    throw ErrorIn(ErrorKind::kMissing, source,
                  "no wavelength of " + Nm(chosen) + " for --bands; there " +
                      (wavelengths.size() == 1 ? "is " : "are ") + Known(wavelengths, chosen))
        .About("bands", chosen);
  }
  return nearest - wavelengths.begin();
}

// Advice on flags if all wavelengths make no colour.
std::string Advice(std::span<const double> wavelengths) {
  std::vector<double> from_longest(wavelengths.begin(), wavelengths.end());
  std::ranges::sort(from_longest, std::greater<>());
  const auto text = [&](size_t k) { return Text(from_longest[k], kDigits); };
  const auto same_text = [](double a, double b) { return Text(a, kDigits) == Text(b, kDigits); };
  from_longest.erase(std::unique(from_longest.begin(), from_longest.end(), same_text),
                     from_longest.end());
  const size_t last = from_longest.size() - 1, middle = from_longest.size() / 2;
  std::string three;
  if (last >= 2) {
    three = " --bands=" + text(0) + "," + text(middle) + "," + text(last) +
            " takes three as r, g and b, and";
  }
  return ";" + three + " --bands=" + text(middle) + " takes one alone";
}

}  // namespace

std::vector<double> ParseBands(std::string_view bands) {
  std::vector<double> wavelengths;
  if (bands.empty()) return wavelengths;
  const auto fail = [&] {
    throw Error(ErrorKind::kFormat,
                "--bands=" + std::string(bands) +
                    ": give a wavelength in nm, as 550, three to be r, g and b, as 650,550,450, or "
                    "more to make a colour of")
        .About("bands", bands);
  };
  for (std::string_view cell : SplitCells(bands)) {
    if (cell.ends_with("nm")) cell = Trimmed(cell.substr(0, cell.size() - 2));
    const std::optional<double> wavelength = ToNumber(cell);
    if (!wavelength || !(*wavelength > 0 && std::isfinite(*wavelength))) fail();
    wavelengths.push_back(*wavelength);
  }
  std::ranges::sort(wavelengths);
  if (wavelengths.size() == 2 || std::ranges::adjacent_find(wavelengths) != wavelengths.end()) {
    fail();
  }
  return wavelengths;
}

SpectrumBands::SpectrumBands(std::span<const double> wavelengths, std::string_view chosen,
                             const std::string& source)
    : all_(wavelengths.size()) {
  const std::vector<double> bands = ParseBands(chosen);
  for (const double band : bands) {
    const size_t k = Nearest(wavelengths, band, source);
    if (std::ranges::find(read_, k) != read_.end()) {
      throw ErrorIn(ErrorKind::kConflict, source,
                    "--bands=" + std::string(chosen) + " names " + Nm(wavelengths[k]) + " twice")
          .About("bands", wavelengths[k]);
    }
    read_.push_back(k);
  }
  if (bands.empty()) {
    read_.resize(all_);
    std::iota(read_.begin(), read_.end(), size_t{0});
  }
  if (bands.size() == kChannels) {
    std::ranges::reverse(read_);  // r has the longest
  } else {
    try {
      color_ = SpectralColor::OfBands(Read(wavelengths), source);
    } catch (const Error& error) {
      if (!bands.empty() || wavelengths.empty()) throw;
      throw error.WithMessage(std::string(error.what()) + Advice(wavelengths));
    }
  }
  if (read_.size() > kChannels) return;
  for (const size_t k : read_) {
    names_ += (names_.empty() ? "" : ", ") + Text(wavelengths[k], kDigits);
  }
  names_ += " nm";
}

std::span<const double> SpectrumBands::Read(std::span<const double> spectrum) {
  if (read_.size() == all_ && color_) return spectrum;  // in this order
  row_.clear();
  for (const size_t k : read_) row_.push_back(spectrum[k]);
  return row_;
}

Rgb SpectrumBands::ColorOf(std::span<const double> spectrum) {
  const std::span<const double> read = Read(spectrum);
  return color_ ? (*color_)(read) : Rgb{read[0], read[1], read[2]};
}

void SpectrumBands::Add(const SphericalAngles& angles, std::span<const double> spectrum,
                        SampleCollector* collector, bool nan_is_gap) {
  const std::span<const double> read = Read(spectrum);
  if (nan_is_gap && std::ranges::any_of(read, [](double x) { return std::isnan(x); })) {
    collector->LeaveOut(&BinCounts::missing);
  } else if (color_) {
    AddSpectrum(angles, read, *color_, collector);
  } else {
    collector->Add(angles, {read[0], read[1], read[2]});
  }
}

std::string SpectrumBands::Note() const {
  const std::string of_all = std::to_string(all_) + " wavelengths";
  if (are_channels()) return names_ + " of " + of_all + " as r, g, b";
  if (read_.size() == 1) return all_ == 1 ? names_ : names_ + " of " + of_all;
  const std::string to_rgb = " to RGB by CIE 1931";
  if (read_.size() < all_) return std::to_string(read_.size()) + " of " + of_all + to_rgb;
  return of_all + to_rgb + " (--bands picks some)";
}

}  // namespace trilobe
