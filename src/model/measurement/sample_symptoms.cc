#include "model/measurement/sample_symptoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/quantile.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"

namespace trilobe {
namespace {

constexpr int kMostSamples = 20000;  // that a symptom looks at
constexpr size_t kFewestDirections = 3;

// --- incidences ---

// Points that are spread evenly over the projected hemisphere (Fibonacci's spiral on the disc), of
// which each stands for pi / count of the sum over cos theta_o.
std::vector<Direction> CosinePoints(int count) {
  const double turn = kPi * (3 - std::sqrt(5.0));
  std::vector<Direction> points(count);
  for (int k = 0; k < count; ++k) {
    const double sin2 = (k + 0.5) / count, sine = std::sqrt(sin2);
    points[k] = {sine * std::cos(turn * k), sine * std::sin(turn * k), std::sqrt(1 - sin2)};
  }
  return points;
}

double AngleBetween(const Direction& a, const Direction& b) {
  return std::acos(std::clamp(Dot(a, b), -1.0, 1.0));
}

// A sample of an incidence.
struct Seen {
  Direction wo;
  double rho, reach;  // the cosine of the angle within which it counts
};

// Samples of one direction are one, however often it was measured: the normal at each azimuth.
void KeepDarkestOfSame(std::vector<Seen>* seen) {
  constexpr double kSame = 1e-3;
  const auto key = [](const Seen& one) {
    return std::tuple(std::llround(one.wo[0] / kSame), std::llround(one.wo[1] / kSame),
                      std::llround(one.wo[2] / kSame));
  };
  std::ranges::sort(*seen, {}, [&](const Seen& one) { return std::pair(key(one), one.rho); });
  const auto is_same = [&](const Seen& a, const Seen& b) { return key(a) == key(b); };
  seen->erase(std::unique(seen->begin(), seen->end(), is_same), seen->end());
}

// Nothing of fewer than three directions.
std::optional<double> ReflectedAlbedo(const BrdfSamples& samples, const std::vector<int>& numbers) {
  constexpr int kPoints = 3000;
  static const std::vector<Direction> points = CosinePoints(kPoints);
  std::vector<Seen> seen;
  for (const int j : numbers) {
    const SphericalAngles& at = samples.directions[j];
    // Mirrored to one side of the plane of incidence.
    const Direction wo = ToDirection({at.theta_o, std::abs(AzimuthFromLight(at))});
    seen.push_back({wo, Mean(samples.rho[j]), 0});
  }
  KeepDarkestOfSame(&seen);
  if (seen.size() < kFewestDirections) return std::nullopt;
  for (Seen& one : seen) {
    double nearest = DegreesToRadians(10);
    for (const Seen& other : seen) {
      const double apart = AngleBetween(one.wo, other.wo);
      if (apart > 1e-6) nearest = std::min(nearest, apart);
    }
    one.reach = std::cos(1.5 * nearest);
  }
  double sum = 0;
  for (const Direction& point : points) {
    const Direction at = {point[0], std::abs(point[1]), point[2]};
    // The three nearest, by their cosines.
    std::array<std::pair<double, double>, 3> near;
    near.fill({-1, 0});
    bool within = false;
    for (const Seen& one : seen) {
      const double cosine = Dot(at, one.wo);
      within |= cosine >= one.reach;
      if (cosine <= near.back().first) continue;
      near.back() = {cosine, one.rho};
      for (size_t k = near.size() - 1; k > 0 && near[k].first > near[k - 1].first; --k) {
        std::swap(near[k], near[k - 1]);
      }
    }
    if (within) sum += std::min({near[0].second, near[1].second, near[2].second});
  }
  return kPi * sum / kPoints;
}

// --- sentences ---

template <typename... Parts>
std::string Sentence(const Parts&... parts) {
  std::ostringstream text;
  text.precision(4);
  (text << ... << parts);
  return text.str();
}

int WholePercent(double share) { return static_cast<int>(std::lround(100 * share)); }

std::string TellCosine(const BrdfSamples& samples) {
  const CosineSymptom cosine = CosineOf(samples);
  constexpr double kMostLeft = 0.25;  // else something else is wrong with the directions
  if (!cosine.IsOneTooMany() && !cosine.IsOneTooFew()) return "";
  if (cosine.error_without > kMostLeft) return "";
  const std::string begin =
      Sentence("exchanged directions differ by ", WholePercent(cosine.error),
               " % in the median, and by ", WholePercent(cosine.error_without), " % ");
  return begin + WhichCosine(cosine.IsOneTooMany());
}

constexpr std::string_view kFromMirror =
    "theta_o seems to be counted from the mirror direction; add theta_i to it, or name its column "
    "so, --columns=theta_i=NAME,from_mirror=NAME,phi_o=NAME,f=NAME by the names of the header";

std::string TellHighlight(const BrdfSamples& samples) {
  const HighlightSymptom highlight = HighlightOf(samples);
  if (highlight.IsAtLight()) {
    return Sentence(
        "the brightest samples stand at phi_o = phi_i, towards the light, and not at phi_i + 180, "
        "its mirror "
        "direction, at ",
        highlight.at_light, " of ", highlight.incidences,
        " incidences: either azimuths are counted from the mirror direction, which "
        "--azimuth=from_mirror corrects, or the material sends light back to where it "
        "comes from, for which the model has no lobe");
  }
  if (highlight.IsAtNormal()) {
    return Sentence("the brightest samples stand about theta_o = 0 at ", highlight.at_normal,
                    " of ", highlight.incidences, " incidences, whatever theta_i: ", kFromMirror);
  }
  if (const FromMirrorSymptom mirror = FromMirrorOf(samples); mirror.IsThere()) {
    return Sentence("exchanged directions differ by ", WholePercent(mirror.error),
                    " % in the median, and by ", WholePercent(mirror.error_from_mirror),
                    " % from the mirror direction: ", kFromMirror);
  }
  return "";
}

std::string TellReflected(const BrdfSamples& samples) {
  const double albedo = std::max(MedianReflected(samples), ReflectedLightOfScans(samples));
  if (!(albedo > 1.1)) return "";
  const std::string more = Sentence(
      "at least ", albedo, " times as much light comes back as fell (median of the incidences), ");
  // pi f is the reflectance factor: f of a perfect white is 1 / pi.
  const std::string factors = Sentence("--scale=", 1 / kPi, " corrects that");
  if (albedo < kPi) {
    return more + "as where values are reflectance factors, pi f; " + factors +
           "; or percents; --scale=0.01 corrects that";
  }
  return more + Sentence("as where values are percents; --scale=0.01 corrects that, and --scale=",
                         0.01 / kPi, " percents of the reflectance factor, pi f");
}

std::string TellRepeated(const BrdfSamples& samples, bool anisotropic) {
  const RepeatedDirections repeated = RepeatedDirectionsOf(samples, anisotropic);
  if (10 * repeated.samples < samples.size() || !(repeated.apart > 0.3)) return "";
  return Sentence(
      repeated.samples,
      " samples stand at directions that are there more than once, with values that differ "
      "by up to ",
      WholePercent(repeated.apart),
      " % (95 of 100): as where the sign of an angle was dropped, which tells one side "
      "of a scan from the other; "
      "write the angles with their signs, or phi_o = 180 on the mirror's side");
}

std::vector<int> NumbersBelow(const LargestValueSymptom& largest, const BrdfSamples& samples) {
  std::vector<int> numbers;
  for (int j = 0; j < samples.size(); ++j) {
    if (!HasLargest(largest, samples, j)) numbers.push_back(j);
  }
  return numbers;
}

std::string TellLargest(const LargestValueSymptom& largest, int samples) {
  if (largest.IsMark(samples)) {
    return MarkText(largest) + "; leave these lines out";
  }
  if (largest.IsPlateau(samples)) {
    return Sentence("the largest value is there ", largest.samples,
                    " times, as where a detector is saturated: highlights are brighter than that");
  }
  return "";
}

// Azimuths up to a turn in radians, of which none is a multiple of half a degree but 0.
bool AreAzimuthsInRadians(const BrdfSamples& samples) {
  constexpr double kLeast = 3, kMost = 2 * kPi + 0.01;  // degrees, as they were read
  constexpr size_t kFewest = 6;
  std::set<double> azimuths;
  for (const SphericalAngles& at : samples.directions) {
    for (const double phi : {at.phi_i, at.phi_o}) {
      const double degrees = std::abs(RadiansToDegrees(phi));
      if (degrees > kMost) return false;
      if (degrees == 0) continue;
      if (std::abs(std::remainder(degrees, 0.5)) < 1e-9) return false;
      azimuths.insert(degrees);
    }
  }
  return azimuths.size() >= kFewest && *azimuths.rbegin() > kLeast;
}

std::string TellAngles(const BrdfSamples& samples) {
  constexpr int kFewest = 10;
  double largest = 0;
  for (const SphericalAngles& at : samples.directions) {
    largest = std::max({largest, at.theta_i, at.theta_o});
  }
  // A right angle in radians, read as so many degrees.
  if (samples.size() >= kFewest && largest > 0 && largest < DegreesToRadians(kPi / 2)) {
    return Sentence("no polar angle is above ", RadiansToDegrees(largest),
                    " degrees: angles seem to be in radians; name the columns so, as theta_i_rad");
  }
  if (!AreAzimuthsInRadians(samples)) return "";
  return "no azimuth is above 6.3 degrees: azimuths seem to be in radians; name their columns so, "
         "as phi_o_rad";
}

std::string TellElevation(const BrdfSamples& samples) {
  const ElevationSymptom elevations = ElevationsOf(samples);
  if (!elevations.IsThere()) return "";
  const std::string why =
      elevations.at_normal >= 0
          ? Sentence("values change with the azimuth by a factor of ",
                     std::exp(elevations.at_normal),
                     " at theta_o = 0, where all azimuths are one direction")
          : Sentence("90 degrees minus the angles make values a function of the half vector to ",
                     WholePercent(std::sqrt(elevations.as_elevations)), " %, and the angles to ",
                     WholePercent(std::sqrt(elevations.as_read)), " %");
  return why +
         ": angles seem to be elevations, counted from the horizon; write 90 minus them, or name "
         "the columns so, --columns=elevation_i=NAME,elevation_o=NAME,phi_o=NAME,f=NAME by the "
         "names of the header";
}

std::string TellNegative(const BinCounts& counts) {
  if (2 * static_cast<int64_t>(counts.negative) <= counts.total) return "";
  return Sentence(
      counts.negative, " of ", counts.total,
      " values are negative, as decibels are, or logarithms, and left out; a column that --columns "
      "or its header calls db is read as 10^(dB/10), log10 as 10^x, and ln as e^x");
}

}  // namespace

std::map<int, std::vector<int>> ByIncidence(const BrdfSamples& samples) {
  std::map<int, std::vector<int>> incidences;
  for (int j = 0; j < samples.size(); ++j) {
    constexpr double kStep = 5;
    incidences[static_cast<int>(RadiansToDegrees(samples.directions[j].theta_i) / kStep)].push_back(
        j);
  }
  return incidences;
}

std::vector<ReflectedAtLeast> ReflectedLightOf(const BrdfSamples& samples) {
  constexpr int kMost = 1000;  // samples of an incidence
  std::vector<ReflectedAtLeast> reflected;
  for (const auto& [step, all] : ByIncidence(samples)) {
    std::vector<int> numbers;
    const size_t stride = 1 + all.size() / kMost;
    for (size_t k = 0; k < all.size(); k += stride) numbers.push_back(all[k]);
    double theta_i = 0;
    for (const int j : numbers) {
      theta_i += samples.directions[j].theta_i / static_cast<double>(numbers.size());
    }
    const std::optional<double> albedo = ReflectedAlbedo(samples, numbers);
    if (albedo) reflected.push_back({theta_i, *albedo});
  }
  return reflected;
}

double MedianReflected(const BrdfSamples& samples) {
  std::vector<double> albedos;
  for (const ReflectedAtLeast& one : ReflectedLightOf(samples)) albedos.push_back(one.albedo);
  return albedos.empty() ? 0 : Quantile(&albedos, 0.5);
}

RepeatedDirections RepeatedDirectionsOf(const BrdfSamples& samples, bool anisotropic) {
  constexpr double kStep = 1e-6;  // [rad]
  const auto key = [&](int j) {
    const SphericalAngles& at = samples.directions[j];
    return std::tuple(std::llround(at.theta_i / kStep), std::llround(at.theta_o / kStep),
                      std::llround(std::cos(AzimuthFromLight(at)) / kStep),
                      std::llround(std::sin(AzimuthFromLight(at)) / kStep),
                      anisotropic ? std::llround(std::cos(at.phi_i) / kStep) : 0,
                      anisotropic ? std::llround(std::sin(at.phi_i) / kStep) : 0);
  };
  std::vector<int> order(samples.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, key);
  RepeatedDirections repeated;
  std::vector<double> apart;
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    for (end = begin + 1; end < order.size() && key(order[end]) == key(order[begin]); ++end) {
      const double a = Mean(samples.rho[order[end - 1]]), b = Mean(samples.rho[order[end]]);
      apart.push_back(a + b > 0 ? 2 * std::abs(a - b) / (a + b) : 0);
    }
    if (end - begin > 1) repeated.samples += static_cast<int>(end - begin);
  }
  if (!apart.empty()) repeated.apart = Quantile(&apart, 0.95);
  return repeated;
}

