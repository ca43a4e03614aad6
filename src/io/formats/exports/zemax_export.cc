#include "io/formats/exports/zemax_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "io/formats/optical/zemax_angles.h"
#include "io/formats/spectrum.h"
#include "io/formats/text/angle_list.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/half_vector_table.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe {
namespace {

struct ZemaxSize {
  int rotations, incidences, azimuths, radials;
};
constexpr ZemaxSize kZemaxIsotropic[] = {
    {1, 11, 19, 41}, {1, 16, 31, 61}, {1, 19, 37, 91}, {1, 31, 61, 121}, {1, 46, 91, 161}};
constexpr ZemaxSize kZemaxAnisotropic[] = {{13, 10, 25, 37}, {25, 13, 37, 49}, {25, 16, 49, 73}};

// Ascending angles [degrees], of few digits, as the file has them.
std::vector<double> Angles(int count, double last, double power) {
  std::vector<double> angles;
  for (int k = 0; k < count; ++k) {
    const double angle = last * std::pow(static_cast<double>(k) / (count - 1), power);
    angles.push_back(std::round(angle * 1e3) / 1e3);
  }
  return angles;
}

class ZemaxTable {
 public:
  double median_error = 0, high_error = 0;

  ZemaxTable(const ExportedBrdf& brdf, const ZemaxSize& size, int num_threads)
      : rotations(size.rotations == 1 ? std::vector<double>{0} : Angles(size.rotations, 360, 1)),
        incidences(Angles(size.incidences, 90, 1)),
        azimuths(Angles(size.azimuths, brdf.anisotropic ? 360 : 180, 1)),
        // Dense about the mirror direction.
        radials(Angles(size.radials, 180, 2)) {
    incidences.back() = RadiansToDegrees(kGrazingTheta);
    const size_t block = azimuths.size() * radials.size();
    values_.resize(rotations.size() * incidences.size() * block);
    ParallelFor(static_cast<int>(rotations.size() * incidences.size()), num_threads, [&](int k) {
      for (size_t b = 0; b < block; ++b) {
        const SphericalAngles at =
            ToSphericalAngles(ZemaxAngles{DegreesToRadians(rotations[k / incidences.size()]),
                                          DegreesToRadians(incidences[k % incidences.size()]),
                                          DegreesToRadians(azimuths[b / radials.size()]),
                                          DegreesToRadians(radials[b % radials.size()])});
        if (IsAboveSurface(at)) values_[k * block + b] = brdf.value(ToDirections(at));
      }
    });
    const ExportError error =
        MeasureError([this](const DirectionPair& pair) { return Interpolated(pair); }, brdf.places);
    median_error = error.median;
    high_error = error.high;
  }

  bool IsGrey() const { return AreGrey(values_); }

  // Values at all radials, for a rotation, an incidence and an azimuth.
  std::span<const Rgb> Row(size_t rotation, size_t incidence, size_t azimuth) const {
    return {&values_[IndexOf(rotation, incidence, azimuth, 0)], radials.size()};
  }

  std::vector<double> rotations, incidences, azimuths, radials;  // [degrees]

 private:
  size_t IndexOf(size_t rotation, size_t incidence, size_t azimuth, size_t radial) const {
    return ((rotation * incidences.size() + incidence) * azimuths.size() + azimuth) *
               radials.size() +
           radial;
  }

  // Interpolates linearly in all four angles.
  Rgb Interpolated(const DirectionPair& pair) const {
    const ZemaxAngles at = ToZemaxAngles(pair);
    const double azimuth = RadiansToDegrees(at.azimuth);
    const BetweenNodes axes[] = {
        FindBetween(rotations, RadiansToDegrees(at.rotation)),
        FindBetween(incidences, RadiansToDegrees(at.incidence)),
        FindBetween(azimuths, azimuths.back() == 180 ? std::min(azimuth, 360 - azimuth) : azimuth),
        FindBetween(radials, RadiansToDegrees(at.radial))};
    Rgb sum{};
    for (unsigned corner = 0; corner < 16; ++corner) {
      double weight = 1;
      std::array<size_t, 4> index{};
      for (unsigned k = 0; k < 4; ++k) {
        const unsigned upper = corner >> k & 1U;
        weight *= upper == 1 ? axes[k].t : 1 - axes[k].t;
        index[k] = axes[k].lower + upper;
      }
      if (weight == 0) continue;
      const Rgb& value = values_[IndexOf(index[0], index[1], index[2], index[3])];
      for (int c = 0; c < kChannels; ++c) sum[c] += weight * value[c];
    }
    return sum;
  }

