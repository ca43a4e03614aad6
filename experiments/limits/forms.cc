// Fits other forms than the paper's from a fit of that, and says what each is worth. See README.md
// beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "experiments/limits/compare_forms.h"
#include "experiments/limits/term_forms.h"
#include "experiments/program.h"
#include "io/formats/source_option.h"
#include "model/appearance/picture_data.h"
#include "model/spectral_color.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/read_model.h"

DEFINE_string(forms, "diffuse_table,coupled_diffuse,correlated_g,direction_correlated_g,own_f",
              "the forms to fit, separated by commas: names of TermForms()");
DEFINE_string(weighting, "appearance", "the weighting of E, as `trilobe fit` has it");
DEFINE_uint64(seed, 1, "of the blocks of directions that are held out");
DEFINE_string(out, "", "an existing folder for forms.json");

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

// A form, what it makes of the measurement, and how the sphere of its model looks.
struct SeenForm {
  FormFit fit;
  std::optional<SphereError> sphere;
};

// Takes flags that are options of a measurement off the words.
SourceOptions TakeSourceOptions(int* argc, char** argv) {
  SourceOptions options;
  int kept = 1;
  for (int k = 1; k < *argc; ++k) {
    const std::string_view word = argv[k];
    const size_t equals = word.find('=');
    const std::string_view name = word.starts_with("--") ? word.substr(2, equals - 2) : "";
    const std::vector<SourceOption>& all = AllSourceOptions();
    const auto found = std::ranges::find(all, name, &SourceOption::name);
    if (found == all.end()) {
      argv[kept++] = argv[k];
    } else {
      found->set(equals == std::string_view::npos ? "true" : word.substr(equals + 1), &options);
    }
  }
  *argc = kept;
  options.num_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return options;
}

Json ToJson(const SeenForm& form, const FormFit& paper) {
  const auto relative = [](double is, double of) { return of > 0 ? Json(is / of) : Json(); };
  const FormFit& fit = form.fit;
  Json json = {{"form", fit.form},
               {"parameters", fit.model.num_parameters()},
               {"relative_objective", fit.objective},
               {"of_paper", relative(fit.objective, paper.objective)},
               {"held_out_objective", fit.held_out},
               {"held_out_of_paper", relative(fit.held_out, paper.held_out)},
               {"steps", fit.steps},
               {"converged", fit.converged},
               {"seconds", fit.seconds}};
  if (form.sphere) {
    json["sphere_psnr_db"] = form.sphere->psnr_db;
    json["sphere_mean_delta_e"] = form.sphere->mean_delta_e;
  }
  return json;
}

int Run(const std::string& of, const std::string& source, const SourceOptions& reading) {
  CompareFormsOptions options{.forms = {}, .seed = FLAGS_seed};
  std::istringstream names(FLAGS_forms);
  for (std::string name; std::getline(names, name, ',');) options.forms.push_back(name);
  const ModelFile file = ReadModel(of);
  const ModelSpec& spec = file.model.spec();
  const Measurement measured = Source(source).Read(reading);
  for (const std::string& note : measured.notes) std::fprintf(stderr, "%s\n", note.c_str());
  options.bands = file.spectral.has_value();
  const TermModel start = file.spectral ? TermModel::Of(*file.spectral) : TermModel::Of(file.model);
  const std::vector<double> wavelengths =
      file.spectral ? file.spectral->wavelengths() : std::vector<double>();
  if (options.bands && (measured.samples.spectra == nullptr ||
                        measured.samples.spectra->wavelengths != wavelengths)) {
    throw ErrorIn(
        ErrorKind::kMismatch, of,
        "a model of wavelengths that " + source + " has not; give the model.json beside it");
  }
  const FitOptions fit{.weighting = FindWeighting(FLAGS_weighting),
                       .compare = false,
                       .seed = options.seed,
                       .num_threads = reading.num_threads};
  const PictureData pictured = PictureDataOf(measured);
  const AppearanceOptions appearance{.num_threads = reading.num_threads};
  std::vector<SeenForm> forms;
  options.on_form = [&](const FormFit& form) {
    SeenForm& seen = forms.emplace_back(SeenForm{.fit = form, .sphere = {}});
    if (pictured.empty()) return;
    const auto rgb = RgbOf(form.model, wavelengths);
    const Material material =
        Isotropic([&rgb](const HalfDiffAngles& angles, const Cosines&) { return rgb(angles); });
    seen.sphere = CompareAppearance(pictured, material, appearance).sphere;
  };
  CompareForms(ProblemFor(measured, fit, spec), start, options);
  Json rows = Json::array();
  for (const SeenForm& form : forms) rows.push_back(ToJson(form, forms.front().fit));
  const std::string report = Json{{"model", of}, {"source", source}, {"forms", rows}}.dump(2);
  std::printf("%s\n", report.c_str());
  if (FLAGS_out.empty()) return 0;
  std::ofstream out(FLAGS_out + "/forms.json");
  out << report << '\n';
  if (!out.flush()) {
    throw Error(ErrorKind::kFile, FLAGS_out + "/forms.json: cannot be written")
        .At(FLAGS_out + "/forms.json")
        .About("write");
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  using namespace trilobe;  // NOLINT(google-build-using-namespace)
  SourceOptions reading;
  try {
    reading = TakeSourceOptions(&argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "forms: error: %s\n", error.what());
    return 1;
  }
  return ProgramMain(argc, argv, "forms [--flag=VALUE] MODEL SOURCE", 2,
                     [&](std::span<char*> words) { return Run(words[0], words[1], reading); });
}
