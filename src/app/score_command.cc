#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "fit/reports/appearance_report.h"
#include "fit/reports/print.h"
#include "fit/reports/score_report.h"
#include "fit/reports/verdict_report.h"
#include "io/pictures/plots.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/sampled_sphere.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/tabulated_brdf.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {
namespace {

// The values of a function at the samples. [samples.size()]
std::vector<Rgb> ValuesAt(const AngularBrdf& brdf, const BrdfSamples& samples) {
  std::vector<Rgb> values;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles angles = samples.Angles(j);
    values.push_back(brdf(angles, ToCosines(angles)));
  }
  return values;
}

void PrintSummary(const Scored& scored, const Objective& objective) {
  std::cout << Describe(scored.verdict);
  PrintLine("compared     " + scored.model + " with " + objective.samples().source + ", " +
            std::to_string(scored.score.valid_samples) + " samples");
  std::cout << "error        E is " << Text(100 * scored.score.relative_objective, 3)
            << " % of a black model's; mean log error " << Text(scored.score.mean_log_error, 3)
            << "\n"
            << (scored.appearance ? DescribeBriefly(*scored.appearance) : "");
}

void PrintDetails(const Scored& scored, const Objective& objective) {
  const BrdfSamples& samples = objective.samples();
  const ScoreReport& report = scored.score;
  PrintLine("model", scored.model);
  PrintLine("source", samples.source);
  PrintLine("valid samples", std::to_string(report.valid_samples) + ", of 3 channels each");
  PrintLine("weighting", objective.weighting().name);
  PrintLine("objective E", Text(report.objective, 10));
  PrintLine("E / E of a black model", Text(report.relative_objective));
  if (report.irreducible_objective > 0) {
    PrintLine("irreducible part of E",
              Text(report.irreducible_objective) + ", by which exchanged directions differ");
  }
  PrintLine("PSNR", Text(report.psnr_db) + " dB, peak " + Text(report.psnr_peak) + " /sr");
  PrintLine("RMSE", Text(report.rmse) + " /sr (red " + Text(report.rmse_channel[0]) + ", green " +
                        Text(report.rmse_channel[1]) + ", blue " + Text(report.rmse_channel[2]) +
                        ")");
  PrintLine("mean relative error", RelativeErrorText(report.mean_relative_error));
  PrintLine("mean log error", Text(report.mean_log_error));
  PrintLine("largest absolute error", Text(report.max_absolute_error) + " /sr");
  std::cout << "\n"
            << (scored.appearance ? Describe(*scored.appearance) : "")
            << "\nworst bins by share of E\n"
               "  theta_h  theta_d    phi_d  channel  measured    fitted  share of E\n"
               "      deg      deg      deg               1/sr      1/sr           %\n";
  for (const WorstSample& worst : report.worst) {
    const double share = report.objective > 0 ? 100 * worst.error / report.objective : 0;
    std::printf("%9.3f%9.1f%9.1f  %-7s%10s%10s%12s\n", RadiansToDegrees(worst.angles.theta_h),
                RadiansToDegrees(worst.angles.theta_d), RadiansToDegrees(worst.angles.phi_d),
                kChannelNames[worst.channel], Text(worst.measured).c_str(),
                Text(worst.fitted).c_str(), Text(share, 3).c_str());
  }
}

int RunScore(std::span<const std::string> arguments) {
  const Weighting weighting = FindWeighting(TextFlag("weighting"));
  const AppearanceOptions appearance_options = AppearanceOptionsFromFlags();
  const int threads = ThreadsFromFlags();
  CheckPictureOut();
  if (!FLAGS_out.empty()) {
    Inputs({arguments[0], arguments[1], FLAGS_probe}).CheckOutput(FLAGS_out);
  }
  FactorModel model;
  std::optional<BrdfTable> other;
  if (IsModelFile(arguments[0])) {
    model = ModelOfSource(arguments[0]).model;
  } else {
    other = LoadTable(arguments[0], SourceOptionsFromFlags());
  }
  const Measurement measured = MeasurementOfSource(arguments[1], SourceOptionsFromFlags());
  PrintNotes(measured);
  const PictureData pictured = PictureDataOf(measured);
  if (!FLAGS_out.empty() && pictured.empty()) TableOf(measured);  // its error
  BrdfSamples samples = SamplesOf(measured);
  const ModelSpec spec = other ? ModelSpec::SharedFactors(0, samples.grid) : model.spec();
  const Objective objective(std::move(samples), spec, weighting, threads);
  std::optional<TabulatedBrdf> tabulated;
  if (other) tabulated.emplace(*other);
  const Material fitted = other ? Isotropic(Interpolated(*tabulated)) : MaterialOf(model);
  Scored scored{.model = arguments[0],
                .score = other
                             ? ScoreValues(objective, ValuesAt(fitted.angular, objective.samples()))
                             : ScoreModel(objective, model)};
  std::optional<SeenError> seen;
  if (pictured.empty()) {
    const BrdfSamples& compared = objective.samples();
    seen = CompareSampledSphere(
        compared,
        other ? ValuesAt(fitted.angular, compared) : EvaluateSamples(model, compared, threads),
        fitted.spherical, measured.anisotropic, appearance_options);
  } else {
    scored.appearance = CompareAppearance(pictured, fitted, appearance_options);
  }
  scored.verdict = MakeVerdict(scored.appearance, seen, BasisOf(objective.samples(), 0),
                               {.irreducible = IrreducibleShare(scored.score)});
  if (FLAGS_json) {
    PrintJson(ToJson(scored, objective));
  } else {
    PrintSummary(scored, objective);
    if (FLAGS_verbose) {
      std::cout << "\n";
      PrintDetails(scored, objective);
    }
  }
  if (!FLAGS_out.empty()) WriteSpherePair(pictured, fitted, FLAGS_out, appearance_options);
  return 0;
}

}  // namespace

Command ScoreCommand() {
  return {
      .name = "score",
      .summary = "compare a model with a measurement",
      .arguments = "MODEL|SOURCE SOURCE",
      .min_arguments = 2,
      .max_arguments = 2,
      .details =
          "Prints what a person would see, and what that rests on. With --verbose also the "
          "objective "
          "E under\n--weighting, and errors that know no weights: RMSE; PSNR over the largest "
          "measured value, which is\nprinted with it; the mean of |rho - rho*|/(rho* + 0.001); the "
          "mean of |log((1 + rho cos)/(1 +\nrho* cos))|; and the ten bins with the largest share "
          "of E.\nWith --json, one JSON object; a PSNR that is not "
          "finite (an exact fit) is null there.",
      .flags = WithSourceFlags({"json", "verbose", "weighting", "probe", "out"}),
      .run = RunScore};
}

}  // namespace trilobe
