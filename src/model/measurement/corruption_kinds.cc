#include "model/measurement/corruption_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/quantile.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/base/angles.h"

namespace trilobe {
namespace {

// Calls change(signal, number) for each signal, rho cos theta_i of one channel; `number` is unique
// to it, for random numbers.
template <typename Change>
void ForEachSignal(Readings* readings, const Change& change) {
  readings->ForEach([&](int j) {
    const double cos_i = readings->CosinesOf(j).i;
    for (int c = 0; c < kChannels; ++c) {
      double& rho = readings->rho(j)[c];
      const double signal = rho * cos_i;
      const double changed = change(signal, kChannels * readings->number(j) + c);
      if (changed != signal) rho = changed / cos_i;
    }
  });
}

bool IsDrawn(double share, uint64_t seed, uint64_t number) {
  return UniformAt(seed, number) < share;
}

void MultiplyShare(double share, double factor, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    if (!IsDrawn(share, seed, readings->number(j))) return;
    for (double& rho : readings->rho(j)) rho *= factor;
  });
}

}  // namespace

void AddNoise(double strength, uint64_t seed, Readings* readings) {
  // exp(sigma z - sigma^2/2) has mean 1 and relative standard deviation `strength`.
  const double sigma = std::sqrt(std::log1p(strength * strength));
  ForEachSignal(readings, [&](double signal, uint64_t number) {
    return signal * std::exp(sigma * NormalAt(seed, number) - sigma * sigma / 2);
  });
}

void AddDarkNoise(double strength, uint64_t seed, Readings* readings) {
  const double sigma = strength * readings->MedianSignal();
  ForEachSignal(readings, [&](double signal, uint64_t number) {
    return std::max(signal + sigma * NormalAt(seed, number), 0.0);
  });
}

void AddPhotonNoise(double strength, uint64_t seed, Readings* readings) {
  const double electron = readings->LargestSignal() / strength;
  if (!(electron > 0)) return;
  ForEachSignal(readings, [&](double signal, uint64_t number) {
    const double mean = signal / electron;
    return std::max(std::round(mean + std::sqrt(mean) * NormalAt(seed, number)), 0.0) * electron;
  });
}

void AddOutliers(double strength, uint64_t seed, Readings* readings) {
  constexpr double kFactor = 1000;
  MultiplyShare(strength, kFactor, seed, readings);
}

void AddSpikes(double strength, uint64_t seed, Readings* readings) {
  constexpr double kShare = 0.05;
  MultiplyShare(kShare, strength, seed, readings);
}

void AddZeros(double strength, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    if (IsDrawn(strength, seed, readings->number(j))) readings->rho(j) = {};
  });
}

void Clip(double strength, uint64_t /*seed*/, Readings* readings) {
  std::vector<double> signals(static_cast<size_t>(kChannels) * readings->size());
  readings->ForEach([&](int j) {
    for (int c = 0; c < kChannels; ++c) {
      signals[static_cast<size_t>(kChannels) * j + c] =
          readings->rho(j)[c] * readings->CosinesOf(j).i;
    }
  });
  const double most = Quantile(&signals, 1 - strength);
  ForEachSignal(readings, [&](double signal, uint64_t) { return std::min(signal, most); });
}

void Quantize(double strength, uint64_t /*seed*/, Readings* readings) {
  const double step = readings->LargestSignal() / std::exp2(strength);
  if (!(step > 0)) return;
  ForEachSignal(readings,
                [&](double signal, uint64_t) { return std::round(signal / step) * step; });
}

void QuantizeInBrackets(double strength, uint64_t /*seed*/, Readings* readings) {
  constexpr double kStops = 2;  // from one exposure to the next
  const double largest = readings->LargestSignal();
  if (!(largest > 0)) return;
  ForEachSignal(readings, [&](double signal, uint64_t) {
    if (!(signal > 0)) return signal;
    // The longest exposure that does not saturate.
    const double shorter = std::floor(std::log2(largest / signal) / kStops) * kStops;
    const double step = largest * std::exp2(-shorter - strength);
    return step > 0 ? std::round(signal / step) * step : signal;
  });
}

