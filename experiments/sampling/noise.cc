// How noisy is a sphere under an environment, by what directions are drawn? See README.md beside
// this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/ggx.h"
#include "core/files/file.h"
#include "core/system/process.h"
#include "experiments/program.h"
#include "experiments/sampling/environment_sampler.h"
#include "experiments/sampling/ndf_sampler.h"
#include "io/pictures/image_file.h"
#include "model/appearance/color.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/read_model.h"

DEFINE_int32(size, 64, "pixels across the sphere");
DEFINE_string(samples, "16,64,256", "samples a pixel, of each sampler");
DEFINE_int32(cosine_samples, 4096, "a further number, of the cosine alone");
DEFINE_int32(reference, 4096, "samples a pixel of the reference, by both kinds of samples");
DEFINE_string(out, "", "file for the results, JSON");
DEFINE_string(
    environment, "studio",
    "what lights the sphere: studio, uniform (the same from everywhere), or an .hdr file");
DEFINE_string(pictures, "", "folder for PNG pictures; none if empty");

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;
using Sample = Bsdf<double>::Sample;

// Functions that a renderer asks a material for.
struct Sampler {
  std::string name;
  std::function<Sample(const Direction& wi, const std::array<double, 2>& u)> draw;
  std::function<double(const Direction& wi, const Direction& wo)> pdf;
};

// A pixel of the sphere, seen from afar along z: the frame of its normal, in which x goes around
// the sphere's y axis, and the direction to the eye in it.
struct Pixel {
  int at = 0;
  Direction x{}, y{}, n{}, wi{};

  Direction ToWorld(const Direction& w) const {
    Direction world{};
    for (int k = 0; k < 3; ++k) world[k] = w[0] * x[k] + w[1] * y[k] + w[2] * n[k];
    return world;
  }
  Direction ToLocal(const Direction& w) const { return {Dot(w, x), Dot(w, y), Dot(w, n)}; }
};

std::vector<Pixel> PixelsOfSphere(int size) {
  std::vector<Pixel> pixels;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double px = (2 * column + 1.0) / size - 1, py = 1 - (2 * row + 1.0) / size;
      const double r2 = px * px + py * py;
      if (r2 >= 1) continue;
      Pixel pixel{.at = row * size + column, .n = {px, py, std::sqrt(1 - r2)}};
      const double length = std::hypot(pixel.n[0], pixel.n[2]);
      pixel.x = {pixel.n[2] / length, 0, -pixel.n[0] / length};
      pixel.y = {pixel.n[1] * pixel.x[2] - pixel.n[2] * pixel.x[1],
                 pixel.n[2] * pixel.x[0] - pixel.n[0] * pixel.x[2],
                 pixel.n[0] * pixel.x[1] - pixel.n[1] * pixel.x[0]};
      pixel.wi = pixel.ToLocal({0, 0, 1});
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

// Numbers in [0, 1) that repeat (SplitMix64).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ += 0x9e3779b97f4a7c15ULL;
    uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  uint64_t state_;
};

// `samples` points of [0, 1)^2, stratified: those of the R2 sequence, moved by a random vector, as
// renderers draw neither independent numbers nor the same in each pixel.
class Points {
 public:
  explicit Points(Random* random) : x_((*random)()), y_((*random)()) {}
  std::array<double, 2> Next() {
    x_ += 0.7548776662466927;
    y_ += 0.5698402909980532;
    if (x_ >= 1) x_ -= 1;
    if (y_ >= 1) y_ -= 1;
    return {x_, y_};
  }

 private:
  double x_, y_;
};

Rgb& operator+=(Rgb& a, const Rgb& b) {
  for (int c = 0; c < kChannels; ++c) a[c] += b[c];
  return a;
}

Rgb Times(const Rgb& a, const Rgb& b, double factor) {
  Rgb product{};
  for (int c = 0; c < kChannels; ++c) product[c] = a[c] * b[c] * factor;
  return product;
}

