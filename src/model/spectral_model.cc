#include "trilobe/model/spectral_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "model/spectral_color.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/value_of.h"

namespace trilobe {
namespace {

constexpr const char* kName = "the spectral model";

void CheckBands(const ModelSpec& spec, std::span<const double> wavelengths) {
  const auto fail = [](ErrorKind kind, const char* key, const std::string& problem) {
    throw Error(kind, kName + (": " + problem)).About(key);
  };
  if (spec.D.per_channel || spec.G.per_channel) {
    fail(ErrorKind::kUnsupported, "D, G", "its bands must share D and G");
  }
  if (wavelengths.empty() || wavelengths.size() > SpectralModel::kMaxBands) {
    fail(ErrorKind::kRange, "bands",
         "it has " + std::to_string(wavelengths.size()) + " wavelengths; it needs 1 to " +
             std::to_string(SpectralModel::kMaxBands));
  }
  if (!std::ranges::all_of(wavelengths, [](double x) { return x > 0 && std::isfinite(x); })) {
    fail(ErrorKind::kRange, "wavelengths", "its wavelengths must be finite and above 0 nm");
  }
  SpectralColor::OfBands(wavelengths, kName);  // its errors
}

int TablesOfF(const ModelSpec& spec, int bands) {
  return (spec.F.per_lobe ? spec.lobes : std::min(spec.lobes, 1)) *
         (spec.F.per_channel ? bands : 1);
}

}  // namespace

SpectralModel::SpectralModel(const ModelSpec& spec, std::vector<double> wavelengths)
    : wavelengths_(std::move(wavelengths)), shared_(spec) {
  CheckBands(spec, wavelengths_);
  d_.resize(bands());
  s_.resize(static_cast<size_t>(spec.lobes) * bands());
  F_.resize(TablesOfF(spec, bands()) * F_size());
}

int SpectralModel::num_parameters() const {
  const auto size = [this](Factor factor) {
    return spec().num_tables(factor) * spec().table_size(factor);
  };
  return static_cast<int>(d_.size() + s_.size() + F_.size()) + size(Factor::kD) + size(Factor::kG);
}

FactorModel SpectralModel::ThreeBands(int first) const {
  FactorModel three = shared_;
  for (int c = 0; c < kChannels; ++c) {
    const int band = std::min(first + c, bands() - 1);
    three.d()[c] = d_[band];
    for (int m = 0; m < spec().lobes; ++m) {
      three.s(m)[c] = s(m)[band];
      std::ranges::copy(F(m, band),
                        three.table(Factor::kF, spec().table(Factor::kF, m, c)).begin());
    }
  }
  return three;
}

FactorModel SpectralModel::ToRgb() const {
  if (bands() == 1) return ThreeBands(0);
  const std::vector<Rgb> weights = SpectralColor::OfBands(wavelengths_, kName).weights();
  ModelSpec coloured = spec();
  // Lobes no longer share F: its shape in a channel is a mean over the bands, weighted by s.
  if (coloured.F.per_channel) coloured.F.per_lobe = true;
  FactorModel rgb(coloured);
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < coloured.num_tables(factor); ++t) {
      std::ranges::copy(table(factor, t), rgb.table(factor, t).begin());
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    const auto mixed = [&](const auto& of_band) {
      double sum = 0;
      for (int l = 0; l < bands(); ++l) sum += weights[l][c] * of_band(l);
      return std::max(sum, 0.0);
    };
    rgb.d()[c] = mixed([&](int l) { return d_[l]; });
    for (int m = 0; m < coloured.lobes; ++m) {
      const std::span<double> F_of_rgb = rgb.table(Factor::kF, coloured.table(Factor::kF, m, c));
      if (!coloured.F.per_channel) {
        rgb.s(m)[c] = mixed([&](int l) { return s(m)[l]; });
        std::ranges::copy(F(m, 0), F_of_rgb.begin());
        continue;
      }
      for (size_t k = 0; k < F_of_rgb.size(); ++k) {
        F_of_rgb[k] = mixed([&](int l) { return s(m)[l] * F(m, l)[k]; });
      }
      const double mean = std::accumulate(F_of_rgb.begin(), F_of_rgb.end(), 0.0) /
                          static_cast<double>(F_of_rgb.size());
      rgb.s(m)[c] = mean;
      for (double& x : F_of_rgb) x = mean > 0 ? x / mean : 1;
    }
  }
  return rgb;
}

void CheckParameters(const SpectralModel& model) {
  for (int l = 0; l < model.bands(); l += kChannels) {
    try {
      CheckParameters(model.ThreeBands(l));
    } catch (const Error& error) {
      std::ostringstream message;
      message << "at " << model.wavelengths()[l] << " nm or the two wavelengths above it, "
              << error.what();
      throw error.WithMessage(message.str());
    }
  }
}

void UnclampedValues(const SpectralModel& model, const SampleStencils& stencils,
                     std::span<double> rho) {
  const ModelReads reads{model.shared(), stencils};
  std::ranges::copy(model.d(), rho.begin());
  for (int m = 0; m < model.spec().lobes; ++m) {
    const double rest = LobeValue(1.0, reads.D(m, 0), 1.0, reads.G(m, 0));
    const std::span<const double> s = model.s(m);
    for (size_t l = 0; l < rho.size(); ++l) {
      rho[l] += s[l] * stencils.F(model.F(m, static_cast<int>(l))) * rest;
    }
  }
}

std::vector<double> Evaluate(const SpectralModel& model, const DirectionPair& directions) {
  std::vector<double> rho(model.bands());
  if (!(directions.wi[2] > 0 && directions.wo[2] > 0)) return rho;
  const ModelSpec& spec = model.spec();
  UnclampedValues(model,
                  spec.anisotropic() ? ScatteredStencils(spec, ToSphericalAngles(directions))
                                     : ScatteredStencils(spec, ToHalfDiff(directions)),
                  rho);
  for (double& x : rho) x = std::max(x, 0.0);
  return rho;
}

std::string WavelengthsText(const SpectralModel& model) {
  const std::vector<double>& all = model.wavelengths();
  if (all.size() == 1) return "one wavelength, " + Text(all[0]) + " nm";
  return std::to_string(all.size()) + " wavelengths from " + Text(all.front()) + " to " +
         Text(all.back()) + " nm";
}

}  // namespace trilobe
