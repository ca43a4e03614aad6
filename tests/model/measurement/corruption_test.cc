#include "trilobe/model/measurement/corruption.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/names.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::Each;
using testing::Le;

constexpr const char* kTable = "synth:plastic@16x16x20";
constexpr const char* kScattered = "synth:plastic@4x8";

Measurement Corrupted(const std::string& source, const std::string& text, uint64_t seed = 1,
                      int num_threads = 1) {
  Measurement measurement = LoadMeasurement(source);
  Corrupt(ParseCorruptions(text), seed, num_threads, &measurement);
  return measurement;
}

std::string TextOf(const CorruptionKind& kind, double strength) {
  return kind.name + ":" + std::to_string(strength);
}

std::optional<Error> ErrorFrom(const std::function<void()>& work) {
  return ErrorOf([&] { work(); });
}

struct Changed {
  int lost = 0;      // samples
  int changed = 0;   // samples left, with another value
  double ratio = 0;  // the largest, of new and old values
  double smallest = 0;
};

// A table before and after, bin by bin, at the bins of which `counts` is true.
Changed Compare(const Measurement& before, const Measurement& after,
                const std::function<bool(const HalfDiffAngles&)>& counts) {
  const BrdfTable &a = *before.table, &b = *after.table;
  const std::vector<bool> valid = ValidBins(a), still = ValidBins(b);
  Changed all{.smallest = 1e300};
  for (int bin = 0; bin < a.grid.size(); ++bin) {
    if (!valid[bin] || !counts(a.grid.Center(bin))) continue;
    if (!still[bin]) {
      ++all.lost;
      continue;
    }
    bool same = true;
    for (int c = 0; c < kChannels; ++c) {
      same = same && a.stored[c][bin] == b.stored[c][bin];
      const double ratio = b.stored[c][bin] / a.stored[c][bin];
      all.ratio = std::max(all.ratio, ratio);
      all.smallest = std::min(all.smallest, ratio);
    }
    all.changed += same ? 0 : 1;
  }
  return all;
}
Changed Compare(const Measurement& before, const Measurement& after) {
  return Compare(before, after, [](const HalfDiffAngles&) { return true; });
}

TEST(Corruption, WhatChangesNothingChangesNextToNothing) {
  for (const std::string source : {kTable, kScattered}) {
    const BrdfSamples before = SamplesOf(LoadMeasurement(source));
    for (const CorruptionKind& kind : CorruptionKinds()) {
      const BrdfSamples after = SamplesOf(Corrupted(source, TextOf(kind, kind.nothing)));
      ASSERT_EQ(after.size(), before.size()) << kind.name;
      for (int j = 0; j < after.size(); ++j) {
        for (int c = 0; c < kChannels; ++c) {
          EXPECT_NEAR(after.rho[j][c], before.rho[j][c], 1e-4 * before.rho[j][c]) << kind.name;
        }
      }
    }
  }
}

TEST(Corruption, StrengthsNearItChangeLittle) {
  const Measurement before = LoadMeasurement(kTable);
  for (const std::string text :
       {"noise:0.001",  "dark:0.001",      "photons:1e12",       "outliers:0.001", "spikes:1.01",
        "zeros:0.001",  "gaps:0.001",      "retro:0.1",          "beyond:89.9",    "side:0.001",
        "clip:0.001",   "tilt:0.001",      "origin:-0.001",      "aperture:0.01",  "quantize:40",
        "brackets:12",  "crosstalk:0.001", "stray:0.001",        "flare:1e-6",     "shadow:0.5",
        "cosine:0.001", "repeat:89.9",     "nonreciprocal:0.001"}) {
    // Near the horizon a little light changes much, and so does a little of an angle.
    const Changed change = Compare(before, Corrupted(kTable, text), [](const HalfDiffAngles& at) {
      return std::min(ToCosines(at).i, ToCosines(at).o) > 0.3;
    });
    EXPECT_LE(change.lost, 20) << text;
    const bool few = text == "outliers:0.001" || text == "zeros:0.001";
    if (few) {
      EXPECT_LE(change.changed, 20) << text;
    } else {
      EXPECT_LE(change.ratio, 1.1) << text;
      EXPECT_GE(change.smallest, 0.9) << text;
    }
  }
}

