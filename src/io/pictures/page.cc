#include "io/pictures/page.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/file_names.h"
#include "core/base/json_text.h"
#include "io/pictures/document.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/model_file.h"

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
  // Rice code: number >> low ones, a zero, and the low bits.
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
  data.kind = MeasuredData::Kind::kNodes;
  data.shape = {nodes, nodes};
  data.grid = grid;
  data.max_theta = table.max_theta;
  data.samples = static_cast<int>(std::ranges::count(table.present, true));
  data.bits = Encoded(values, nodes, nodes);
  return data;
}

namespace {

void AddFloat(double x, std::string* bytes) {
  const auto bits = std::bit_cast<uint32_t>(static_cast<float>(x));
  for (int shift = 0; shift < 32; shift += 8) *bytes += static_cast<char>(bits >> shift & 255);
}

}  // namespace

MeasuredData EncodeMeasured(const BrdfSamples& samples, double max_theta, bool anisotropic) {
  if (samples.directions.size() != samples.rho.size()) {
    throw ErrorIn(ErrorKind::kMissing, samples.source, "samples without directions")
        .About("directions");
  }
  MeasuredData data;
  data.kind = MeasuredData::Kind::kSamples;
  data.samples = samples.size();
  const int64_t kept = std::min(samples.size(), kMostSamples);
  data.shape = {static_cast<int>(kept)};
  data.max_theta = max_theta;
  data.anisotropic = anisotropic;
  for (int64_t k = 0; k < kept; ++k) {
    const auto j = static_cast<size_t>(k * samples.size() / kept);
    const SphericalAngles& at = samples.directions[j];
    for (const double angle : {at.theta_i, at.phi_i, at.theta_o, at.phi_o}) {
      AddFloat(RadiansToDegrees(angle), &data.bits);
    }
    for (const double rho : samples.rho[j]) AddFloat(rho, &data.bits);
  }
  return data;
}

namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const MeasuredData& data) {
  Json json = {{"kind", ""}, {"shape", data.shape}, {"samples", data.samples}};
  if (data.kind == MeasuredData::Kind::kSamples) {
    json["kind"] = "samples";
    json.update({{"max_theta", data.max_theta}, {"anisotropic", data.anisotropic}});
  } else {
    json["kind"] = data.kind == MeasuredData::Kind::kNodes ? "nodes" : "table";
    json.update({{"floor", kMeasuredFloor}, {"steps", kMeasuredSteps}});
  }
  if (data.kind == MeasuredData::Kind::kNodes) {
    json.update(
        {{"thetas", data.grid.thetas}, {"phis", data.grid.phis}, {"max_theta", data.max_theta}});
  }
  json["data"] = Base64(data.bits);
  return json;
}

// Mantissas of 8 bits and the exponent that they share (Ward 1991).
std::array<char, 4> ToRgbe(const Rgb& color) {
  const double most = std::ranges::max(color);
  if (!(most > 1e-30)) return {};
  int exponent = 0;
  const double scale = std::frexp(std::min(most, 1e30), &exponent) * 256 / most;
  std::array<char, 4> bytes{};
  for (int c = 0; c < kChannels; ++c) {
    bytes[c] = static_cast<char>(static_cast<unsigned char>(std::min(color[c] * scale, 255.0)));
  }
  bytes[3] = static_cast<char>(static_cast<unsigned char>(exponent + 128));
  return bytes;
}

// The environment, halved to at most 512 columns as far as both sizes are even: means of pixels.
Json ToJson(const Environment& probe) {
  int step = 1;
  while (probe.width / step > 512 && probe.width % (2 * step) == 0 &&
         probe.height % (2 * step) == 0) {
    step *= 2;
  }
  const int width = probe.width / step, height = probe.height / step;
  std::string bytes;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      Rgb mean{};
      for (int k = 0; k < step * step; ++k) {
        const int line = k / step;
        const int at = (row * step + line) * probe.width + column * step + k % step;
        for (int c = 0; c < kChannels; ++c) mean[c] += probe.radiance[at][c] / (step * step);
      }
      for (const char byte : ToRgbe(mean)) bytes += byte;
    }
  }
  return {{"name", Printable(FileNameOf(probe.name))},
          {"width", width},
          {"height", height},
          {"data", Base64(bytes)}};
}

Json ToJson(const std::vector<IterationRecord>& trace) {
  Json rows = Json::array();
  for (const IterationRecord& record : trace) {
    rows.push_back({record.iteration, record.seconds, record.objective});
  }
  return rows;
}

Json Printables(const std::vector<std::string>& sentences) {
  Json json = Json::array();
  for (const std::string& sentence : sentences) json.push_back(Printable(sentence));
  return json;
}

}  // namespace

std::string FormatPage(const ModelFile& model, const PageContents& contents) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json json = {{"name", Printable(contents.name)},
               {"source", Printable(FileNameOf(contents.source))},
               {"parameters", contents.parameters},
               {"verdict", contents.verdict},
               {"visibility", contents.visibility},
               {"psnr_db", number(contents.psnr_db)},
               {"mean_delta_e", number(contents.mean_delta_e)},
               {"delta_e_95", number(contents.delta_e_95)},
               {"of_sphere", contents.of_sphere},
               {"measured_share", contents.measured_share},
               {"reach", contents.reach},
               {"notes", Printables(contents.notes)},
               {"ggx", contents.ggx},
               {"trace", ToJson(contents.trace)}};
  if (contents.measured) json["measured"] = ToJson(*contents.measured);
  if (contents.probe != nullptr) json["probe"] = ToJson(*contents.probe);
  if (!contents.wavelengths.empty()) json["wavelengths"] = contents.wavelengths;
  if (!contents.spheres.empty()) json["spheres"] = Base64(contents.spheres);
  ModelFile colors = model;
  colors.spectral.reset();
  json["model"] = FormatModel(colors);
  return FormatDocument("view.html", Printable(contents.name), JsonText(std::move(json)));
}

}  // namespace trilobe
