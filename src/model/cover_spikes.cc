#include "model/cover_spikes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/base/lanes.h"
#include "model/max_phi.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/model/stretch.h"

namespace trilobe {
namespace {

using Rgb4 = Four<float>;

// The largest weight left at the measured directions; between them it may be half as large again.
constexpr double kMostWeight = 2.5;

// Weights are measured up to this theta_i [rad], ...
constexpr double kLastTheta = DegreesToRadians(85.1);
// ... beyond kGrazing in finer steps of theta_i [rad] and of s.
constexpr double kGrazing = DegreesToRadians(70);
constexpr double kStep = DegreesToRadians(1.25), kGrazingStep = DegreesToRadians(0.1);
constexpr int kSamples = 2, kGrazingSamples = 4;  // between two nodes of s, ...
constexpr int kMostSamples = 256;                 // ... and of all s at most

constexpr int kSweeps = 10;

// Largest factor by which the light of the table of one theta_i may grow.
constexpr double kMostGrowth = 2;

// The lobes of an isotropic model, read from fine tables: D over the root of theta_h, F and G / cos
// theta, and the squared factors of each stretch, over angles.
class Lobes {
 public:
  explicit Lobes(const FactorModel& model)
      : lobes_(model.spec().lobes),
        stretches_(static_cast<int>(model.spec().stretches.distinct().size())),
        stretched_(model.spec().stretches.any()),
        D_(kBins + 1),
        F_(kBins + 1),
        G_(kBins + 1),
        along_(kBins + 1),
        across_(kBins + 1) {
    const ModelSpec& spec = model.spec();
    for (int bin = 0; bin <= kBins; ++bin) {
      const double part = static_cast<double>(bin) / kBins, theta = kPi / 2 * part;
      const Stencil at_d = spec.d_axis.At(theta * part, 0), at_f = spec.f_axis.At(theta, 0),
                    at_g = spec.g_axis.At(theta, 0);
      const double cosine = std::max(std::cos(theta), 1e-3);
      for (int m = 0; m < lobes_; ++m) {
        stretch_of_[m] = spec.stretches.index(m);
        for (int c = 0; c < kChannels; ++c) {
          D_[bin][m][c] = static_cast<float>(model.s(m)[c] * at_d(model.D(m, c)));
          F_[bin][m][c] = static_cast<float>(at_f(model.F(m, c)));
          G_[bin][m][c] = static_cast<float>(std::max(at_g(model.G(m, c)), 0.0) / cosine);
        }
      }
      for (int k = 0; k < stretches_; ++k) {
        const Stretch& stretch = spec.stretches.distinct()[k];
        along_[bin][k] = static_cast<float>(std::pow(cosine, 2 * stretch.along));
        across_[bin][k] = static_cast<float>(std::pow(cosine, 2 * stretch.across));
      }
    }
  }

  // Whether the nodes of a table see all: no highlight is stretched, and F and G change by less
  // than four times per degree.
  bool smooth() const {
    if (stretched_) return false;
    constexpr float kMostRatio = 1.15F;  // from bin to bin
    const auto jumps = [&](const Values& a, const Values& b) {
      for (int m = 0; m < lobes_; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          if (std::max(a[m][c], b[m][c]) > kMostRatio * std::min(a[m][c], b[m][c])) return true;
        }
      }
      return false;
    };
    for (int bin = 0; bin < static_cast<int>(kBins * kLastTheta / (kPi / 2)); ++bin) {
      if (jumps(F_[bin], F_[bin + 1]) || jumps(G_[bin], G_[bin + 1])) return false;
    }
    return true;
  }

  struct Cosines {
    double i, o, d;
  };
  // f of all lobes in the channel where it is largest.
  float Most(const Cosines& cosines, float theta_h, float sin_h) const {
    const int bin_d = BinOf(cosines.d);
    const Values &F = F_[bin_d], &G_i = G_[BinOf(cosines.i)], &G_o = G_[BinOf(cosines.o)];
    std::array<int, kMaxLobes> bin_h;
    const auto cos_d = static_cast<float>(cosines.d);
    const auto across = static_cast<float>(cosines.o - cosines.i);
    const float sines = 4 * sin_h * sin_h * (1 - cos_d * cos_d);
    const float cos2_phi = sines > 0 ? std::min(across * across / sines, 1.0F) : 1.0F;
    for (int k = 0; k < stretches_; ++k) {
      const float factor2 =
          stretched_ ? cos2_phi * along_[bin_d][k] + (1 - cos2_phi) * across_[bin_d][k] : 1.0F;
      const float part = std::sqrt(theta_h * std::sqrt(factor2) * static_cast<float>(2 / kPi));
      bin_h[k] = static_cast<int>(std::lrint(std::min(part, 1.0F) * kBins));
    }
    Rgb4 sum{};
    for (int m = 0; m < lobes_; ++m) {
      sum += D_[bin_h[stretch_of_[m]]][m] * F[m] * (G_i[m] * G_o[m]);
    }
    const float most = std::max({sum[0], sum[1], sum[2]});
    return most <= std::numeric_limits<float>::max() ? most : 0;
  }