TEST(Corruption, AnyStrengthLeavesNumbersOrSaysThatNoneIsLeft) {
  for (const std::string source : {kTable, kScattered, "synth:charmeuse@3x8"}) {
    for (const CorruptionKind& kind : CorruptionKinds()) {
      for (const double strength : {kind.min, (kind.min + kind.max) / 2, kind.max}) {
        try {
          const BrdfSamples samples = SamplesOf(Corrupted(source, TextOf(kind, strength)));
          EXPECT_NO_THROW(CheckSamples(samples)) << kind.name << strength;
        } catch (const Error& error) {
          EXPECT_THAT(error, IsError(ErrorKind::kData, {.key = kind.name})) << strength;
        }
      }
    }
  }
}

TEST(Corruption, TheSameSeedGivesTheSameForAnyThreads) {
  for (const CorruptionKind& kind : CorruptionKinds()) {
    const double strength = 0.9 * kind.nothing + 0.05 * (kind.min + kind.max);
    const std::string text = TextOf(kind, strength) + ",noise:0.1";
    const auto stored = [&](uint64_t seed, int threads) {
      return Corrupted(kTable, text, seed, threads).table->stored;
    };
    const auto once = stored(1, 1);
    EXPECT_EQ(once, stored(1, 3)) << kind.name;
    EXPECT_NE(once, stored(2, 1)) << kind.name;
  }
}

TEST(Corruption, SharesAreWhatTheySay) {
  const Measurement before = LoadMeasurement(kTable);
  const int valid = CountsOf(before).valid;
  for (const double share : {0.01, 0.3}) {
    const std::string x = ":" + std::to_string(share);
    const Changed outliers = Compare(before, Corrupted(kTable, "outliers" + x));
    const Changed zeros = Compare(before, Corrupted(kTable, "zeros" + x));
    const Changed gaps = Compare(before, Corrupted(kTable, "gaps" + x));
    for (const int count : {outliers.changed, zeros.changed, gaps.lost}) {
      EXPECT_NEAR(count, share * valid, 4 * std::sqrt(share * valid)) << x;
    }
    EXPECT_NEAR(outliers.ratio, 1000, 1e-6);
    EXPECT_EQ(zeros.smallest, 0);
    EXPECT_EQ(gaps.changed + outliers.lost + zeros.lost, 0);
  }
  const Changed spikes = Compare(before, Corrupted(kTable, "spikes:3"));
  EXPECT_EQ(spikes.changed, Compare(before, Corrupted(kTable, "outliers:0.05")).changed);
  EXPECT_NEAR(spikes.ratio, 3, 1e-9);
  const Changed noise = Compare(before, Corrupted(kTable, "noise:0.1"));
  EXPECT_EQ(noise.changed, valid);
  EXPECT_LE(noise.ratio, 1.6);
}

TEST(Corruption, PlacesAreWhereTheySay) {
  const Measurement before = LoadMeasurement(kTable);
  const auto places = [&](const std::string& text,
                          const std::function<bool(const HalfDiffAngles&)>& there) {
    const Measurement after = Corrupted(kTable, text);
    const Changed inside = Compare(before, after, there);
    const Changed outside =
        Compare(before, after, [&](const HalfDiffAngles& at) { return !there(at); });
    EXPECT_EQ(outside.lost + outside.changed, 0) << text;
    EXPECT_GT(inside.lost + inside.changed, 0) << text;
    return inside;
  };
  const auto beyond = [](double degrees) {
    return [cosine = std::cos(DegreesToRadians(degrees))](const HalfDiffAngles& at) {
      return std::min(ToCosines(at).i, ToCosines(at).o) < cosine;
    };
  };
  EXPECT_EQ(places("beyond:60", beyond(60)).changed, 0);
  EXPECT_EQ(places("repeat:60", beyond(60)).lost, 0);
  EXPECT_EQ(
      places("retro:20", [](const HalfDiffAngles& at) { return at.theta_d < DegreesToRadians(10); })
          .changed,
      0);
  EXPECT_LE(places("shadow:10",
                   [](const HalfDiffAngles& at) { return at.theta_d < DegreesToRadians(10); })
                .ratio,
            1);
  EXPECT_EQ(
      places("side:1", [](const HalfDiffAngles& at) { return ToCosines(at).i > ToCosines(at).o; })
          .changed,
      0);
}

