#include "trilobe/model/measurement/corruption.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "core/base/names.h"
#include "core/files/text_lines.h"
#include "model/measurement/corrupted_readings.h"
#include "model/measurement/corruption_kinds.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

Corruption ParseOne(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(ErrorKind::kFormat, "'" + text + "' is not KIND:STRENGTH, as noise:0.05")
        .About("corruption", text);
  }
  const CorruptionKind& kind =
      FindNamed("kind of corruption", text.substr(0, colon), CorruptionKinds());
  const std::string_view number = std::string_view{text}.substr(colon + 1);
  const std::optional<double> strength = ToNumber(number);
  if (!strength || !(*strength >= kind.min && *strength <= kind.max)) {
    std::ostringstream message;
    message << "'" << text << "': the strength of " << kind.name << " is a number from " << kind.min
            << " to " << kind.max << " [" << kind.unit << "]";
    throw Error(ErrorKind::kRange, message.str()).About(kind.name, number);
  }
  return {.kind = &kind, .strength = *strength};
}

}  // namespace

const std::vector<CorruptionKind>& CorruptionKinds() {
  static const std::vector<CorruptionKind> kinds = {
      {"noise", "relative standard deviation", 0, 1, 0,
       "rho exp(t z - t^2/2), t^2 = log(1 + x^2), z normal, by channel", AddNoise},
      {"dark", "of the median signal", 0, 100, 0, "b + x median(b) z, at least 0", AddDarkNoise},
      {"photons", "electrons of the largest signal", 10, 1e18, 1e18,
       "n + sqrt(n) z, rounded, n = x b/max(b)", AddPhotonNoise},
      {"outliers", "share", 0, 1, 0, "a share x of the samples times 1000", AddOutliers},
      {"spikes", "factor", 0, 1e6, 1, "a twentieth of the samples times x", AddSpikes},
      {"zeros", "share", 0, 1, 0, "a share x of the samples is 0", AddZeros},
      {"gaps", "share", 0, 1, 0, "a share x of the samples is lost, at random", LoseAtRandom},
      {"retro", "deg", 0, 180, 0, "lost where wi and wo are less than x apart", LoseCone},
      {"beyond", "deg", 0, 90, 90, "lost where theta_i or theta_o is beyond x", LoseBeyond},
      {"side", "share", 0, 1, 0,
       "a share x is lost on one side of the plane of incidence; of a table, where theta_i < "
       "theta_o",
       LoseSide},
      {"clip", "share", 0, 1, 0, "b at most the value that a share x of b exceeds", Clip},
      {"tilt", "deg", -30, 30, 0,
       "the normal leans by x towards azimuth 0, from which the light of a table comes", Tilt},
      {"origin", "deg", -30, 30, 0, "theta_o is x off, in the plane of azimuth 0", ShiftOrigin},
      {"aperture", "deg", 0, 30, 0, "mean over 19 points of a disc of diameter x about wo",
       BlurByAperture},
      {"quantize", "bits", 1, 52, 52, "b to multiples of max(b)/2^x", Quantize},
      {"brackets", "bits", 1, 52, 52,
       "the same, max(b) divided by 4 as often as b remains below it", QuantizeInBrackets},
      {"crosstalk", "share", 0, 1, 0, "(1 - x) rho + x times the mean over the channels",
       MixChannels},
      {"stray", "of the median signal", 0, 1000, 0, "b + x median(b)", AddStrayLight},
      {"flare", "share", 0, 1, 0, "b + x times the largest b of the same degree of theta_i",
       AddFlare},
      {"shadow", "deg", 0, 90, 0, "rho (theta_d/x)^2 where theta_d < x", CastShadow},
      {"cosine", "exponent", -2, 2, 0, "rho cos^x theta_i: 1 is a cosine too many, -1 one too few",
       MultiplyByCosine},
      {"cosine_o", "exponent", -2, 2, 0,
       "rho cos^x theta_o: 1 where a signal was not divided by it", MultiplyByOutgoingCosine},
      {"scale", "factor", 1e-6, 1e6, 1, "rho x: another unit, as percents or pi rho", Multiply},
      {"repeat", "deg", 0, 90, 90, "rho at min(theta_i, x), min(theta_o, x)", RepeatBeyond},
      {"nonreciprocal", "exponent", 0, 10, 0, "rho exp(x (cos theta_i - cos theta_o))",
       BreakReciprocity},
  };
  return kinds;
}

std::vector<Corruption> ParseCorruptions(std::string_view text) {
  std::vector<Corruption> corruptions;
  if (text.empty()) return corruptions;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    corruptions.push_back(ParseOne(std::string(text.substr(begin, end - begin))));
    begin = end + 1;
  }
  return corruptions;
}

void Corrupt(const std::vector<Corruption>& corruptions, uint64_t seed, int num_threads,
             Measurement* measurement) {
  CheckNumThreads(num_threads);
  NotNull(measurement, "the measurement");
  // Each kind has its own random numbers.
  constexpr uint64_t kStep = 0xd1342543de82ef95U;
  uint64_t stream = seed;
  for (const auto& [kind, strength] : corruptions) {
    Readings readings(measurement, num_threads);
    kind->apply(strength, stream += kStep, &readings);
    readings.Store();
    if (CountsOf(*measurement).valid == 0) {
      std::ostringstream message;
      message << measurement->source << ": " << kind->name << ":" << strength
              << " leaves no sample; give a weaker one";
      throw Error(ErrorKind::kData, message.str())
          .At(measurement->source)
          .About(kind->name, strength);
    }
    measurement->look_up = nullptr;
    measurement->formula = nullptr;
  }
}

}  // namespace trilobe
