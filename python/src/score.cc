#include "trilobe/model/objective/score.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/json_text.h"
#include "fit/reports/score_report.h"
#include "fit_module.h"
#include "model/appearance/picture_data.h"
#include "model/objective/lobe_match.h"
#include "named_values.h"
#include "owned_array.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/read_model.h"

namespace nb = nanobind;

namespace trilobe::python {
namespace {

FactorModel ModelOf(const nb::bytes& text) {
  return ParseModel({text.c_str(), text.size()}, "the model").model;
}

// The text of what `trilobe score --json` prints.
nb::bytes Score(const nb::bytes& model_text, const Measured& measured, const NamedValues& options) {
  const FactorModel model = ModelOf(model_text);
  const Weighting weighting = FindWeighting(OptionOf<std::string>(options, "weighting", "a name"));
  const int threads = ThreadsOf(options);
  const std::shared_ptr<const Measurement> data = measured.data;
  std::string text;
  {
    const nb::gil_scoped_release released;
    const Objective objective(SamplesOf(*data), model.spec(), weighting, threads);
    Scored scored{.model = "the model", .score = ScoreModel(objective, model)};
    std::optional<SeenError> seen;
    const PictureData pictured = PictureDataOf(*data);
    if (pictured.empty()) {
      const BrdfSamples& samples = objective.samples();
      seen = CompareSampledSphere(samples, EvaluateSamples(model, samples, threads),
                                  MaterialOf(model).spherical, data->anisotropic,
                                  {.num_threads = threads});
    } else {
      scored.appearance = CompareAppearance(pictured, MaterialOf(model), {.num_threads = threads});
    }
    scored.verdict = MakeVerdict(scored.appearance, seen, BasisOf(objective.samples(), 0),
                                 {.irreducible = IrreducibleShare(scored.score)});
    text = JsonText(ToJson(scored, objective));
  }
  return nb::bytes(text.data(), text.size());
}

NumpyArray<double> ImageOf(const RenderedImage& image) {
  std::vector<double> values;
  for (const Rgb& radiance : image.radiance) {
    values.insert(values.end(), radiance.begin(), radiance.end());
  }
  const size_t width = image.size, height = image.radiance.size() / width;
  return OwnedArray(std::move(values), {height, width, size_t{3}});
}

int SizeOf(const nb::dict& options) {
  const int size = OptionOf<int>(options, "size", "an integer");
  if (size < 1 || size > 2048) {
    throw Error(ErrorKind::kRange, "size must be from 1 to 2048 pixels").About("size", size);
  }
  return size;
}

// Linear radiance of a model on a sphere under the built-in light. [size][size][3]
NumpyArray<double> RenderModel(const nb::bytes& model_text, const NamedValues& options) {
  const FactorModel model = ModelOf(model_text);
  const AppearanceOptions appearance{.size = SizeOf(options), .num_threads = ThreadsOf(options)};
  RenderedImage image;
  {
    const nb::gil_scoped_release released;
    image = RenderPicture(MaterialOf(model), appearance);
  }
  return ImageOf(image);
}

// The same beside a measurement, of measured directions alone, and the exposure of both.
std::tuple<NumpyArray<double>, NumpyArray<double>, double> RenderPair(const nb::bytes& model_text,
                                                                      const Measured& measured,
                                                                      const NamedValues& options) {
  const FactorModel model = ModelOf(model_text);
  const AppearanceOptions appearance{.size = SizeOf(options), .num_threads = ThreadsOf(options)};
  const std::shared_ptr<const Measurement> data = measured.data;
  std::optional<ImagePair> pair;
  {
    const nb::gil_scoped_release released;
    const PictureData pictured = PictureDataOf(*data);
    const Material material = MaterialOf(model);
    if (pictured.table != nullptr) {
      CheckIsotropic(pictured, material);
      pair = RenderPicture(*pictured.table, material.angular, appearance).counted;
    } else if (pictured.nodes) {
      pair = RenderPicture(*pictured.nodes, material.spherical, Shape::kSphere, appearance).counted;
    } else {
      throw ErrorIn(ErrorKind::kUnsupported, data->source,
                    "samples on no grid make no picture; draw the slices");
    }
  }
  const double exposure = CompareSpheres(pair->measured, pair->fitted).exposure;
  return {ImageOf(pair->measured), ImageOf(pair->fitted), exposure};
}

// Agreement, partners and matches (LobeMatch).
std::tuple<double, std::vector<int>, std::vector<double>> MatchLobesOf(const nb::bytes& reference,
                                                                       const nb::bytes& model) {
  const LobeMatch match =
      MatchLobes(ParseModel({reference.c_str(), reference.size()}, "the reference"),
                 ParseModel({model.c_str(), model.size()}, "the model"));
  return {match.agreement, match.lobe, match.match};
}

}  // namespace

void BindScore(nb::module_* module) {
  module->def("score", &Score, nb::arg("model"), nb::arg("measured"), nb::arg("options"));
  module->def("match_lobes", &MatchLobesOf, nb::arg("reference"), nb::arg("model"));
  module->def("render", &RenderModel, nb::arg("model"), nb::arg("options"));
  module->def("render_pair", &RenderPair, nb::arg("model"), nb::arg("measured"),
              nb::arg("options"));
}

}  // namespace trilobe::python