TEST(Corruption, ClippedSignalsShareTheirLargestValue) {
  const Measurement before = LoadMeasurement(kTable), after = Corrupted(kTable, "clip:0.1");
  const BrdfSamples samples = SamplesOf(after);
  double largest = 0;
  for (int j = 0; j < samples.size(); ++j) {
    largest = std::max(largest, std::ranges::max(samples.rho[j]) * samples.CosinesOf(j).i);
  }
  int plateau = 0;
  for (int j = 0; j < samples.size(); ++j) {
    for (const double rho : samples.rho[j]) {
      plateau += rho * samples.CosinesOf(j).i > largest * (1 - 1e-12) ? 1 : 0;
    }
  }
  EXPECT_NEAR(plateau, 0.1 * kChannels * samples.size(), 2);
  EXPECT_LE(Compare(before, after).ratio, 1);
}

TEST(Corruption, FormulasOfSingleValues) {
  const BrdfSamples before = SamplesOf(LoadMeasurement(kTable));
  const auto expect = [&](const std::string& text,
                          const std::function<Rgb(const Rgb&, const Cosines&)>& formula) {
    const BrdfSamples after = SamplesOf(Corrupted(kTable, text));
    for (int j = 0; j < before.size(); ++j) {
      const Rgb expected = formula(before.rho[j], before.CosinesOf(j));
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_NEAR(after.rho[j][c], expected[c], 1e-12 * expected[c]) << text << ", sample " << j;
      }
    }
  };
  expect("cosine:1", [](Rgb rho, const Cosines& at) {
    for (double& x : rho) x *= at.i;
    return rho;
  });
  expect("cosine:-1", [](Rgb rho, const Cosines& at) {
    for (double& x : rho) x /= at.i;
    return rho;
  });
  expect("nonreciprocal:0.5", [](Rgb rho, const Cosines& at) {
    for (double& x : rho) x *= std::exp(0.5 * (at.i - at.o));
    return rho;
  });
  expect("crosstalk:1", [](const Rgb& rho, const Cosines&) {
    return Rgb{Mean(rho), Mean(rho), Mean(rho)};
  });
}

TEST(Corruption, QuantizedSignalsAreMultiplesOfTheStep) {
  const BrdfSamples before = SamplesOf(LoadMeasurement(kTable));
  double largest = 0;
  for (int j = 0; j < before.size(); ++j) {
    largest = std::max(largest, std::ranges::max(before.rho[j]) * before.CosinesOf(j).i);
  }
  const BrdfSamples one = SamplesOf(Corrupted(kTable, "quantize:8"));
  const BrdfSamples many = SamplesOf(Corrupted(kTable, "brackets:8"));
  for (int j = 0; j < before.size(); ++j) {
    const double cos_i = before.CosinesOf(j).i;
    for (int c = 0; c < kChannels; ++c) {
      const double steps = one.rho[j][c] * cos_i / largest * 256;
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
      EXPECT_NEAR(one.rho[j][c] * cos_i, before.rho[j][c] * cos_i, largest / 512 * (1 + 1e-9));
      EXPECT_NEAR(many.rho[j][c], before.rho[j][c], before.rho[j][c] / 128);
    }
  }
}

// A highlight about the normal, tilted by x, moves to theta_h = x, towards the light.
TEST(Corruption, ATiltMovesTheHighlight) {
  const std::string source = "synth:copper@45x30x60";
  const BrdfSamples samples = SamplesOf(Corrupted(source, "tilt:4"));
  int brightest = 0;
  const auto is_steep = [&](int j) {
    return samples.Angles(j).theta_d < 0.5 && samples.Angles(j).theta_h < 0.5;
  };
  for (int j = 0; j < samples.size(); ++j) {
    if (is_steep(j) && samples.rho[j][0] > samples.rho[brightest][0]) brightest = j;
  }
  EXPECT_NEAR(RadiansToDegrees(samples.Angles(brightest).theta_h), 4, 0.5);
}

