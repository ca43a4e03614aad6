#include "io/page/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/page/base64.h"
#include "io/page/document.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/io/model_files/model_file.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const MeasuredData& data) {
  Json json = {{"kind", data.nodes ? "nodes" : "table"},
               {"shape", data.shape},
               {"floor", kMeasuredFloor},
               {"steps", kMeasuredSteps},
               {"samples", data.samples}};
  if (data.nodes) {
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

// In at most 512 columns: means of pixels.
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
  return {{"name", probe.name}, {"width", width}, {"height", height}, {"data", Base64(bytes)}};
}

Json ToJson(const std::vector<IterationRecord>& trace) {
  Json rows = Json::array();
  for (const IterationRecord& record : trace) {
    rows.push_back({record.iteration, record.seconds, record.objective});
  }
  return rows;
}

}  // namespace

std::string FormatPage(const ModelFile& model, const PageContents& contents) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  Json json = {{"name", Printable(contents.name)},
               {"source", Printable(contents.source)},
               {"parameters", contents.parameters},
               {"verdict", contents.verdict},
               {"visibility", contents.visibility},
               {"psnr_db", number(contents.psnr_db)},
               {"mean_delta_e", number(contents.mean_delta_e)},
               {"delta_e_95", number(contents.delta_e_95)},
               {"trace", ToJson(contents.trace)}};
  if (contents.measured) json["measured"] = ToJson(*contents.measured);
  if (contents.probe != nullptr) json["probe"] = ToJson(*contents.probe);
  json["model"] = FormatModel(model);
  return FormatDocument("view.html", Printable(contents.name),
                        json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace trilobe
