// How fast a text table of 10^6 scattered samples is read, in processor time of one thread, against
// the conversion of its numbers alone.
//
//   build/release/benchmarks/read_benchmark

#include <benchmark/benchmark.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

constexpr int kSamples = 1'000'000;

void AppendNumber(double number, char after, std::string* text) {
  std::array<char, 32> buffer;
  constexpr int kDigits = 9;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                 std::chars_format::general, kDigits);
  text->append(buffer.data(), end.ptr).push_back(after);
}

// A row a sample: directions [degrees] and values of a rough surface with 1 % noise.
void AppendRow(double theta_i, double theta_o, double phi, std::mt19937_64* random,
               std::string* text) {
  std::normal_distribution<double> noise(1, 0.01);
  AppendNumber(theta_i, ',', text);
  AppendNumber(0, ',', text);
  AppendNumber(theta_o, ',', text);
  AppendNumber(phi, ',', text);
  const double off = std::hypot(theta_i - theta_o, (180 - std::abs(180 - phi)) / 2 - 90) / 20;
  const double value = 0.1 + std::exp(-off * off);
  for (const char after : {',', ',', '\n'}) AppendNumber(value * noise(*random), after, text);
}

// At random directions.
const std::string& Scattered() {
  static const std::string text = [] {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> cosine(0.02, 1), phi(0, 360);
    std::string rows = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
    for (int j = 0; j < kSamples; ++j) {
      const double theta_i = RadiansToDegrees(std::acos(cosine(random)));
      const double theta_o = RadiansToDegrees(std::acos(cosine(random)));
      AppendRow(theta_i, theta_o, phi(random), &random, &rows);
    }
    return rows;
  }();
  return text;
}

// On the grid of a goniometer.
const std::string& OnGrid() {
  static const std::string text = [] {
    std::mt19937_64 random(1);
    std::string rows = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
    constexpr int kThetas = 40, kPhis = kSamples / kThetas / kThetas;
    for (int j = 0; j < kSamples; ++j) {
      const int row = j / kPhis, i = row / kThetas, o = row % kThetas;
      AppendRow(2.0 * i, 2.0 * o, 360.0 / kPhis * (j % kPhis), &random, &rows);
    }
    return rows;
  }();
  return text;
}

void Count(const std::string& text, benchmark::State* state) {
  state->SetBytesProcessed(state->iterations() * static_cast<int64_t>(text.size()));
}

void Read(benchmark::State& state, const std::string& text) {
  const Source source("table.csv", text);
  for (auto _ : state) benchmark::DoNotOptimize(source.Read());
  Count(text, &state);
}

void FromChars(benchmark::State& state, const std::string& text) {
  const char* const end = text.data() + text.size();
  for (auto _ : state) {
    double sum = 0;
    for (const char* at = text.data() + text.find('\n'); at < end; ++at) {
      double number = 0;
      at = std::from_chars(at, end, number).ptr;
      sum += number;
    }
    benchmark::DoNotOptimize(sum);
  }
  Count(text, &state);
}

BENCHMARK_CAPTURE(Read, scattered, Scattered())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FromChars, scattered, Scattered())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Read, on_grid, OnGrid())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FromChars, on_grid, OnGrid())->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trilobe

BENCHMARK_MAIN();