namespace {

// `have_gaps`: where there were marks, which often stand at some azimuths near the normal.
std::vector<std::string> Symptoms(const Measurement& scattered, bool have_gaps) {
  CheckDirections(scattered);
  const LargestValueSymptom largest = LargestValueOf(scattered.samples);
  if (largest.IsMark(scattered.samples.size())) {
    // Marks are no light; what else is wrong, the other samples tell.
    Measurement measured = scattered;
    measured.samples = Selected(scattered.samples, NumbersBelow(largest, scattered.samples));
    std::vector<std::string> told = Symptoms(measured, /*have_gaps=*/true);
    told.insert(told.begin(), TellLargest(largest, scattered.samples.size()));
    return told;
  }
  std::vector<std::string> told = {TellNegative(scattered.counts)};
  if (scattered.samples.size() > 0) {
    const BrdfSamples some = EvenlySpread(scattered.samples, kMostSamples);
    told.push_back(TellAngles(some));
    if (!told.back().empty()) return {told.back()};  // all lies in one place
    told.push_back(TellReflected(some));
    told.push_back(TellLargest(largest, scattered.samples.size()));
    told.push_back(TellRepeated(scattered.samples, scattered.anisotropic));
    // If directions lack a sign, no other sentence about directions is right.
    if (told.back().empty()) {
      told.push_back(TellHighlight(some));
      // The same holds if the highlight is out of place, and of a cosine that explains all.
      if (told.back().empty()) told.push_back(TellCosine(some));
      if (told.back().empty() && !have_gaps) told.push_back(TellElevation(some));
    }
  }
  std::erase(told, "");
  return told;
}

}  // namespace

std::vector<std::string> SymptomsOfSamples(const Measurement& scattered) {
  return Symptoms(scattered, /*have_gaps=*/false);
}

std::string UndecidedIn(const Measurement& scattered) {
  CheckDirections(scattered);
  if (scattered.samples.size() == 0) return "";
  const BrdfSamples some = EvenlySpread(scattered.samples, kMostSamples);
  std::vector<std::string> undecided;
  if (!CosineOf(some).is_decided) undecided.emplace_back("cosines (few exchanged directions)");
  if (!HighlightOf(some).IsDecided()) {
    undecided.emplace_back(
        FromMirrorOf(some).is_decided
            ? "where azimuths are counted from (no clear highlight)"
            : "where azimuths and theta_o are counted from (no clear highlight)");
  }
  if (!ElevationsOf(some).IsDecided()) {
    undecided.emplace_back("elevations (values are no function of the half vector either way)");
  }
  std::string text;
  for (const std::string& one : undecided) text += (text.empty() ? "" : "; ") + one;
  return text;
}

}  // namespace trilobe
