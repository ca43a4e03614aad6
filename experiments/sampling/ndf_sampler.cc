#include "experiments/sampling/ndf_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/linear_density.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

bool IsAbove(const Direction& w) {
  return w[2] > 0 && std::isfinite(w[0]) && std::isfinite(w[1]) && std::isfinite(w[2]);
}

// In [0, 1); 0 for what is no number.
double Inside(double u) {
  return u > 0 ? std::min(u, 1 - std::numeric_limits<double>::epsilon()) : 0;
}

std::vector<double> NodesAtEachDegree(const ModelSpec& spec) {
  if (spec.d_axis.polar()) {
    throw Error(ErrorKind::kUnsupported, "bins of one degree are those of an isotropic model")
        .About("anisotropic");
  }
  constexpr int kDegrees = 90;
  std::vector<double> y;
  for (int k = 0; k <= kDegrees; ++k) {
    const double sin_theta = std::sin(DegreesToRadians(k));
    y.push_back(sin_theta * sin_theta);
  }
  return y;
}

}  // namespace

NdfSampler::NdfSampler(const FactorModel& model, Bins bins)
    : model_(model),
      y_(bins == Bins::kOfModel ? NodesOfY(model.spec()) : NodesAtEachDegree(model.spec())),
      num_phi_(model.spec().d_axis.polar() ? model.spec().d_axis.phi_nodes : 1) {
  const double diffuse = kPi * Mean(model_.diffuse());
  double all = diffuse;
  for (int m = 0; m < model_.lobes(); ++m) {
    tables_.push_back(MakeTable(model, m));
    tables_[m].part = ReflectedBy(m);
    all += tables_[m].part;
  }
  if (!(all <= std::numeric_limits<float>::max())) {
    throw Error(ErrorKind::kData, "the model's values overflow; its factors are too large")
        .About("model", "overflow");
  }
  cosine_part_ = all > 0 ? diffuse / all : 1;
  for (Table& table : tables_) table.part = all > 0 ? table.part / all : 0;
}

NdfSampler::Table NdfSampler::MakeTable(const FactorModel& model, int lobe) const {
  Table table;
  for (size_t k = 0; k < y_.size(); ++k) {
    const double theta = std::asin(std::sqrt(y_[k]));
    double mean = 0;
    for (int p = 0; p < num_phi_; ++p) {
      const Stencil at = model.spec().d_axis.At(theta, 2 * kPi * p / num_phi_);
      double value = 0;
      for (int c = 0; c < kChannels; ++c) value += model.s(lobe)[c] * at(model.D(lobe, c));
      table.values.push_back(value);
      mean += value / num_phi_;
    }
    table.row.push_back(mean);
    table.cumulated.push_back(
        k == 0 ? 0 : table.cumulated[k - 1] + (table.row[k - 1] + mean) / 2 * (y_[k] - y_[k - 1]));
  }
  return table;
}

// The mean of f cos theta_o over its density, of wi at even steps of sin^2 theta_i; of half vectors
// at even steps of what is drawn.
double NdfSampler::ReflectedBy(int lobe) const {
  constexpr int kSteps = 8, kDraws = 12;
  const Table& table = tables_[lobe];
  if (!(table.cumulated.back() > 0)) return 0;
  std::vector<PreparedModel<double>::Colour> values(model_.lobes());
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double theta_i = std::asin(std::sqrt((i + 0.5) / kSteps));
    const Direction wi = ToDirection({theta_i, 2 * kPi * i / kSteps});
    for (int k = 0; k < kDraws * kDraws; ++k) {
      const int row = k / kDraws, column = k % kDraws;
      const HalfVector drawn = Draw(table, (column + 0.5) / kDraws, (row + 0.5) / kDraws);
      const Direction h = ToDirection({std::asin(std::sqrt(drawn.y)), drawn.phi});
      const double twice = 2 * Dot(wi, h), density = Density(table, h);
      const Direction wo = {twice * h[0] - wi[0], twice * h[1] - wi[1], twice * h[2] - wi[2]};
      if (!(twice > 0 && wo[2] > 0 && density > 0)) continue;
      model_.LobeValues(wi, wo, values.data());
      sum += std::max(Mean(values[lobe]), 0.0) * wo[2] * 2 * twice / density;
    }
  }
  return sum / (kSteps * kDraws * kDraws);
}

