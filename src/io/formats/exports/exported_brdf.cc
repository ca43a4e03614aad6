#include "io/formats/exports/exported_brdf.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <sstream>

#include "model/measurement/counter_random.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

// Draws pairs of directions, each distributed by its cosine.
std::vector<CompletedMeasurement::Place> DrawPlaces(const PairBrdf& brdf, double max_theta) {
  constexpr int kPairs = 20000;
  std::vector<CompletedMeasurement::Place> places;
  const auto direction = [&](uint64_t k) {
    const double r = std::sqrt(UniformAt(1, 2 * k)), phi = 2 * kPi * UniformAt(1, 2 * k + 1);
    return Direction{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
  };
  for (uint64_t k = 0; k < kPairs; ++k) {
    const DirectionPair pair = {direction(2 * k), direction(2 * k + 1)};
    if (std::min(pair.wi[2], pair.wo[2]) < std::cos(max_theta)) continue;
    const Rgb expected = brdf(pair);
    if (Mean(expected) > 0) places.push_back({pair, expected});
  }
  return places;
}

}  // namespace

ExportedBrdf ExportedModel(const FactorModel& model, double max_theta) {
  CheckParameters(model);
  const auto prepared = std::make_shared<const PreparedModel<double>>(model);
  ExportedBrdf brdf = {
      .value = [prepared](const DirectionPair& pair) { return prepared->Value(pair.wi, pair.wo); },
      .anisotropic = model.spec().anisotropic(),
      .places = {}};
  brdf.places = DrawPlaces(brdf.value, max_theta);
  return brdf;
}

ExportError MeasureError(const PairBrdf& file,
                         const std::vector<CompletedMeasurement::Place>& places) {
  if (places.empty()) throw Error(ErrorKind::kData, "there is no light to write").About("light");
  std::vector<double> errors;
  for (const CompletedMeasurement::Place& place : places) {
    errors.push_back(RelativeDistance(file(place.at), place.measured));
  }
  std::ranges::sort(errors);
  return {.median = errors[errors.size() / 2], .high = errors[errors.size() * 99 / 100]};
}

bool AreGrey(const std::vector<Rgb>& values) {
  return std::ranges::all_of(values, [](const Rgb& value) {
    const auto [least, most] = std::minmax({value[0], value[1], value[2]});
    return most - least <= 1e-9 * most;
  });
}

void AppendNumber(double number, std::string* text) {
  if (number == 0) {
    *text += '0';
    return;
  }
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                 std::chars_format::scientific, 5);
  text->append(buffer.data(), end.ptr);
}

void RequireExact(size_t bytes, double median_error, double max_error) {
  if (median_error <= max_error) return;
  std::ostringstream message;
  message.precision(3);
  message << "no file is exact enough: one of " << static_cast<double>(bytes) / 1e6
          << " MB is off by " << 100 * median_error << " % in the median, where " << 100 * max_error
          << " % is asked for; allow a larger error";
  throw Error(ErrorKind::kLimit, message.str()).About("max_error", max_error);
}

}  // namespace trilobe
