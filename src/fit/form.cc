#include "trilobe/fit/form.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <string_view>
#include <tuple>

#include "core/base/names.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

using Kind = FormOptions::Kind;

constexpr int kLobes = 3;

ModelSpec AnisotropicSpec(const FormOptions& options, const HemisphereGrid& data,
                          double max_theta) {
  const int lobes = LobesOf(options);
  ModelSpec spec = options.kind == Kind::kAnisotropic
                       ? ModelSpec::Anisotropic(lobes)
                       : ModelSpec::AnisotropicFor(lobes, data.phis, max_theta);
  if (options.d_nodes) spec.d_axis = *options.d_nodes;
  if (options.g_nodes) spec.g_axis = *options.g_nodes;
  if (options.f_bins) spec.f_axis.size = *options.f_bins;
  CheckSpec(spec);
  return spec;
}

void CheckNothingAnisotropic(const FormOptions& options) {
  const char* const given = options.d_nodes                                    ? "d_nodes"
                            : options.f_bins                                   ? "f_bins"
                            : options.g_nodes                                  ? "g_nodes"
                            : options.nodes == FormOptions::NodeRule::kHeldOut ? "nodes"
                                                                               : nullptr;
  if (given != nullptr) {
    throw Error(ErrorKind::kUnsupported, "--" + std::string(given) + " is for anisotropic models")
        .About(given);
  }
}

// For directions on a grid of few theta, `g_nodes` is the number of nodes of G, else 0.
ModelSpec IsotropicSpec(const FormOptions& options, const MerlGrid& grid, int g_nodes = 0) {
  CheckNothingAnisotropic(options);
  const bool independent = options.kind == Kind::kIndependent;
  if (independent && LobesOf(options) != 1) {
    throw Error(ErrorKind::kConflict, "--model=independent has one lobe; leave out --lobes")
        .About("lobes", LobesOf(options));
  }
  ModelSpec spec = independent ? ModelSpec::IndependentG(grid)
                               : ModelSpec::SharedFactors(LobesOf(options), grid);
  if (g_nodes > 0) spec.g_axis.size = g_nodes;
  spec.stretches = options.stretches;
  CheckSpec(spec);
  return spec;
}

}  // namespace

const std::vector<NamedForm>& NamedForms() {
  static const std::vector<NamedForm> forms = {
      {"shared", Kind::kShared,
       "D and G shared by the channels, F by the lobes (Peng et al.), anisotropic if the "
       "measurement is, else isotropic"},
      {"isotropic", Kind::kIsotropic, "the same, isotropic for any measurement"},
      {"anisotropic", Kind::kAnisotropic, "on the nodes of the paper and without a prior"},
      {"independent", Kind::kIndependent, "one lobe, nothing shared (Bagher et al.)", 1},
      {"auto", Kind::kShared, "the form that looks best within --max_parameters (docs/forms.md)",
       std::nullopt, true}};
  return forms;
}

const NamedForm& FindForm(std::string_view name) {
  // Models of a few numbers are made of those of tables.
  constexpr std::string_view kOfFewNumbers[] = {"ggx", "gltf", "disney", "principled", "openpbr"};
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  if (std::ranges::find(kOfFewNumbers, lower) != std::end(kOfFewNumbers)) {
    throw Error(ErrorKind::kUnsupported,
                "model '" + std::string(name) +
                    "': fits are of tables; roughness, F0 and base colour come from "
                    "`trilobe convert SOURCE --out=FILE.gltf`, or .usda, .mtlx or .principled.json")
        .About("model", name);
  }
  return FindNamed("model", name, NamedForms());
}

int LobesOf(const FormOptions& options) {
  return options.lobes.value_or(options.kind == Kind::kIndependent ? 1 : kLobes);
}

void CheckForm(const FormOptions& options) {
  if (options.kind == Kind::kAnisotropic || options.kind == Kind::kShared) {
    AnisotropicSpec(options, {}, kPi / 2);
  } else {
    IsotropicSpec(options, {});
  }
}

ModelSpec SpecFor(const Measurement& measurement, const FormOptions& options, int num_samples) {
  CheckForm(options);
  if (measurement.table) {
    if (options.kind == Kind::kAnisotropic) {
      throw ErrorIn(
          ErrorKind::kUnsupported, measurement.source,
          "a " + measurement.kind +
              " knows no azimuths; an anisotropic model needs scattered samples with several "
              "phi_i")
          .About("anisotropic");
    }
    return IsotropicSpec(options, measurement.table->grid);
  }
  const bool anisotropic = options.kind == Kind::kAnisotropic ||
                           (options.kind == Kind::kShared && measurement.anisotropic);
  const std::optional<HemisphereGrid> grid =
      measurement.anisotropic ? GridOf(measurement) : std::nullopt;
  if (anisotropic) {
    if (options.stretches.any()) {
      throw ErrorIn(ErrorKind::kConflict, measurement.source,
                    "--stretch is for isotropic models, and this is to have an "
                    "anisotropic one; --model=isotropic fits the other")
          .About("stretch");
    }
    return AnisotropicSpec(options, grid.value_or(HemisphereGrid()), measurement.max_theta);
  }
  const ModelSpec spec = IsotropicSpec(options, measurement.samples.grid,
                                       grid ? Axis::SplineNodesFor(grid->thetas) : 0);
  return measurement.anisotropic ? spec : spec.ForScattered(num_samples);
}

std::string ModelName(const ModelSpec& spec) {
  if (spec.anisotropic()) return "anisotropic";
  const auto is = [&spec](const ModelSpec& named) {
    return std::tie(spec.lobes, spec.D, spec.F, spec.G) ==
           std::tie(named.lobes, named.D, named.F, named.G);
  };
  if (is(ModelSpec::SharedFactors(spec.lobes))) return "shared";
  if (is(ModelSpec::IndependentG()) && !spec.stretches.any()) return "independent";
  return "other";
}

std::vector<FormSpec> NodesToTry(const Measurement& measurement, const FormOptions& options,
                                 const ModelSpec& spec) {
  if (options.nodes != FormOptions::NodeRule::kHeldOut) return {};
  if (!spec.anisotropic()) {
    throw ErrorIn(ErrorKind::kConflict, measurement.source,
                  "--nodes=held_out is for anisotropic models, and this is "
                  "to have an isotropic one")
        .About("nodes");
  }
  const HemisphereGrid data = GridOf(measurement).value_or(HemisphereGrid());
  return NodeLadder(spec, data.thetas, data.phis);
}

std::vector<FormSpec> FinerNodes(const Measurement& measurement, const FormOptions& options,
                                 const ModelSpec& spec) {
  const bool given = options.d_nodes || options.f_bins || options.g_nodes ||
                     options.nodes != FormOptions::NodeRule::kFinerWhereSeen ||
                     options.kind != FormOptions::Kind::kShared;
  const std::optional<HemisphereGrid> data =
      given || !spec.anisotropic() ? std::nullopt : GridOf(measurement);
  if (!data) return {};
  std::vector<FormSpec> ladder = NodeLadder(spec, data->thetas, data->phis);
  const auto same = std::ranges::find(ladder, spec, &FormSpec::spec);
  ladder.erase(ladder.begin(), same);
  return ladder;
}

}  // namespace trilobe