TEST(Corruption, AnApertureBlursTheHighlight) {
  const BrdfSamples before = SamplesOf(LoadMeasurement("synth:chrome@45x30x60"));
  const BrdfSamples after = SamplesOf(Corrupted("synth:chrome@45x30x60", "aperture:4"));
  const auto peak = [](const BrdfSamples& samples) {
    double largest = 0;
    for (int j = 0; j < samples.size(); ++j) {
      if (samples.Angles(j).theta_d < 0.5 && samples.Angles(j).theta_h < 0.5) {
        largest = std::max(largest, samples.rho[j][1]);
      }
    }
    return largest;
  };
  EXPECT_LT(peak(after), 0.9 * peak(before));
  EXPECT_GT(peak(after), 0.1 * peak(before));
}

TEST(Corruption, KindsHappenInTheirOrder) {
  EXPECT_EQ(ParseCorruptions("").size(), 0);
  const std::vector<Corruption> two = ParseCorruptions("gaps:0.5,noise:1e-2");
  ASSERT_EQ(two.size(), 2);
  EXPECT_EQ(two[0].kind->name, "gaps");
  EXPECT_EQ(two[1].strength, 0.01);
  // Corruptions apply in the order given: clipped values get noise, noisy values are clipped.
  const auto largest = [](const std::string& text) {
    const BrdfSamples samples = SamplesOf(Corrupted(kTable, text));
    double all = 0;
    for (int j = 0; j < samples.size(); ++j) {
      all = std::max(all, samples.rho[j][0] * samples.CosinesOf(j).i);
    }
    return all;
  };
  EXPECT_GT(largest("clip:0.1,noise:0.1"), largest("noise:0.1,clip:0.1"));
}

TEST(Corruption, BadTextsAreOneLine) {
  const auto message = [](const std::string& text) {
    return ErrorFrom([&] { ParseCorruptions(text); });
  };
  EXPECT_THAT(message("rust:1"),
              IsError(ErrorKind::kUnknown, {.key = "kind of corruption", .value = "rust"}));
  EXPECT_THAT(message("noise"),
              IsError(ErrorKind::kFormat, {.key = "corruption", .value = "noise"}));
  EXPECT_THAT(message("noise:2"), IsError(ErrorKind::kRange, {.key = "noise", .value = "2"}));
  for (const char* const bad : {"noise:", "noise:x", "noise:nan", "noise:-1", "noise:0.1x", ",",
                                "noise:0.1,", "tilt:1e9", ":1", "noise:0.1,,gaps:0.5"}) {
    EXPECT_TRUE(message(bad)) << bad;
  }
}

TEST(Corruption, WhatLeavesNoSampleSaysSo) {
  for (const std::string text : {"gaps:1", "beyond:0", "retro:180"}) {
    EXPECT_THAT(ErrorFrom([&] { Corrupted(kTable, text); }),
                IsError(ErrorKind::kData,
                        {.file = "synth:plastic@16x16x20", .key = text.substr(0, text.find(':'))}));
  }
}

TEST(Corruption, SamplesThatCannotBeReadBetweenSaySo) {
  EXPECT_THAT(ErrorFrom([&] { Corrupted(kScattered, "noise:0.1,tilt:1"); }),
              IsError(ErrorKind::kUnsupported, {.key = "tilt"}));
  EXPECT_NO_THROW(Corrupted(kScattered, "tilt:1,noise:0.1"));
}

TEST(Corruption, OptionsOfASourceCorruptIt) {
  SourceOptions options;
  options.corrupt = "zeros:0.5";
  const BrdfSamples samples = SamplesOf(LoadMeasurement(kTable, options));
  EXPECT_NEAR(static_cast<int>(std::ranges::count(samples.rho, Rgb{})), 0.5 * samples.size(), 200);
  options.corrupt = "zero:0.5";
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(kTable, options); }),
              IsError(ErrorKind::kUnknown, {.key = "kind of corruption", .value = "zero"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
