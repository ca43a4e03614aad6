#include <gflags/gflags.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "core/base/json_text.h"
#include "core/base/names.h"
#include "core/files/own_mark.h"
#include "core/system/process.h"
#include "fit/reports/print.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/fit.h"
#include "trilobe/fit/forms/compare_forms.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/terms_file.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/terms/term_forms.h"

DEFINE_string(forms, "diffuse_table,coupled_diffuse,correlated_g,direction_correlated_g,own_f",
              "the forms to fit, separated by commas, of those above");

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReportName = "forms.json";

// A form, what it makes of the measurement, and how the sphere of its model looks.
struct SeenForm {
  FormFit fit;
  std::optional<SphereError> sphere;
};

std::vector<std::string> FormsFromFlag() {
  std::vector<std::string> names = Split(FLAGS_forms, ',');
  for (const std::string& name : names) FindNamed("form", name, TermForms());
  return names;
}

std::vector<std::string> FileNames() {
  std::vector<std::string> names = {kReportName};
  for (const TermForm& form : TermForms()) names.push_back(form.name + ".json");
  return names;
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

void PrintRow(const SeenForm& form, const FormFit& paper) {
  const auto ratio = [](double is, double of) { return of > 0 ? Text(is / of, 3) : "-"; };
  const FormFit& fit = form.fit;
  std::string line = fit.form + std::string(24 - std::min<size_t>(fit.form.size(), 23), ' ') +
                     AlignRight(std::to_string(fit.model.num_parameters()), 7) +
                     AlignRight(Text(100 * fit.objective, 3), 9) +
                     AlignRight(ratio(fit.objective, paper.objective), 10) +
                     AlignRight(ratio(fit.held_out, paper.held_out), 10);
  if (form.sphere) {
    line += AlignRight(Text(form.sphere->psnr_db, 3), 9) +
            AlignRight(Text(form.sphere->mean_delta_e, 2), 9);
  }
  PrintLine(line);
}

int RunForms(std::span<const std::string> arguments) {
  const std::string &of = arguments[0], &source = arguments[1];
  CompareFormsOptions options{.forms = FormsFromFlag(),
                              .seed = static_cast<uint64_t>(FLAGS_seed),
                              .stop = [] { return InterruptGuard::signal() != 0; }};
  const Weighting weighting = FindWeighting(FLAGS_weighting);
  AppearanceOptions appearance = AppearanceOptionsFromFlags();
  appearance.num_threads = ThreadsFromFlags();
  std::optional<ResultFolder> folder;
  if (!FLAGS_out.empty()) {
    folder.emplace(FLAGS_out, FileNames(), Inputs({of, source, FLAGS_probe}));
  }
  const ModelFile file = ModelOfSource(of);
  const ModelSpec& spec = file.model.spec();
  CheckIsotropic(spec, "`trilobe forms`");
  const Measurement measured = MeasurementOfSource(source, SourceOptionsFromFlags());
  PrintNotes(measured);
  options.bands = file.spectral.has_value();
  const TermModel start = file.spectral ? TermModel::Of(*file.spectral) : TermModel::Of(file.model);
  const std::vector<double> wavelengths =
      file.spectral ? file.spectral->wavelengths() : std::vector<double>();
  if (options.bands && (measured.samples.spectra == nullptr ||
                        measured.samples.spectra->wavelengths != wavelengths)) {
    throw Error(of + ": a model of wavelengths that " + source +
                " has not; give the model.json beside it");
  }
  const FitOptions fit{.weighting = weighting,
                       .compare = false,
                       .seed = options.seed,
                       .num_threads = appearance.num_threads};
  const FitProblem problem = ProblemFor(measured, fit, spec);
  const PictureData pictured = PictureDataOf(measured);

  const InterruptGuard guard;
  std::vector<SeenForm> forms;
  JobProgress progress(options.forms.size() + 1, "forms");
  options.on_form = [&](const FormFit& form) {
    SeenForm& seen = forms.emplace_back(SeenForm{.fit = form, .sphere = {}});
    TermFile terms{.model = form.model, .wavelengths = wavelengths, .fit = file.fit};
    if (!pictured.empty()) {
      const auto rgb = RgbOf(terms);
      const Material material =
          Isotropic([&rgb](const HalfDiffAngles& angles, const Cosines&) { return rgb(angles); });
      seen.sphere = CompareAppearance(pictured, material, appearance).sphere;
    }
    if (folder) {
      terms.fit.solver = "terms";
      terms.fit.source = source;
      terms.fit.source_xxh128 = measured.xxh128;
      terms.fit.objective = form.objective;
      terms.fit.stop_reason = form.converged ? "converged" : "max_iterations";
      terms.fit.iterations = form.steps;
      terms.fit.seconds = form.seconds;
      terms.fit.program = ProgramName();
      terms.fit.date = UtcNow();
      terms.fit.run = folder->run();
      if (forms.size() == 1) folder->Open();
      folder->Write(form.form + ".json", [&](std::ostream& out) { out << FormatTerms(terms); });
    }
    progress.Done(form.form);
    if (FLAGS_json) return;
    progress.Clear();
    if (forms.size() == 1) {
      PrintLine("form                    numbers   E [%]  of paper  held out" +
                std::string(seen.sphere ? "  sphere  Delta E" : ""));
    }
    PrintRow(seen, forms.front().fit);
  };
  CompareForms(problem, start, options);
  Json rows = Json::array();
  for (const SeenForm& form : forms) rows.push_back(ToJson(form, forms.front().fit));
  const Json report = {
      {"format", kFormsFormat}, {"model", of}, {"source", source}, {"forms", rows}};
  if (FLAGS_json) PrintJson(report);
  if (folder && !forms.empty()) {
    folder->Write(kReportName, [&](std::ostream& out) { out << JsonText(report, 2) << "\n"; });
  }
  const int signal = InterruptGuard::signal();
  return signal != 0 ? 128 + signal : 0;
}

std::string Details() {
  std::string text =
      "Starts from MODEL, a fit of SOURCE, fits each form to it and says what that is worth: "
      "numbers; E as a\nshare of that of a black model, and of what the paper's form reaches by "
      "the same steps; the same on\nblocks of directions that were held out; PSNR [dB] and mean "
      "Delta E of the sphere. --out=DIR keeps the\nmodels (DIR/FORM.json), which other commands "
      "take as measurements, and DIR/forms.json. Forms:\n";
  for (const TermForm& form : TermForms()) {
    text += "\n  " + form.name + std::string(24 - form.name.size(), ' ') + form.description;
  }
  return text;
}

}  // namespace

Command FormsCommand() {
  return {.name = "forms",
          .summary = "fit other forms than the paper's, and say what they are worth",
          .arguments = "MODEL SOURCE",
          .min_arguments = 2,
          .max_arguments = 2,
          .details = Details(),
          .flags = WithSourceFlags({"forms", "json", "out", "weighting", "probe"}),
          .run = RunForms};
}

}  // namespace trilobe