 private:
  using Values = std::array<Rgb4, kMaxLobes>;
  static constexpr int kBins = 900;
  static int BinOf(double cosine) {
    const float angle = AngleOfCosine(static_cast<float>(cosine));
    return std::clamp(static_cast<int>(std::lrint(angle * static_cast<float>(kBins / (kPi / 2)))),
                      0, kBins);
  }

  int lobes_, stretches_;
  bool stretched_;
  std::array<int, kMaxLobes> stretch_of_{};
  std::vector<Values> D_, F_, G_;
  std::vector<std::array<float, kMaxLobes>> along_, across_;
};

class Cover {
 public:
  Cover(const FactorModel& model, double diffuse, const HalfVectorNodes& nodes,
        std::vector<float>* values)
      : lobes_(model),
        diffuse_(diffuse),
        nodes_(nodes),
        rows_(static_cast<int>(nodes.y.size())),
        values_(*values) {}

  bool Run() {
    if (lobes_.smooth()) return true;
    Measure();
    const std::vector<double> before = Totals();
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const std::vector<double> totals = Totals();
      for (size_t ring = 0; ring < totals.size(); ++ring) {
        if (totals[ring] > kMostGrowth * before[ring]) return false;
      }
      if (!Raise(totals)) break;
    }
    return true;
  }

 private:
  // A theta_i between two nodes, where in each row or, at a `u` of 1/2, between it and the next
  // one, `samples` places of s are measured.
  struct Between {
    int ring;
    double t, u;
    int samples;
  };
  // The angles of a row of half vectors.
  struct Geometry {
    Geometry(double cosine, double y) : cos_i(cosine) {
      cos_h = std::sqrt(1 - y);
      const double sin_i = std::sqrt(1 - cos_i * cos_i);
      sin_h = std::sqrt(y);
      phi_max = MaxPhi(cos_i, sin_i, cos_h, sin_h);
      cosines = cos_i * cos_h;
      sines = sin_i * sin_h;
    }
    double CosD(double cos_phi) const { return cosines + sines * cos_phi; }
    double CosO(double cos_d) const { return 2 * cos_d * cos_h - cos_i; }
    double cos_i, cos_h, sin_h, phi_max, cosines, sines;
  };

  // Computes the values of the lobes between the nodes, in the channel where they are largest.
  void Measure() {
    const std::vector<double>& theta_i = nodes_.theta_i;
    for (int ring = 0; ring + 1 < static_cast<int>(theta_i.size()); ++ring) {
      const bool grazing = theta_i[ring] >= kGrazing;
      const double width = theta_i[ring + 1] - theta_i[ring];
      const int steps = static_cast<int>(std::ceil(width / (grazing ? kGrazingStep : kStep)));
      for (int k = 0; k < steps; ++k) {
        const double t = (k + 0.5) / steps, theta = theta_i[ring] + t * width;
        if (theta > kLastTheta) return;
        const double u = between_.size() % 2 == 0 ? 0 : 0.5;
        const int between_nodes = grazing ? kGrazingSamples : kSamples;
        const int samples = std::min((nodes_.s - 1) * between_nodes, kMostSamples);
        between_.push_back({ring, t, u, samples});
        for (int row = 0; row + 1 < rows_; ++row) {
          const double y = (1 - u) * nodes_.y[row] + u * nodes_.y[row + 1];
          MeasureRow({std::cos(theta), y}, samples);
        }
      }
    }
  }