// The radiance of a pixel by directions that the sampler draws. With `lights`, half of the samples
// are drawn from the environment instead, and both are weighed by the balance heuristic (Veach and
// Guibas 1995).
Rgb Estimate(const Pixel& pixel, const Sampler& sampler, const EnvironmentSampler& environment,
             const Bsdf<double>& bsdf, bool lights, int samples, Random* random) {
  Points of_bsdf(random), of_lights(random);
  Rgb sum{};
  const int drawn = lights ? samples / 2 : samples;
  for (int k = 0; k < drawn; ++k) {
    const Sample sample = sampler.draw(pixel.wi, of_bsdf.Next());
    if (sample.pdf > 0) {
      const Direction world = pixel.ToWorld(sample.wo);
      const double share = lights ? sample.pdf / (sample.pdf + environment.Pdf(world)) : 1;
      sum += Times(sample.weight, environment.Radiance(world), share);
    }
    if (!lights) continue;
    const auto [world, pdf] = environment.Draw(of_lights.Next());
    const Direction wo = pixel.ToLocal(world);
    if (!(pdf > 0 && wo[2] > 0)) continue;
    const double share = 1 / (pdf + sampler.pdf(pixel.wi, wo));
    sum += Times(bsdf.Value(pixel.wi, wo), environment.Radiance(world), wo[2] * share);
  }
  return Times(sum, {1, 1, 1}, 1.0 / drawn);
}

struct Picture {
  std::vector<Rgb> radiance;  // [pixel]
  double seconds = 0;
};

Picture Render(const std::vector<Pixel>& pixels, const Sampler& sampler,
               const EnvironmentSampler& environment, const Bsdf<double>& bsdf, bool lights,
               int samples, uint64_t seed) {
  Picture picture;
  Stopwatch stopwatch;
  for (const Pixel& pixel : pixels) {
    Random random(seed * 1'000'003 + static_cast<uint64_t>(pixel.at));
    picture.radiance.push_back(
        Estimate(pixel, sampler, environment, bsdf, lights, samples, &random));
  }
  picture.seconds = stopwatch.Lap();
  return picture;
}

// The mean over pixels and channels of (x - x_ref)^2 / (x_ref^2 + e^2), e a hundredth of the mean
// of the reference, so that black pixels do not decide.
double RelativeMse(const Picture& picture, const Picture& reference) {
  double mean = 0;
  for (const Rgb& rgb : reference.radiance) mean += (rgb[0] + rgb[1] + rgb[2]) / kChannels;
  mean /= static_cast<double>(reference.radiance.size());
  double sum = 0;
  for (size_t k = 0; k < picture.radiance.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      const double right = reference.radiance[k][c], off = picture.radiance[k][c] - right;
      sum += off * off / (right * right + 1e-4 * mean * mean);
    }
  }
  return sum / static_cast<double>(kChannels * picture.radiance.size());
}

// Sampler of a renderer that does not have the model's own: visible normals of the GGX lobe, and
// the share of a cosine, with which a picture is least noisy of those tried.
Sampler FittedGgx(const std::vector<Pixel>& pixels, const EnvironmentSampler& environment,
                  const Bsdf<double>& bsdf, const Picture& reference, Json* described) {
  const auto sampler = [&bsdf](const Ggx& ggx) {
    return Sampler{
        .name = "GGX",
        .draw =
            [ggx, &bsdf](const Direction& wi, const std::array<double, 2>& u) {
              const Ggx::Sample drawn = ggx.SampleWo(wi, u);
              Sample sample{.wo = drawn.wo, .pdf = drawn.pdf};
              if (!(drawn.pdf > 0)) return Sample{};
              const Rgb value = bsdf.Value(wi, drawn.wo);
              sample.weight = Times(value, {1, 1, 1}, drawn.wo[2] / drawn.pdf);
              return sample;
            },
        .pdf = [ggx](const Direction& wi, const Direction& wo) { return ggx.Pdf(wi, wo); }};
  };
  Ggx best;
  double least = std::numeric_limits<double>::infinity();
  for (const double alpha : {0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0}) {
    for (const double diffuse_part : {0.05, 0.2, 0.5, 0.8}) {
      const Ggx ggx{.alpha = alpha, .diffuse_part = diffuse_part};
      const double mse = RelativeMse(
          Render(pixels, sampler(ggx), environment, bsdf, /*lights=*/false, /*samples=*/16, 7),
          reference);
      if (mse < least) {
        least = mse;
        best = ggx;
      }
    }
  }
  *described = {{"alpha", best.alpha}, {"diffuse_part", best.diffuse_part}};
  return sampler(best);
}

Sampler Cosine(const Bsdf<double>& bsdf) {
  return {.name = "cosine",
          .draw =
              [&bsdf](const Direction& wi, const std::array<double, 2>& u) {
                const double r = std::sqrt(u[0]), phi = 2 * kPi * u[1];
                const Direction wo = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u[0])};
                return Sample{.wo = wo,
                              .pdf = wo[2] / kPi,
                              .weight = Times(bsdf.Value(wi, wo), {1, 1, 1}, kPi)};
              },
          .pdf = [](const Direction&, const Direction& wo) { return std::max(wo[2], 0.0) / kPi; }};
}

