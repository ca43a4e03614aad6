#include "trilobe/app/model_flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "trilobe/app/flags.h"
#include "trilobe/base/error.h"
#include "trilobe/io/text_lines.h"

DEFINE_string(
    model, "shared",
    "shared: D and G shared by the channels, F by the lobes (Peng et al.), isotropic, or "
    "anisotropic "
    "where the measurement is; isotropic, anisotropic: that one of the two; independent: "
    "one lobe, nothing shared (Bagher et al.); auto: what looks best within --max_numbers "
    "(docs/model-choice.md)");
DEFINE_string(
    d_nodes, "6x48",
    "of an anisotropic model, nodes of D: so many theta_h by so many phi_h, theta_h at even "
    "steps, or with an r (12rx48) of the root of theta_h");
DEFINE_string(g_nodes, "6x48", "of an anisotropic model, nodes of G: theta by phi, at even steps");

namespace trilobe {
namespace {

constexpr double kUtiaMaxTheta = 75;  // [degrees]

// "6x48", or "12rx48" where `with_root` may be.
Axis ParseNodes(const char* flag, std::string_view text, bool with_root) {
  const size_t x = text.find('x');
  std::string_view theta = text.substr(0, x);
  const bool root = with_root && theta.ends_with('r');
  if (root) theta.remove_suffix(1);
  const std::optional<int> rings = ToInteger(theta);
  const std::optional<int> phi =
      x == std::string::npos ? std::nullopt : ToInteger(text.substr(x + 1));
  if (!rings || !phi || *rings < 2 || *rings > 90 || *phi < 2 || *phi > 720) {
    throw Error("--" + std::string(flag) + "=" + std::string(text) +
                " are no nodes; give theta x phi, as 6x48" +
                (with_root ? ", or 12rx48 for steps of the root of theta" : ""));
  }
  std::vector<double> nodes;
  for (int a = 0; a < *rings; ++a) {
    const double t = static_cast<double>(a) / (*rings - 1);
    nodes.push_back(kUtiaMaxTheta * (root ? t * t : t));
  }
  Axis axis = Axis::Polar(std::move(nodes), *phi);
  CheckAxis(axis, flag[0] == 'd' ? "D" : "G");
  return axis;
}

ModelSpec Spec(const MerlGrid& grid, bool anisotropic) {
  if (!anisotropic) {
    for (const char* const flag : {"d_nodes", "g_nodes"}) {
      if (!IsDefault(flag)) throw Error("--" + std::string(flag) + " is for anisotropic models");
    }
  }
  if (FLAGS_model == "independent") {
    if (!IsDefault("lobes") && FLAGS_lobes != 1) {
      throw Error("--model=independent has one lobe; leave out --lobes");
    }
    return ModelSpec::IndependentG(grid);
  }
  ModelSpec spec = anisotropic ? ModelSpec::Anisotropic(FLAGS_lobes)
                               : ModelSpec::SharedFactors(FLAGS_lobes, grid);
  if (anisotropic) {
    spec.d_axis = ParseNodes("d_nodes", FLAGS_d_nodes, true);
    spec.g_axis = ParseNodes("g_nodes", FLAGS_g_nodes, false);
  }
  CheckSpec(spec);
  return spec;
}

}  // namespace

ModelSpec SpecFromFlags(const Measurement& measurement) {
  CheckModelFlags();
  if (measurement.table) {
    if (FLAGS_model == "anisotropic") {
      throw Error(measurement.source + ": a " + measurement.kind +
                  " knows no azimuths; an anisotropic model needs scattered samples with several "
                  "phi_i");
    }
    return Spec(measurement.table->grid, false);
  }
  const bool anisotropic =
      FLAGS_model == "anisotropic" || (FLAGS_model == "shared" && measurement.anisotropic);
  return Spec(measurement.samples.grid, anisotropic);
}

void CheckModelFlags() {
  constexpr const char* kNames[] = {"shared", "isotropic", "anisotropic", "independent", "auto"};
  if (std::ranges::find(kNames, FLAGS_model) == std::end(kNames)) {
    throw Error("unknown model '" + FLAGS_model +
                "'; known: shared, isotropic, anisotropic, independent, auto");
  }
  Spec({}, FLAGS_model == "anisotropic" || FLAGS_model == "shared");
}

bool ModelIsGiven() {
  return std::ranges::any_of(ModelFlags(),
                             [](const std::string& flag) { return !IsDefault(flag); });
}

bool ChoosesModel() { return FLAGS_model == "auto"; }

std::vector<std::string> ModelFlags() { return {"model", "lobes", "d_nodes", "g_nodes"}; }

}  // namespace trilobe
