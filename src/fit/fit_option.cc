#include "fit/fit_option.h"

#include <optional>
#include <utility>

#include "core/base/names.h"
#include "core/files/option_row.h"
#include "core/files/text_lines.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/form.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// The row of the option that is this member.
template <OptionName kName, auto kMember>
FitOption Option(FitOption row) {
  return MemberRow<FitOption, kName, kMember>(std::move(row));
}

std::string FormHelp() {
  std::string help = "form of the model";
  const char* separator = ". ";
  for (const NamedForm& form : NamedForms()) {
    help += separator + form.name + ": " + form.description;
    separator = "; ";
  }
  return help;
}

void SetModel(std::string_view text, FitOptions* options) {
  const NamedForm& named = FindForm(text);
  options->form.kind = named.kind;
  options->choose_form = named.chosen;
}

std::string ModelOf(const FitOptions& options) {
  for (const NamedForm& named : NamedForms()) {
    if (named.kind == options.form.kind && named.chosen == options.choose_form) return named.name;
  }
  return "none";  // a choice that begins with another form than --model=auto
}

// "6x48", or "12rx48" where `with_root` may be.
Axis NodesByText(const char* flag, std::string_view text, bool with_root) {
  const size_t x = text.find('x');
  std::string_view theta = text.substr(0, x);
  const bool root = with_root && theta.ends_with('r');
  if (root) theta.remove_suffix(1);
  const std::optional<int> rings = ToInteger(theta);
  const std::optional<int> phi =
      x == std::string_view::npos ? std::nullopt : ToInteger(text.substr(x + 1));
  if (!rings || !phi || *rings < 2 || *rings > 90 || *phi < 2 || *phi > 720) {
    FailOptionText(flag, text,
                   "nodes as theta x phi: 6x48, of 2 to 90 by 2 to 720" +
                       std::string(with_root ? ", or 12rx48 for steps of the root of theta" : ""));
  }
  Axis axis = Axis::EvenPolar(*rings, root ? Axis::Steps::kOfRoot : Axis::Steps::kOfTheta, *phi);
  CheckAxis(axis, flag[0] == 'd' ? "D" : "G");
  return axis;
}

void SetDNodes(std::string_view text, FitOptions* options) {
  options->form.d_nodes =
      text.empty() ? std::nullopt : std::optional(NodesByText("d_nodes", text, true));
}

void SetGNodes(std::string_view text, FitOptions* options) {
  options->form.g_nodes =
      text.empty() ? std::nullopt : std::optional(NodesByText("g_nodes", text, false));
}

// All theta and the number of phi.
std::string TextOfNodes(const std::optional<Axis>& axis) {
  if (!axis) return "";
  std::string text;
  for (const double theta : axis->theta) text += OptionText(theta) + ",";
  return text + "x" + std::to_string(axis->phi_nodes);
}

void SetFBins(std::string_view text, FitOptions* options) {
  const int bins = IntegerOfOption("f_bins", text);
  options->form.f_bins = bins == 0 ? std::nullopt : std::optional(bins);
}

using NodeRule = FormOptions::NodeRule;
constexpr std::pair<NodeRule, const char*> kNodeRules[] = {{NodeRule::kFinerWhereSeen, "auto"},
                                                           {NodeRule::kGiven, "given"},
                                                           {NodeRule::kHeldOut, "held_out"}};

void SetNodes(std::string_view text, FitOptions* options) {
  for (const auto& [rule, name] : kNodeRules) {
    if (text != name) continue;
    options->form.nodes = rule;
    return;
  }
  FailOptionText("nodes", text, "auto, given or held_out");
}

// The rows of model and lobes stand before, and have been set.
void SetStretch(std::string_view text, FitOptions* options) {
  options->form.stretches = {};
  if (text.empty()) return;
  const std::vector<double> exponents = ToNumbers(text).value_or(std::vector<double>());
  if (exponents.empty() || exponents.size() % 2 != 0) {
    FailOptionText("stretch", text, "ALONG,ACROSS, as -0.2,0.3, once or for each lobe");
  }
  const int lobes = LobesOf(options->form);
  if (exponents.size() != 2 && static_cast<int>(exponents.size()) != 2 * lobes) {
    throw Error(ErrorKind::kMismatch, "--stretch=" + std::string(text) + " has " +
                                          std::to_string(exponents.size() / 2) + " pairs for " +
                                          std::to_string(lobes) + " lobes; give one, or one a lobe")
        .About("stretch", text);
  }
  std::vector<Stretch> of_lobes;
  for (size_t k = 0; k < exponents.size(); k += 2) {
    of_lobes.push_back({.along = exponents[k], .across = exponents[k + 1]});
  }
  options->form.stretches = Stretches(of_lobes);
}

