// reference MODEL COUNT FILE: what trilobe::Bsdf<double> says of COUNT pairs of directions, for the
// tests of shaders: rows of 19 little-endian float32, wi, wo, value, pdf of them, two numbers, and
// the direction that these draw for wi, its density and weight. Half of the pairs are drawn by the
// model itself, since evenly spread ones miss narrow highlights.
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/read_model.h"

namespace {

using Vector = trilobe::Bsdf<double>::Vector;

// Directions with z from 0.01 to 1, a little above the horizon.
Vector DirectionOf(double u, double v) {
  const double z = 0.01 + 0.99 * u, r = std::sqrt(1 - z * z), phi = 2 * trilobe::kPi * v;
  // Shaders are given single precision.
  const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  return {rounded(r * std::cos(phi)), rounded(r * std::sin(phi)), rounded(z)};
}

void Write(const std::string& model, int count, const std::string& path) {
  const trilobe::Bsdf<double> bsdf(trilobe::ReadModel(model).model);
  std::mt19937_64 engine(1);
  const auto random = [&engine] { return std::uniform_real_distribution<double>()(engine); };
  std::ofstream out(path, std::ios::binary);
  for (int k = 0; k < count; ++k) {
    const Vector wi = DirectionOf(random(), random());
    const std::array<double, 2> u = {static_cast<float>(random()), static_cast<float>(random())};
    const auto sample = bsdf.SampleWo(wi, u);
    Vector wo = DirectionOf(random(), random());
    if (k % 2 == 0 && sample.pdf > 0 && sample.wo[2] > 0.01) {
      for (int a = 0; a < 3; ++a) wo[a] = static_cast<float>(sample.wo[a]);
    }
    const auto value = bsdf.Value(wi, wo);
    const double pdf = bsdf.Pdf(wi, wo);
    const double numbers[] = {wi[0],
                              wi[1],
                              wi[2],
                              wo[0],
                              wo[1],
                              wo[2],
                              value[0],
                              value[1],
                              value[2],
                              pdf,
                              u[0],
                              u[1],
                              sample.wo[0],
                              sample.wo[1],
                              sample.wo[2],
                              sample.pdf,
                              sample.weight[0],
                              sample.weight[1],
                              sample.weight[2]};
    std::array<float, std::size(numbers)> row;
    for (size_t n = 0; n < row.size(); ++n) row[n] = static_cast<float>(numbers[n]);
    out.write(reinterpret_cast<const char*>(row.data()), sizeof(row));
  }
  if (!out.flush()) throw trilobe::Error(trilobe::ErrorKind::kFile, "cannot write " + path);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: reference MODEL COUNT FILE\n";
    return 2;
  }
  try {
    Write(argv[1], std::atoi(argv[2]), argv[3]);
  } catch (const trilobe::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