void MixChannels(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    const double mean = Mean(readings->rho(j));
    for (double& rho : readings->rho(j)) rho += strength * (mean - rho);
  });
}

void AddStrayLight(double strength, uint64_t /*seed*/, Readings* readings) {
  const double light = strength * readings->MedianSignal();
  ForEachSignal(readings, [&](double signal, uint64_t) { return signal + light; });
}

void AddFlare(double strength, uint64_t /*seed*/, Readings* readings) {
  // The largest signal per degree of theta_i, nearly one for each direction of light.
  constexpr int kDegrees = 90;
  std::array<Rgb, kDegrees> largest{};
  const auto degree_of = [&](int j) {
    const double degrees = RadiansToDegrees(std::acos(std::min(readings->CosinesOf(j).i, 1.0)));
    return std::min(static_cast<int>(degrees), kDegrees - 1);
  };
  for (int j = 0; j < readings->size(); ++j) {
    Rgb& most = largest[degree_of(j)];
    for (int c = 0; c < kChannels; ++c) {
      most[c] = std::max(most[c], readings->rho(j)[c] * readings->CosinesOf(j).i);
    }
  }
  readings->ForEach([&](int j) {
    const Rgb& most = largest[degree_of(j)];
    for (int c = 0; c < kChannels; ++c) {
      readings->rho(j)[c] += strength * most[c] / readings->CosinesOf(j).i;
    }
  });
}

void MultiplyByCosine(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    const double factor = std::pow(readings->CosinesOf(j).i, strength);
    for (double& rho : readings->rho(j)) rho *= factor;
  });
}

void MultiplyByOutgoingCosine(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    const double factor = std::pow(readings->CosinesOf(j).o, strength);
    for (double& rho : readings->rho(j)) rho *= factor;
  });
}

void Multiply(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    for (double& rho : readings->rho(j)) rho *= strength;
  });
}

void BreakReciprocity(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    const Cosines cosines = readings->CosinesOf(j);
    const double factor = std::exp(strength * (cosines.i - cosines.o));
    for (double& rho : readings->rho(j)) rho *= factor;
  });
}

void CastShadow(double strength, uint64_t /*seed*/, Readings* readings) {
  const double end = DegreesToRadians(strength);
  readings->ForEach([&](int j) {
    const double theta_d = readings->ThetaD(j);
    if (theta_d >= end) return;
    for (double& rho : readings->rho(j)) rho *= theta_d / end * (theta_d / end);
  });
}

void LoseAtRandom(double strength, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    if (UniformAt(seed, readings->number(j)) < strength) readings->Lose(j);
  });
}

void LoseCone(double strength, uint64_t /*seed*/, Readings* readings) {
  readings->ForEach([&](int j) {
    if (2 * readings->ThetaD(j) < DegreesToRadians(strength)) readings->Lose(j);
  });
}

void LoseBeyond(double strength, uint64_t /*seed*/, Readings* readings) {
  const double least = strength < 90 ? std::cos(DegreesToRadians(strength)) : 0;
  readings->ForEach([&](int j) {
    const Cosines cosines = readings->CosinesOf(j);
    if (std::min(cosines.i, cosines.o) < least) readings->Lose(j);
  });
}

void LoseSide(double strength, uint64_t seed, Readings* readings) {
  readings->ForEach([&](int j) {
    const DirectionPair pair = readings->Directions(j);
    const bool left = pair.wi[0] * pair.wo[1] > pair.wi[1] * pair.wo[0];
    // A bin stands for both sides and both orders of its directions, one of which is missing.
    const Cosines cosines = readings->CosinesOf(j);
    const bool there = readings->folds_sides() ? cosines.i > cosines.o : left;
    if (there && UniformAt(seed, readings->number(j)) < strength) readings->Lose(j);
  });
}

}  // namespace trilobe