std::string TextOfStretch(const FitOptions& options) {
  const Stretches& stretches = options.form.stretches;
  std::string text;
  for (int lobe = 0; stretches.any() && lobe < LobesOf(options.form); ++lobe) {
    const Stretch& of_lobe = stretches.of(lobe);
    text += (lobe == 0 ? "" : ",") + OptionText(of_lobe.along) + "," + OptionText(of_lobe.across);
  }
  return text;
}

bool IsTo1e6(double x) { return x >= 0 && x <= 1e6; }

std::vector<FitOption> MakeFitOptions() {
  using Options = FitOptions;
  return {
      {.name = "model",
       .help = FormHelp(),
       .default_value = NamedForms().front().name,
       .of_form = true,
       .set = SetModel,
       .get = ModelOf},
      {.name = "lobes",
       .help = "specular lobes of the full model, 0 to 8",
       .default_value = 3,
       .of_form = true,
       .of_scenes = true,
       .set = [](std::string_view text,
                 Options* options) { options->form.lobes = IntegerOfOption("lobes", text); },
       .get =
           [](const Options& of) {
             return of.form.lobes ? std::to_string(*of.form.lobes) : std::string();
           }},
      {.name = "stretch",
       .help = "ALONG,ACROSS: exponents by which highlights of an isotropic model get wider with "
               "theta_d, along the plane of both directions and across it "
               "(docs/model.md#stretched-highlights); one pair for all lobes, or one a lobe, "
               "ALONG,ACROSS,ALONG,ACROSS...; by default 0,0, as in the paper; --model=auto finds "
               "them",
       .default_value = "",
       .of_form = true,
       .set = SetStretch,
       .get = TextOfStretch},
      {.name = "d_nodes",
       .help = "nodes of D of an anisotropic model: theta_h by phi_h, theta_h at even steps, or "
               "with an r (12rx48) at even steps of its root; by default 12rx36, or fewer phi_h "
               "where the data have fewer; with --model=anisotropic 6x48",
       .default_value = "",
       .of_form = true,
       .set = SetDNodes,
       .get = [](const Options& of) { return TextOfNodes(of.form.d_nodes); }},
      {.name = "f_bins",
       .help = "bins of F over theta_d of an anisotropic model, from 4; by default 6, with "
               "--model=anisotropic 90",
       .default_value = 0,
       .of_form = true,
       .set = SetFBins,
       .get =
           [](const Options& of) {
             return of.form.f_bins ? std::to_string(*of.form.f_bins) : std::string();
           }},
      {.name = "g_nodes",
       .help = "nodes of G of an anisotropic model: theta by phi, at even steps; by default 6x24, "
               "or fewer phi where the data have fewer, and the horizon; with --model=anisotropic "
               "6x48",
       .default_value = "",
       .of_form = true,
       .set = SetGNodes,
       .get = [](const Options& of) { return TextOfNodes(of.form.g_nodes); }},
      {.name = "nodes",
       .help =
           "choice of the nodes of an anisotropic model. given: by --d_nodes and --g_nodes, or "
           "by default; auto: the same, and finer than the default where an error is seen; "
           "held_out: those of D and G, from coarse to fine, with the least error on directions "
           "that are held out (docs/forms.md)",
       .default_value = "auto",
       .of_form = true,
       .set = SetNodes,
       .get =
           [](const Options& of) {
             const auto rule_of = [](const auto& rule) { return rule.first; };
             return std::string(std::ranges::find(kNodeRules, of.form.nodes, rule_of)->second);
           }},
      Option<"solver", &Options::solver>({.help = "one of the solvers above", .of_scenes = true}),
      Option<"init", &Options::init>(
          {.help = "one of the starting points above, or the path of a model file, whose spec the "
                   "fit then takes"}),
      {.name = "weighting",
       .help = "weights of the objective: a name, or power:KEY=VALUE,... (docs/objective.md)",
       .default_value = Weightings().front().name,
       .of_scenes = true,
       .set = [](std::string_view text,
                 Options* options) { options->weighting = FindWeighting(text); },
       .get = [](const Options& of) { return of.weighting.name; }},
      Option<"prior", &Options::prior>(
          {.help = "weight of a small model, fitted first, between the directions of scattered "
                   "samples; it counts much less where no azimuths matter (docs/forms.md); 0: no "
                   "prior, the default with --model=anisotropic",
           .default_value = 1.0,
           .range = {"from 0 to 1e6", IsTo1e6},
           .of_scenes = true}),
      Option<"robust", &Options::robust>(
          {.help = "continue with a loss that is linear in errors above this, as the weighting "
                   "scales them, by reweighting; 0 for none",
           .range = {"from 0 to 1e6", IsTo1e6},
           .follows_solver = true,
           .of_scenes = true}),
      Option<"smoothness", &Options::smoothness>(
          {.help = "relative rise of E that is allowed at the end for the smoothest tables, if it "
                   "is not seen: without holes, and without falls that D and G exchange; 0 for the "
                   "least E",
           .range = {"from 0 to 1", [](double x) { return x >= 0 && x <= 1; }},
           .follows_solver = true,
           .of_scenes = true}),
      Option<"match_reflectance", &Options::match_reflectance>(
          {.help = "for a table: if a fit that has converged reflects more or less light than was "
                   "measured, by more than 1 %, let E rise a little to correct that, as far as "
                   "neither the sphere nor the mean log error gets worse",
           .follows_solver = true,
           .of_scenes = true}),
      Option<"raw", &Options::raw>(
          {.help = "store the model that the solver found, to compare solvers, for example: "
                   "entries at the edge of the data are not tied, reflected light is not matched, "
                   "tables are not smoothed"}),
      Option<"max_parameters", &Options::max_parameters>(
          {.help = "with --model=auto: most parameters that the model may store; if not given, for "
                   "scattered samples, as many as their default form has",
           .default_value = 822,
           .range = {"at least 1", [](double x) { return x >= 1; }}}),
      Option<"spectral", &Options::bands>(
          {.help = "keep spectra: `fit` also writes DIR/spectral.json, a model of all wavelengths "
                   "that were measured; a .bsdf file has spectra in place of RGB, for spectral "
                   "renderers (Mitsuba's spectral variants, pbrt-v4; the others cannot read it); a "
                   ".csv file has a column per wavelength",
           .changes_model = false}),
      {.name = "held_out",
       .help = "also fit without a fifth of the blocks of directions, drawn by --data_seed, and "
               "report E and Delta E at these, which shows how well unseen directions are "
               "predicted. Takes twice as long",
       .default_value = false,
       .changes_model = false,
       .set =
           [](std::string_view text, Options* options) {
             options->held_out =
                 TruthOfOption("held_out", text) ? std::optional(options->seed) : std::nullopt;
           },
       .get =
           [](const Options& of) {
             return of.held_out ? std::to_string(*of.held_out) : std::string();
           }}};
}

}  // namespace

