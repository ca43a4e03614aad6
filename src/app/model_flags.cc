#include "app/model_flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/flags.h"
#include "core/files/text_lines.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/error.h"

DEFINE_string(
    d_nodes, "",
    "nodes of D of an anisotropic model: theta_h by phi_h, theta_h at even steps, or with "
    "an r (12rx48) at even steps of its root; by default 12rx36, or fewer phi_h where the "
    "data have fewer; with --model=anisotropic 6x48");
DEFINE_string(stretch, "",
              "ALONG,ACROSS: exponents by which highlights of an isotropic model get wider with "
              "theta_d, along the plane of both directions and across it "
              "(docs/model.md#stretched-highlights); one pair for all lobes, or one a lobe, "
              "ALONG,ACROSS,ALONG,ACROSS...; by default 0,0, as in the paper; --model=auto finds "
              "them");
DEFINE_int32(f_bins, 0,
             "bins of F over theta_d of an anisotropic model, from 4; by default 6, with "
             "--model=anisotropic 90");
DEFINE_string(
    g_nodes, "",
    "nodes of G of an anisotropic model: theta by phi, at even steps; by default 6x24, or "
    "fewer phi where the data have fewer, and the horizon; with --model=anisotropic 6x48");
DEFINE_string(
    nodes, "given",
    "choice of the nodes of an anisotropic model. given: by --d_nodes and --g_nodes, or "
    "by default; held_out: those of D and G, from coarse to fine, with the least error on "
    "directions that are held out (docs/forms.md)");
DEFINE_double(prior, 1,
              "weight of a small model, fitted first, between the directions of scattered samples; "
              "it counts much less where no azimuths matter (docs/forms.md); "
              "0: no prior, the default with --model=anisotropic");

namespace trilobe {
namespace {

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
  Axis axis = Axis::EvenPolar(*rings, root ? Axis::Steps::kOfRoot : Axis::Steps::kOfTheta, *phi);
  CheckAxis(axis, flag[0] == 'd' ? "D" : "G");
  return axis;
}

Stretches StretchesFromFlags(int lobes) {
  if (FLAGS_stretch.empty()) return {};
  std::vector<double> exponents;
  std::string_view rest = FLAGS_stretch;
  for (bool more = true; more;) {
    const size_t comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::optional<double> exponent = ToNumber(rest.substr(0, comma));
    if (exponent) exponents.push_back(*exponent);
    if (!exponent || (!more && exponents.size() % 2 != 0)) {
      throw Error("--stretch=" + FLAGS_stretch +
                  " is no stretch; give ALONG,ACROSS, as -0.2,0.3, once or for each lobe");
    }
    if (more) rest.remove_prefix(comma + 1);
  }
  std::vector<Stretch> of_lobes;
  for (size_t k = 0; k < exponents.size(); k += 2) {
    of_lobes.push_back({.along = exponents[k], .across = exponents[k + 1]});
  }
  if (of_lobes.size() != 1 && static_cast<int>(of_lobes.size()) != lobes) {
    throw Error("--stretch=" + FLAGS_stretch + " has " + std::to_string(of_lobes.size()) +
                " pairs for " + std::to_string(lobes) + " lobes; give one, or one a lobe");
  }
  return Stretches(of_lobes);
}

const std::string& ModelFlag() { return std::get<std::string>(FlagValue("model")); }

}  // namespace

void DefineModelFlag() {
  std::string help = "form of the model";
  const char* separator = ". ";
  for (const NamedForm& form : NamedForms()) {
    help += separator + form.name + ": " + form.description;
    separator = "; ";
  }
  DefineFlag("model", help, std::string("shared"));
}

FormOptions FormFromFlags() {
  const NamedForm& named = FindForm(ModelFlag());
  if (FLAGS_nodes != "given" && FLAGS_nodes != "held_out") {
    throw Error("unknown --nodes=" + FLAGS_nodes + "; known: given, held_out");
  }
  for (const char* const flag : {"d_nodes", "g_nodes"}) {
    if (FLAGS_nodes == "held_out" && !IsDefault(flag)) {
      throw Error("--nodes=held_out chooses the nodes; leave out --" + std::string(flag));
    }
  }
  FormOptions form{.kind = named.kind, .nodes_by_held_out = FLAGS_nodes == "held_out"};
  if (!IsDefault("lobes")) form.lobes = FLAGS_lobes;
  form.stretches = StretchesFromFlags(named.lobes.value_or(FLAGS_lobes));
  if (!FLAGS_d_nodes.empty()) form.d_nodes = ParseNodes("d_nodes", FLAGS_d_nodes, true);
  if (!FLAGS_g_nodes.empty()) form.g_nodes = ParseNodes("g_nodes", FLAGS_g_nodes, false);
  if (!IsDefault("f_bins")) form.f_bins = FLAGS_f_bins;
  CheckForm(form);
  return form;
}

bool ModelIsGiven() {
  return std::ranges::any_of(ModelFlags(),
                             [](const std::string& flag) { return !IsDefault(flag); });
}

bool ChoosesModel() { return FindForm(ModelFlag()).chosen; }

std::vector<std::string> ModelFlags() {
  return {"model", "lobes", "stretch", "d_nodes", "f_bins", "g_nodes", "nodes"};
}

std::optional<double> PriorFromFlags() {
  if (!(FLAGS_prior >= 0 && FLAGS_prior <= 1e6)) throw Error("--prior must be from 0 to 1e6");
  return IsDefault("prior") ? std::nullopt : std::optional(FLAGS_prior);
}

}  // namespace trilobe
