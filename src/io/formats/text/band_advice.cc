#include "io/formats/text/band_advice.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "io/formats/text/columns_flag.h"

namespace trilobe {
namespace {

// Sensors that number their bands, and their middles.
struct Sensor {
  std::string_view name;
  std::vector<std::string_view> prefixes;              // of names of bands
  std::map<std::string, int, std::less<>> bands = {};  // [nm]
};
const Sensor kSensors[] = {
    {"MODIS",
     {"modis"},
     {{"1", 645}, {"2", 859}, {"3", 469}, {"4", 555}, {"5", 1240}, {"6", 1640}, {"7", 2130}}},
    {"Sentinel-2",
     {"s2", "sentinel2", "msi"},
     {{"1", 443},
      {"2", 490},
      {"3", 560},
      {"4", 665},
      {"5", 705},
      {"6", 740},
      {"7", 783},
      {"8", 842},
      {"8a", 865},
      {"11", 1610},
      {"12", 2190}}},
    {"Landsat 8",
     {"l8", "oli", "landsat8"},
     {{"1", 443}, {"2", 482}, {"3", 561}, {"4", 655}, {"5", 865}, {"6", 1609}, {"7", 2201}}}};

struct Band {
  std::string prefix, word, number;
  bool is_padded = false;  // "B02", as of Sentinel-2
};

// "band1", "B02", "MODIS_B1"; none for other names.
std::optional<Band> BandOf(const TableColumn& column) {
  if (column.role != ColumnRole::kOther) return std::nullopt;
  std::string key = KeyOf(column);
  Band band;
  for (const Sensor& sensor : kSensors) {
    for (const std::string_view prefix : sensor.prefixes) {
      if (band.prefix.empty() && key.starts_with(prefix)) band.prefix = prefix;
    }
  }
  key.erase(0, band.prefix.size());
  for (const std::string_view word : {"band", "channel", "ch", "b"}) {
    if (!key.starts_with(word)) continue;
    band.word = word;
    key.erase(0, word.size());
    break;
  }
  band.is_padded = key.starts_with('0');
  if (band.is_padded) key.erase(0, 1);
  const bool has_letter = key == "8a";
  const bool is_number = !key.empty() && key.size() < 3 &&
                         std::ranges::all_of(key, [](unsigned char c) { return std::isdigit(c); });
  if ((band.prefix.empty() && band.word.empty()) || !(is_number || has_letter)) return std::nullopt;
  band.number = key;
  return band;
}

// Whether whole numbers stand for reflectances of 0 to 1 times 10,000.
bool AreTenThousandths(const std::vector<TableColumn>& columns, const FirstRows& rows) {
  double largest = 0;
  for (size_t k = 0; k < columns.size(); ++k) {
    if (!BandOf(columns[k])) continue;
    for (const std::optional<double>& cell : rows.Column(k)) {
      if (!cell) continue;
      if (*cell != std::floor(*cell)) return false;
      largest = std::max(largest, *cell);
    }
  }
  constexpr double kFewest = 100;
  return largest >= kFewest;
}

// "--columns=theta_i,theta_o,645nm,859nm --bands=..." of a sensor; "" if it lacks a band.
std::string FlagsOf(const Sensor& sensor, const std::vector<TableColumn>& columns) {
  std::vector<std::string> words(columns.size());
  std::vector<int> wavelengths;
  for (size_t k = 0; k < columns.size(); ++k) {
    const std::optional<Band> band = BandOf(columns[k]);
    if (!band) continue;
    const auto found = sensor.bands.find(band->number);
    if (found == sensor.bands.end()) return {};
    if (!band->prefix.empty() &&
        std::ranges::find(sensor.prefixes, band->prefix) == sensor.prefixes.end()) {
      return {};
    }
    words[k] = std::to_string(found->second) + "nm";
    wavelengths.push_back(found->second);
  }
  std::string flags = ColumnsFlagWith(columns, words);
  // Red, green and blue, or else the only three, the longest first.
  std::vector<int> shown;
  for (const int wavelength : wavelengths) {
    constexpr int kViolet = 450, kDeepRed = 700;
    if (wavelength > kViolet && wavelength < kDeepRed) shown.push_back(wavelength);
  }
  if (shown.size() != 3) shown = wavelengths;
  if (shown.size() != 3) return flags;
  std::ranges::sort(shown, std::greater());
  return flags + " --bands=" + std::to_string(shown[0]) + "," + std::to_string(shown[1]) + "," +
         std::to_string(shown[2]);
}

}  // namespace

std::string AdviceOnBands(const std::vector<TableColumn>& columns, const FirstRows& rows) {
  const auto first = std::ranges::find_if(
      columns, [](const TableColumn& column) { return BandOf(column).has_value(); });
  if (first == columns.end()) return {};
  const Band band = *BandOf(*first);
  const bool scaled = AreTenThousandths(columns, rows);
  const bool is_padded = std::ranges::any_of(columns, [](const TableColumn& column) {
    const std::optional<Band> other = BandOf(column);
    return other && (other->is_padded || other->number == "8a");
  });
  std::string advice;
  int sensors = 0;
  // "band1" is said of MODIS first, and "B2" of Sentinel-2.
  std::vector<const Sensor*> in_order = {&kSensors[0], &kSensors[1], &kSensors[2]};
  if (band.word == "b") std::swap(in_order[0], in_order[1]);
  for (const Sensor* const sensor : in_order) {
    if (band.prefix.empty() && band.word.starts_with("ch")) continue;
    if (is_padded && sensor->name != "Sentinel-2") continue;
    const std::string flags = FlagsOf(*sensor, columns);
    constexpr int kMost = 2;
    if (flags.empty() || sensors == kMost) continue;
    const std::string what =
        std::string(scaled ? "10,000 times " : "") + "reflectance factors, pi f";
    advice += (sensors == 0 ? "if they are of " : "; if of ") + std::string(sensor->name) +
              (sensors == 0 ? ", and " + what + "," : ",") + " type " + flags +
              (scaled ? " --scale=3.183e-5" : " --scale=0.3183");
    ++sensors;
  }
  const std::string begin = "'" + first->name + "' and others are bands without a wavelength; ";
  if (sensors > 0) return begin + advice;
  return begin + "name them so, as " + ColumnsFlag(columns, first - columns.begin(), "645nm");
}

}  // namespace trilobe