const std::vector<FitOption>& AllFitOptions() {
  static const std::vector<FitOption> options = MakeFitOptions();
  return options;
}

const FitOption& FindFitOption(std::string_view name) {
  return FindNamed("option of a fit", name, AllFitOptions());
}

void CheckFitOptions(const FitOptions& options) {
  for (const FitOption& option : AllFitOptions()) CheckRange(option, options);
  CheckNumThreads(options.num_threads);
  FindSolver(options.solver);
  if (!options.start_model) {
    FindInitialModel(options.init);
    CheckForm(options.form);
  }
  for (const char* const nodes : {"d_nodes", "g_nodes"}) {
    if (options.form.nodes == NodeRule::kHeldOut && IsGiven(nodes, options)) {
      throw Error(ErrorKind::kConflict,
                  "--nodes=held_out chooses the nodes; leave out --" + std::string(nodes))
          .About(nodes);
    }
  }
  for (const FitOption& option : AllFitOptions()) {
    if (options.raw && option.follows_solver && IsGiven(option.name, options)) FailWithRaw(option);
  }
  if (!options.choose_form) {
    if (options.max_parameters) {
      throw Error(ErrorKind::kConflict, "--max_parameters goes with --model=auto")
          .About("max_parameters", *options.max_parameters);
    }
    return;
  }
  if (options.raw) {
    throw Error(ErrorKind::kConflict, "--raw stores what the solver found; leave out --model=auto")
        .About("model", "auto");
  }
  if (IsGiven("smoothness", options) && options.smoothness > 0) {
    throw Error(
        ErrorKind::kConflict,
        "--smoothness is for a form that is given: tables that --model=auto chooses are thinned")
        .About("smoothness", options.smoothness);
  }
  if (options.bands) {
    throw Error(
        ErrorKind::kConflict,
        "--spectral takes a form that is given: --model=auto may choose a D for each channel")
        .About("spectral", "auto");
  }
}

void FailWithRaw(const FitOption& option) {
  throw Error(ErrorKind::kConflict,
              "--raw stores what the solver found; leave out --" + option.name)
      .About(option.name);
}

bool IsGiven(std::string_view name, const FitOptions& options) {
  const FitOption& option = FindFitOption(name);
  return option.get(options) != option.get({});
}

}  // namespace trilobe