NdfSampler::HalfVector NdfSampler::Draw(const Table& table, double u_y, double u_phi) const {
  const double wanted = u_y * table.cumulated.back();
  const auto upper =
      std::upper_bound(table.cumulated.begin() + 1, table.cumulated.end() - 1, wanted);
  const size_t k = upper - table.cumulated.begin() - 1;
  const double width = y_[k + 1] - y_[k];
  const double t =
      InvertLinearIntegral((wanted - table.cumulated[k]) / width, table.row[k], table.row[k + 1]);
  const double y = y_[k] + t * width;
  if (num_phi_ == 1) return {y, 2 * kPi * u_phi};
  const double* const low = &table.values[k * num_phi_];
  const auto value = [&](int p) {
    const int node = p % num_phi_;
    return (1 - t) * low[node] + t * low[node + num_phi_];
  };
  double left = 0;
  for (int p = 0; p < num_phi_; ++p) left += value(p);
  left *= u_phi;
  int p = 0;
  for (; p + 1 < num_phi_; ++p) {
    const double cell = (value(p) + value(p + 1)) / 2;
    if (left < cell) break;
    left -= cell;
  }
  const double f = InvertLinearIntegral(std::max(left, 0.0), value(p), value(p + 1));
  return {y, 2 * kPi * (p + f) / num_phi_};
}

// The density over y and phi is value / (2 pi integral of row), and d omega_h = dy d phi / (2 cos).
double NdfSampler::Density(const Table& table, const Direction& h) const {
  if (!(table.cumulated.back() > 0)) return 0;
  const double y = std::clamp(h[0] * h[0] + h[1] * h[1], 0.0, 1.0);
  const auto upper = std::upper_bound(y_.begin() + 1, y_.end() - 1, y);
  const size_t k = upper - y_.begin() - 1;
  const double t = (y - y_[k]) / (y_[k + 1] - y_[k]);
  const double* const low = &table.values[k * num_phi_];
  const double x = num_phi_ == 1 ? 0 : (std::atan2(h[1], h[0]) / (2 * kPi) + 1) * num_phi_;
  const int p = static_cast<int>(x);
  const double f = x - p;
  const int a = p % num_phi_, b = (p + 1) % num_phi_;
  const double value = (1 - t) * ((1 - f) * low[a] + f * low[b]) +
                       t * ((1 - f) * low[num_phi_ + a] + f * low[num_phi_ + b]);
  return value * h[2] / (kPi * table.cumulated.back());
}

NdfSampler::Sample NdfSampler::SampleWo(const Direction& wi, const std::array<double, 2>& u) const {
  Sample sample;
  if (!IsAbove(wi)) return sample;
  double u0 = Inside(u[0]);
  const double u1 = Inside(u[1]);
  if (u0 < cosine_part_) {
    const double r2 = u0 / cosine_part_, r = std::sqrt(r2), phi = 2 * kPi * u1;
    sample.wo = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r2)};
  } else {
    u0 -= cosine_part_;
    size_t m = 0;
    // The last one that is drawn at all takes what rounding leaves.
    for (size_t k = 0; k < tables_.size(); ++k) {
      if (!(tables_[k].part > 0)) continue;
      m = k;
      if (u0 < tables_[k].part) break;
      u0 -= tables_[k].part;
    }
    const HalfVector drawn = Draw(tables_[m], Inside(u0 / tables_[m].part), u1);
    const double sin_h = std::sqrt(drawn.y);
    const Direction h = {sin_h * std::cos(drawn.phi), sin_h * std::sin(drawn.phi),
                         std::sqrt(1 - drawn.y)};
    const double twice = 2 * Dot(wi, h);
    for (int a = 0; a < 3; ++a) sample.wo[a] = twice * h[a] - wi[a];
  }
  sample.pdf = Pdf(wi, sample.wo);
  if (!(sample.pdf > 0)) return sample;
  const Rgb value = model_.Value(wi, sample.wo);
  for (int c = 0; c < kChannels; ++c) sample.weight[c] = value[c] * sample.wo[2] / sample.pdf;
  return sample;
}

double NdfSampler::Pdf(const Direction& wi, const Direction& wo) const {
  if (!(IsAbove(wi) && IsAbove(wo))) return 0;
  Direction h = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const double length = std::sqrt(Dot(h, h));  // 2 (wi . h)
  for (double& x : h) x /= length;
  double lobes = 0;
  for (const Table& table : tables_) {
    if (table.part > 0) lobes += table.part * Density(table, h);
  }
  return cosine_part_ * wo[2] / kPi + lobes / (2 * length);
}

}  // namespace trilobe