  std::vector<Rgb> values_;  // [rotation][incidence][azimuth][radial]
};

// --- Text ----------------------------------------------------------------------------------------

void AppendAngles(const char* key, const std::vector<double>& angles, std::string* text) {
  text->append(key).append("\t").append(std::to_string(angles.size())).append("\n");
  for (const double angle : angles) {
    if (angle != angles.front()) *text += '\t';
    *text += Text(angle, 7);
  }
  *text += '\n';
}

// The albedo of each rotation and incidence.
std::vector<Rgb> AlbedosOf(const ExportedBrdf& brdf, const ZemaxTable& table, int num_threads) {
  std::vector<Rgb> albedos(table.rotations.size() * table.incidences.size());
  ParallelFor(static_cast<int>(albedos.size()), num_threads, [&](int k) {
    const double phi_i = kPi - DegreesToRadians(table.rotations[k / table.incidences.size()]);
    albedos[k] = DirectionalAlbedo(
        [&](const DirectionPair& pair) {
          return brdf.value({TurnedAboutNormal(pair.wi, phi_i), TurnedAboutNormal(pair.wo, phi_i)});
        },
        DegreesToRadians(table.incidences[k % table.incidences.size()]));
  });
  return albedos;
}

std::string FormatZemax(const ZemaxTable& table, const std::vector<Rgb>& albedos, bool colored) {
  const bool symmetrical = table.azimuths.back() == 180;
  std::string text =
      "# written by Trilobe; BRDF [1/sr], angles in degrees\nSource\tMeasured\nSymmetry\t";
  text.append(symmetrical ? "PlaneSymmetrical" : "Asymmetrical4D")
      .append("\nSpectralContent\t")
      .append(colored ? "XYZ" : "Monochrome")
      .append("\nScatterType\tBRDF\n");
  AppendAngles("SampleRotation", table.rotations, &text);
  AppendAngles("AngleOfIncidence", table.incidences, &text);
  AppendAngles("ScatterAzimuth", table.azimuths, &text);
  AppendAngles("ScatterRadial", table.radials, &text);
  const std::vector<const char*> blocks =
      colored ? std::vector<const char*>{"TristimulusX", "TristimulusY", "TristimulusZ"}
              : std::vector<const char*>{"Monochrome"};
  for (size_t b = 0; b < blocks.size(); ++b) {
    const auto append = [&](const Rgb& rgb) {
      AppendNumber(colored ? TristimulusOf(rgb)[b] : rgb[0], &text);
    };
    text.append("\n").append(blocks[b]).append("\nDataBegin\n");
    for (size_t k = 0; k < albedos.size(); ++k) {
      text += "TIS\t";
      append(albedos[k]);
      text += '\n';
      for (size_t a = 0; a < table.azimuths.size(); ++a) {
        const auto row = table.Row(k / table.incidences.size(), k % table.incidences.size(), a);
        for (const Rgb& value : row) {
          if (&value != row.data()) text += '\t';
          append(value);
        }
        text += '\n';
      }
    }
    text += "DataEnd\n";
  }
  return text;
}

}  // namespace

ZemaxExport ExportZemax(const ExportedBrdf& brdf, const ZemaxExportOptions& options) {
  const std::span<const ZemaxSize> sizes = brdf.anisotropic
                                               ? std::span<const ZemaxSize>(kZemaxAnisotropic)
                                               : std::span<const ZemaxSize>(kZemaxIsotropic);
  const double max_error = options.max_error.value_or(brdf.anisotropic ? 0.02 : 0.005);
  const auto table = ChooseSmallest<ZemaxTable>(
      static_cast<int>(sizes.size()),
      [&](int k) { return ZemaxTable(brdf, sizes[k], options.num_threads); }, max_error);
  const bool colored = !table.IsGrey();
  ZemaxExport result = {
      .bytes = FormatZemax(table, AlbedosOf(brdf, table, options.num_threads), colored),
      .colored = colored,
      .rotations = static_cast<int>(table.rotations.size()),
      .incidences = static_cast<int>(table.incidences.size()),
      .azimuths = static_cast<int>(table.azimuths.size()),
      .radials = static_cast<int>(table.radials.size()),
      .median_error = table.median_error,
      .high_error = table.high_error};
  if (options.max_error) RequireExact(result.bytes.size(), result.median_error, max_error);
  return result;
}

}  // namespace trilobe
