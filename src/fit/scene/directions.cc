#include "fit/scene/directions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/files/little_endian.h"
#include "model/measurement/sample_density.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/stencil.h"

namespace trilobe {
namespace {

// Distance in phi_d up to which bins still tell of a pair of directions.
constexpr double kPhiReachDegrees = 10;

std::string Text(const MerlGrid& grid) {
  return std::to_string(grid.theta_h) + " x " + std::to_string(grid.theta_d) + " x " +
         std::to_string(grid.phi_d);
}

// The numbers of the samples that are used, and how often each is read; empty where nothing says
// that.
struct Selection {
  std::vector<int> numbers;
  std::vector<double> reads = {};
};

// Selects the samples that are read at all.
Selection ThoseRead(const std::vector<double>& reads) {
  Selection selection;
  for (size_t j = 0; j < reads.size(); ++j) {
    if (!(reads[j] > 0)) continue;
    selection.numbers.push_back(static_cast<int>(j));
    selection.reads.push_back(reads[j]);
  }
  return selection;
}

template <typename Uses>
Selection Where(const BrdfSamples& samples, const Uses& uses) {
  Selection selection;
  for (int j = 0; j < samples.size(); ++j) {
    if (uses(j)) selection.numbers.push_back(j);
  }
  return selection;
}

Selection Select(const BrdfSamples& samples, const AllDirections& /*all*/) {
  return Where(samples, [](int) { return true; });
}

Selection Select(const BrdfSamples& samples, const DirectionRanges& ranges) {
  constexpr double kRounding = 1e-9;  // 60 degrees are not beyond 60
  const auto in = [](const DirectionRanges::Range& range, double theta) {
    return range.min - kRounding <= theta && theta <= range.max + kRounding;
  };
  return Where(samples, [&](int j) {
    const Cosines cosines = samples.CosinesOf(j);
    const double i = std::acos(cosines.i), o = std::acos(cosines.o);
    return (in(ranges.theta_i, i) && in(ranges.theta_o, o)) ||
           (in(ranges.theta_i, o) && in(ranges.theta_o, i));
  });
}

Selection Select(const BrdfSamples& samples, const DirectionList& list) {
  const SamplesOfBins samples_of(samples);
  std::vector<double> reads(samples.rho.size(), 0.0);
  for (const HalfDiffAngles& angles : list.directions) {
    for (const BinShare& bin : BinsAround(samples.grid, angles)) {
      const std::vector<int>& inside = samples_of(bin.bin);
      for (const int j : inside) reads[j] += bin.share / static_cast<double>(inside.size());
    }
  }
  return ThoseRead(reads);
}

Selection Select(const BrdfSamples& samples, const DirectionHistogram& histogram) {
  if (!(histogram.grid == samples.grid)) {
    throw ErrorIn(ErrorKind::kMismatch, histogram.source,
                  "the histogram has " + Text(histogram.grid) + " bins, but the measurement " +
                      samples.source + " has " + Text(samples.grid) +
                      "; count over theta_h, theta_d, phi_d of the measurement's grid")
        .About("histogram", Text(histogram.grid));
  }
  std::vector<double> reads;
  for (int j = 0; j < samples.size(); ++j) reads.push_back(histogram.counts[BinOf(samples, j)]);
  return ThoseRead(reads);
}

}  // namespace

std::vector<BinShare> BinsAround(const MerlGrid& grid, const HalfDiffAngles& angles) {
  const Stencil h = LinearStencil(grid.ThetaHCoordinate(angles.theta_h), grid.theta_h);
  const Stencil d = LinearStencil(grid.ThetaDCoordinate(angles.theta_d), grid.theta_d);
  const double phi = angles.phi_d / kPi * grid.phi_d - 0.5;
  const double reach = std::max(DegreesToRadians(kPhiReachDegrees) / kPi * grid.phi_d, 1.0);
  std::vector<BinShare> shares;
  double sum = 0;
  for (int p = static_cast<int>(std::ceil(phi - reach)); p <= phi + reach; ++p) {
    const double of_phi = 1 - std::abs(p - phi) / reach;
    if (!(of_phi > 0)) continue;
    const int at = (p % grid.phi_d + grid.phi_d) % grid.phi_d;
    for (int a = 0; a < h.size; ++a) {
      for (int b = 0; b < d.size; ++b) {
        const double share = of_phi * h.weight[a] * d.weight[b] / 2;
        shares.push_back({grid.Index(h.index[a], d.index[b], at), share});
        shares.push_back({grid.Index(h.index[a], d.index[b], grid.phi_d - 1 - at), share});
        sum += 2 * share;
      }
    }
  }
  for (BinShare& share : shares) share.share /= sum;
  return shares;
}

int BinOf(const BrdfSamples& samples, int j) {
  return samples.on_grid() ? samples.bins[j] : samples.grid.Bin(samples.angles[j]);
}

SamplesOfBins::SamplesOfBins(const BrdfSamples& samples) {
  for (int j = 0; j < samples.size(); ++j) samples_[BinOf(samples, j)].push_back(j);
}

const std::vector<int>& SamplesOfBins::operator()(int bin) const {
  static const std::vector<int> none;
  const auto found = samples_.find(bin);
  return found == samples_.end() ? none : found->second;
}

DirectionHistogram ParseHistogram(std::string_view bytes, const std::string& source) {
  constexpr size_t kHeader = 3 * sizeof(int32_t);
  constexpr int kMaxBins = 1 << 26;
  const std::string format =
      "; expected three int32 (theta_h, theta_d and phi_d bins) and then a "
      "float64 for each bin";
  if (bytes.size() < kHeader) {
    throw ErrorIn(ErrorKind::kFormat, source,
                  "not a histogram: it has " + std::to_string(bytes.size()) + " bytes" + format)
        .About("bytes", bytes.size());
  }
  int32_t sizes[3];
  double bins = 1;
  for (int k = 0; k < 3; ++k) {
    sizes[k] = LoadLittleEndian<int32_t>(bytes.data() + k * sizeof(int32_t));
    bins *= sizes[k];
    if (sizes[k] < 1 || bins > kMaxBins) {
      throw ErrorIn(
          ErrorKind::kFormat, source,
          "not a histogram: it begins with the number of bins " + std::to_string(sizes[k]) + format)
          .About("bins", sizes[k]);
    }
  }
  DirectionHistogram histogram{source, {sizes[0], sizes[1], sizes[2]}, {}};
  const size_t expected = kHeader + histogram.grid.size() * sizeof(double);
  if (bytes.size() != expected) {
    throw ErrorIn(ErrorKind::kFormat, source,
                  "a histogram of " + Text(histogram.grid) + " bins has " +
                      std::to_string(expected) + " bytes, but the file has " +
                      std::to_string(bytes.size()))
        .About("bytes", bytes.size());
  }
  bool any = false;
  for (int bin = 0; bin < histogram.grid.size(); ++bin) {
    const auto count = LoadLittleEndian<double>(bytes.data() + kHeader + bin * sizeof(double));
    if (!(count >= 0 && count <= 1e50)) {
      throw ErrorIn(ErrorKind::kRange, source,
                    "the count of bin " + std::to_string(bin) + " is " + std::to_string(count) +
                        "; counts must be from 0 to 1e50")
          .About("bin " + std::to_string(bin), count);
    }
    any = any || count > 0;
    histogram.counts.push_back(count);
  }
  if (!any) {
    throw ErrorIn(ErrorKind::kData, source, "all counts are 0, so no direction would be used")
        .About("counts");
  }
  return histogram;
}

BrdfSamples UsedSamples(const BrdfSamples& samples, const SceneDirections& directions,
                        bool anisotropic) {
  const Selection selection =
      std::visit([&](const auto& form) { return Select(samples, form); }, directions);
  if (selection.numbers.empty()) {
    throw ErrorIn(ErrorKind::kData, samples.source,
                  "no valid sample lies in the directions that the scene uses; widen them")
        .About("directions");
  }
  BrdfSamples used = Selected(samples, selection.numbers);
  if (!selection.reads.empty()) {
    used.counted = true;
    used.multiplicity = selection.reads;
    const double mean = std::accumulate(selection.reads.begin(), selection.reads.end(), 0.0) /
                        static_cast<double>(selection.reads.size());
    for (double& times : used.multiplicity) times /= mean;
  } else {
    used.multiplicity.clear();  // that of all samples, which may lie otherwise than those used
    if (!anisotropic) EvenOutDensity(&used);
  }
  return used;
}

}  // namespace trilobe