std::vector<int> Numbers(const std::string& text) {
  std::vector<int> numbers;
  for (size_t at = 0; at < text.size(); at = text.find(',', at) + 1) {
    numbers.push_back(std::stoi(text.substr(at)));
    if (numbers.back() < 2) {
      throw Error(ErrorKind::kRange, "--samples=" + text + ": give numbers of 2 or more")
          .About("samples", text);
    }
    if (text.find(',', at) == std::string::npos) break;
  }
  return numbers;
}

void WritePicture(const std::vector<Pixel>& pixels, const Picture& picture, double exposure,
                  const std::string& name) {
  if (FLAGS_pictures.empty()) return;
  const auto size = static_cast<size_t>(FLAGS_size);
  std::string bytes(size * size * kChannels, '\x20');
  for (size_t k = 0; k < pixels.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      bytes[static_cast<size_t>(pixels[k].at) * kChannels + static_cast<size_t>(c)] =
          static_cast<char>(std::lround(255 * EncodeSrgb(exposure * picture.radiance[k][c])));
    }
  }
  WritePng(FLAGS_pictures + "/" + name + ".png", FLAGS_size, FLAGS_size, bytes);
}

Environment EnvironmentNamed(const std::string& name) {
  if (name == "studio") return StudioEnvironment();
  if (name == "uniform") return {.name = name, .width = 1, .height = 1, .radiance = {{1, 1, 1}}};
  return ReadProbe(name);
}

int Measure(const std::string& path) {
  if (FLAGS_size < 4 || FLAGS_reference < 16) {
    throw Error(ErrorKind::kRange, "--size from 4, --reference from 16").About("size, reference");
  }
  const FactorModel model = ReadModel(path).model;
  const Bsdf<double> bsdf(model);
  std::vector<NdfSampler> ndfs = {NdfSampler(model)};
  if (!model.spec().anisotropic()) ndfs.emplace_back(model, NdfSampler::Bins::kOneDegree);
  const Environment light = EnvironmentNamed(FLAGS_environment);
  const EnvironmentSampler environment(light);
  const std::vector<Pixel> pixels = PixelsOfSphere(FLAGS_size);
  const Sampler ours = {
      .name = "trilobe",
      .draw = [&](const Direction& wi, const auto& u) { return bsdf.SampleWo(wi, u); },
      .pdf = [&](const Direction& wi, const Direction& wo) { return bsdf.Pdf(wi, wo); }};
  const auto by_half_vectors = [](const std::string& name, const NdfSampler& ndf) {
    return Sampler{
        .name = name,
        .draw = [&ndf](const Direction& wi, const auto& u) { return ndf.SampleWo(wi, u); },
        .pdf = [&ndf](const Direction& wi, const Direction& wo) { return ndf.Pdf(wi, wo); }};
  };
  const Picture reference =
      Render(pixels, ours, environment, bsdf, /*lights=*/true, FLAGS_reference, 1);
  Json ggx;
  std::vector<Sampler> samplers = {Cosine(bsdf),
                                   FittedGgx(pixels, environment, bsdf, reference, &ggx),
                                   by_half_vectors("paper", ndfs.front()), ours};
  if (ndfs.size() > 1) samplers.push_back(by_half_vectors("eq8", ndfs.back()));
  double mean = 0;
  for (const Rgb& rgb : reference.radiance) mean += rgb[1];
  const double exposure = 0.18 * static_cast<double>(pixels.size()) / std::max(mean, 1e-300);
  WritePicture(pixels, reference, exposure, "reference");
  Json rows = Json::array();
  for (const bool lights : {false, true}) {
    for (const Sampler& sampler : samplers) {
      std::vector<int> numbers = Numbers(FLAGS_samples);
      if (sampler.name == "cosine" && !lights) numbers.push_back(FLAGS_cosine_samples);
      for (const int samples : numbers) {
        const Picture picture =
            Render(pixels, sampler, environment, bsdf, lights, samples, /*seed=*/2);
        rows.push_back({{"sampler", sampler.name},
                        {"with_lights", lights},
                        {"samples", samples},
                        {"relative_mse", RelativeMse(picture, reference)},
                        {"seconds", picture.seconds}});
        if (!lights) {
          WritePicture(pixels, picture, exposure, sampler.name + "-" + std::to_string(samples));
        }
      }
    }
  }
  const Json json = {{"model", path},
                     {"environment", FLAGS_environment},
                     {"pixels", pixels.size()},
                     {"ggx", ggx},
                     {"rows", rows}};
  WriteFile(FLAGS_out, [&](std::ostream& out) { out << json.dump(1) << "\n"; });
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "noise --out=FILE MODEL", 1,
                              [](auto words) { return trilobe::Measure(words[0]); });
}