  void MeasureRow(const Geometry& at, int samples) {
    // The next azimuth by a rotation.
    const double step = at.phi_max / samples, cos_step = std::cos(step), sin_step = std::sin(step);
    double cos_phi = std::cos(step / 2), sin_phi = std::sin(step / 2);
    const auto sin_h = static_cast<float>(at.sin_h),
               theta_h = static_cast<float>(AngleOfCosine(at.cos_h));
    for (int k = 0; k < samples; ++k) {
      const double cos_d = at.CosD(cos_phi), cos_o = at.CosO(cos_d);
      const double scale = cos_o * 4 * cos_d * at.phi_max / std::max(at.cos_h, 1e-2);
      most_.push_back(cos_o > 0 && cos_d > 0
                          ? lobes_.Most({at.cos_i, cos_o, cos_d}, theta_h, sin_h) *
                                static_cast<float>(scale)
                          : 0);
      const double next = cos_phi * cos_step - sin_phi * sin_step;
      sin_phi = sin_phi * cos_step + cos_phi * sin_step;
      cos_phi = next;
    }
  }

  // The table's integral at each theta_i.
  std::vector<double> Totals() const {
    std::vector<double> totals;
    for (size_t ring = 0; ring < nodes_.theta_i.size(); ++ring) {
      double total = 0, before = 0;
      for (int row = 0; row < rows_; ++row) {
        const float* const at = &values_[(ring * rows_ + row) * nodes_.s];
        double of_row = -0.5 * (at[0] + at[nodes_.s - 1]);
        for (int k = 0; k < nodes_.s; ++k) of_row += at[k];
        of_row /= nodes_.s - 1;
        if (row > 0) total += (before + of_row) / 2 * (nodes_.y[row] - nodes_.y[row - 1]);
        before = of_row;
      }
      totals.push_back(total);
    }
    return totals;
  }

  // Raises the nodes around each place where the table has too little, by least squares: nothing
  // that was enough becomes too little, but for the totals, which grow. False if all is enough.
  bool Raise(const std::vector<double>& totals) {
    bool raised = false;
    const float* most = most_.data();
    for (const Between& at : between_) {
      const double lobes = totals[at.ring] * (1 - at.t) + totals[at.ring + 1] * at.t;
      const double part = (diffuse_ + (1 + kCosineShare) * lobes) / kMostWeight;
      for (int row = 0; row + 1 < rows_; ++row, most += at.samples) {
        raised |= RaiseRow(at, row, static_cast<float>(part), most);
      }
    }
    return raised;
  }

  bool RaiseRow(const Between& at, int row, float part, const float* most) {
    bool raised = false;
    float* const low = &values_[(static_cast<size_t>(at.ring) * rows_ + row) * nodes_.s];
    float* const high = low + static_cast<size_t>(rows_) * nodes_.s;
    const auto t = static_cast<float>(at.t), u = static_cast<float>(at.u);
    const float nodes_per_sample =
        static_cast<float>(nodes_.s - 1) / static_cast<float>(at.samples);
    for (int k = 0; k < at.samples; ++k) {
      const float x = (static_cast<float>(k) + 0.5F) * nodes_per_sample;
      const int n = static_cast<int>(x);
      const float f = x - static_cast<float>(n);
      float value = 0, squares = 0;
      const auto of_nodes = [&](const auto& visit) {
        for (int upper = 0; upper < (u > 0 ? 2 : 1); ++upper) {
          float* const below = low + upper * nodes_.s + n;
          float* const above = high + upper * nodes_.s + n;
          const float v = upper == 1 ? u : 1 - u;
          visit(v * (1 - t) * (1 - f), below[0]);
          visit(v * (1 - t) * f, below[1]);
          visit(v * t * (1 - f), above[0]);
          visit(v * t * f, above[1]);
        }
      };
      of_nodes([&](float weight, float node) {
        value += weight * node;
        squares += weight * weight;
      });
      const float missing = most[k] * part - value;
      if (!(missing > 1e-3F * value)) continue;
      of_nodes([&](float weight, float& node) { node += missing / squares * weight; });
      raised = true;
    }
    return raised;
  }

  const Lobes lobes_;
  const double diffuse_;
  const HalfVectorNodes& nodes_;
  const int rows_;
  std::vector<float>& values_;
  std::vector<Between> between_;
  std::vector<float> most_;  // [between_][y][samples]
};

}  // namespace

bool CoverSpikes(const FactorModel& model, double diffuse, const HalfVectorNodes& nodes,
                 std::vector<float>* values) {
  return Cover(model, diffuse, nodes, values).Run();
}

}  // namespace trilobe
