#include "io/page/measured_data.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "trilobe/core/geometry/channels.h"

namespace trilobe {
namespace {

using Values = std::vector<std::optional<Rgb>>;

int Code(double rho) {
  const double code = std::round(kMeasuredSteps * std::log2(1 + rho / kMeasuredFloor));
  return static_cast<int>(std::clamp(code, 0.0, 65535.0));
}

class Bits {
 public:
  void Add(uint32_t number, int count) {
    for (int k = 0; k < count; ++k) AddBit(number >> k & 1);
  }
  // As many ones as the number is above its low bits, a zero, and these.
  void AddRice(uint32_t number, int low) {
    for (uint32_t k = number >> low; k > 0; --k) AddBit(1);
    AddBit(0);
    Add(number, low);
  }
  std::string Take() { return std::move(bytes_); }

 private:
  void AddBit(uint32_t bit) {
    if (used_ == 0) bytes_ += '\0';
    bytes_.back() = static_cast<char>(static_cast<unsigned char>(bytes_.back()) | bit << used_);
    used_ = (used_ + 1) % 8;
  }

  std::string bytes_;
  int used_ = 0;  // bits of the last byte
};

// The least bits a row of such numbers takes, by the low bits of each.
int BestLowBits(const std::vector<uint32_t>& numbers) {
  int best = 0;
  uint64_t least = ~uint64_t{0};
  for (int low = 0; low < 16; ++low) {
    uint64_t bits = 0;
    for (const uint32_t number : numbers) bits += (number >> low) + 1 + low;
    if (bits < least) {
      least = bits;
      best = low;
    }
  }
  return best;
}

void AddRuns(const Values& values, Bits* bits) {
  constexpr int kLow = 5;
  bool measured = true;
  uint32_t run = 0;
  for (const std::optional<Rgb>& value : values) {
    if (value.has_value() == measured) {
      ++run;
      continue;
    }
    bits->AddRice(run, kLow);
    measured = !measured;
    run = 1;
  }
  bits->AddRice(run, kLow);
}

// Rows of `length`, of which `rows` are beside each other before another begins.
std::string Encoded(const Values& values, int length, int rows) {
  Bits bits;
  AddRuns(values, &bits);
  std::vector<int> codes(values.size());
  for (int c = 0; c < kChannels; ++c) {
    for (size_t k = 0; k < values.size(); ++k) {
      if (values[k]) codes[k] = Code((*values[k])[c]);
    }
    std::vector<uint32_t> numbers;
    for (size_t begin = 0; begin < values.size(); begin += length) {
      numbers.clear();
      const bool first = begin / length % rows == 0;
      int left = -1;  // the code of the last pair of the row that was measured
      for (size_t k = begin; k < begin + length; ++k) {
        if (!values[k]) continue;
        const int above = !first && values[k - length] ? codes[k - length] : -1;
        const int expected = left < 0 ? std::max(above, 0) : above < 0 ? left : (left + above) / 2;
        const int difference = codes[k] - expected;
        numbers.push_back(difference < 0 ? -2 * difference - 1 : 2 * difference);
        left = codes[k];
      }
      const int low = BestLowBits(numbers);
      bits.Add(low, 4);
      for (const uint32_t number : numbers) bits.AddRice(number, low);
    }
  }
  return bits.Take();
}

}  // namespace

MeasuredData EncodeMeasured(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  const int together = grid.phi_d > 90 && grid.phi_d % 2 == 0 ? 2 : 1;
  Values values;
  for (int bin = 0; bin < grid.size(); bin += together) {
    Rgb sum{};
    int count = 0;
    for (int k = bin; k < bin + together; ++k) {
      if (!valid[k]) continue;
      ++count;
      for (int c = 0; c < kChannels; ++c) sum[c] += table.Value(c, k);
    }
    for (double& x : sum) x /= std::max(count, 1);
    values.push_back(count > 0 ? std::optional(sum) : std::nullopt);
  }
  MeasuredData data;
  data.shape = {grid.theta_h, grid.theta_d, grid.phi_d / together};
  data.samples = static_cast<int>(std::ranges::count(valid, true));
  data.bits = Encoded(values, data.shape[2], data.shape[1]);
  return data;
}

MeasuredData EncodeMeasured(const NodeBrdf& brdf) {
  const NodeTable& table = brdf.table();
  HemisphereGrid grid = table.grid;
  const bool all = grid.nodes() <= kMostNodes;
  if (!all) {
    grid.thetas = std::min(grid.thetas, 12);
    grid.phis = std::min(grid.phis, kMostNodes / grid.thetas);
  }
  const int nodes = grid.nodes();
  Values values;
  for (int i = 0; i < nodes; ++i) {
    for (int o = 0; o < nodes; ++o) {
      const size_t k = static_cast<size_t>(i) * nodes + o;
      const SphericalAngles at = grid.Angles(i, o);
      const bool known = all ? table.present[k] : brdf.Measured(at);
      values.push_back(!known ? std::nullopt : std::optional(all ? table.rho[k] : brdf(at)));
    }
  }
  MeasuredData data;
  data.nodes = true;
  data.shape = {nodes, nodes};
  data.grid = grid;
  data.max_theta = table.max_theta;
  data.samples = static_cast<int>(std::ranges::count(table.present, true));
  data.bits = Encoded(values, nodes, nodes);
  return data;
}

}  // namespace trilobe
