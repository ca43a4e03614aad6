#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/command.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/result_folder.h"
#include "fit/reports/appearance_report.h"
#include "fit/reports/print.h"
#include "fit/reports/score_report.h"
#include "fit/reports/verdict_report.h"
#include "io/pictures/plots.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/fit/as_measurement.h"
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

// A direction pair as a key: angles to thousandths of a degree, theta of 0 without an azimuth.
// Without `by_azimuth` the azimuth between both counts alone.
using DirectionKey = std::array<int64_t, 4>;
DirectionKey KeyOf(const SphericalAngles& at, bool by_azimuth) {
  constexpr int64_t kTurn = 360'000;
  const auto whole = [](double angle) { return std::llround(1e3 * RadiansToDegrees(angle)); };
  const auto turned = [](int64_t angle) { return ((angle % kTurn) + kTurn) % kTurn; };
  const int64_t theta_i = whole(at.theta_i), theta_o = whole(at.theta_o);
  const int64_t phi_i = theta_i == 0 ? 0 : whole(at.phi_i);
  const int64_t phi_o = theta_o == 0 ? 0 : whole(at.phi_o);
  if (by_azimuth) return {theta_i, turned(phi_i), theta_o, turned(phi_o)};
  const bool has_both = theta_i != 0 && theta_o != 0;
  const int64_t between = has_both ? turned(phi_o - phi_i) : 0;
  return {theta_i, 0, theta_o, std::min(between, kTurn - between)};
}

// The samples of one measurement at whose directions another one has some too, and its values
// there.
struct InCommon {
  BrdfSamples samples;
  std::vector<Rgb> others;
};
InCommon AtCommonDirections(const Measurement& other, const Measurement& measured) {
  if (measured.table) {
    throw ErrorIn(ErrorKind::kUnsupported, other.source,
                  "scattered samples cannot be read at the bins of a table; give the table first, "
                  "or fit the samples and give the model")
        .About("SOURCE");
  }
  const bool by_azimuth = other.anisotropic || measured.anisotropic;
  std::map<DirectionKey, int> known;
  for (int j = 0; j < other.samples.size(); ++j) {
    known.insert({KeyOf(other.samples.directions[j], by_azimuth), j});
  }
  std::vector<int> kept;
  InCommon common;
  for (int j = 0; j < measured.samples.size(); ++j) {
    const auto found = known.find(KeyOf(measured.samples.directions[j], by_azimuth));
    if (found == known.end()) continue;
    kept.push_back(j);
    common.others.push_back(other.samples.rho[found->second]);
  }
  if (kept.empty()) {
    throw ErrorIn(ErrorKind::kData, other.source,
                  "no sample has the directions of one in " + Printable(measured.source) +
                      "; fit one of them, and give the model")
        .About("directions");
  }
  common.samples = Selected(measured.samples, kept);
  return common;
}

// One side of a comparison with a measurement: a model, a table, or values at its samples.
struct Compared {
  std::optional<FactorModel> model = {};
  std::optional<BrdfTable> table = {};
  std::optional<TabulatedBrdf> tabulated = {};
  std::optional<Measurement> scattered = {};

  bool is_material() const { return !scattered; }
  Material material() const {
    return model ? MaterialOf(*model) : Isotropic(Interpolated(*tabulated));
  }
  ModelSpec SpecFor(const BrdfSamples& samples) const {
    return model ? model->spec() : ModelSpec::SharedFactors(0, samples.grid);
  }
};

void ReadCompared(const std::string& path, const SourceOptions& options, Compared* compared) {
  if (IsModelFile(path)) {
    compared->model = ModelOfSource(path).model;
    return;
  }
  Measurement measurement = MeasurementOfSource(path, options);
  if (measurement.table) {
    compared->table = std::move(measurement.table);
    compared->tabulated.emplace(*compared->table);
  } else {
    compared->scattered = std::move(measurement);
  }
}

// The second argument. A model stands for what it reflects.
Measurement ReadMeasured(const std::string& path, const SourceOptions& options, int threads) {
  if (!IsModelFile(path)) return MeasurementOfSource(path, options);
  return AsMeasurement(ModelOfSource(path).model, path, threads, HemisphereGrid());
}

int RunScore(std::span<const std::string> arguments) {
  const Weighting weighting = FindWeighting(TextFlag("weighting"));
  const AppearanceOptions appearance_options = AppearanceOptionsFromFlags();
  const int threads = ThreadsFromFlags();
  CheckPictureOut();
  if (!FLAGS_out.empty()) {
    Inputs({arguments[0], arguments[1], FLAGS_probe}).CheckOutput(FLAGS_out);
  }
  if (IsModelFile(arguments[0]) && IsModelFile(arguments[1])) {
    RefuseForModel(arguments[1], MeasurementFlags());
  }
  Compared compared;
  ReadCompared(arguments[0], SourceOptionsFromFlags(), &compared);
  const Measurement measured = ReadMeasured(arguments[1], SourceOptionsFromFlags(), threads);
  const PictureData pictured = compared.is_material() ? PictureDataOf(measured) : PictureData();
  if (!FLAGS_out.empty() && pictured.empty()) TableOf(measured);  // its error
  InCommon common = compared.scattered ? AtCommonDirections(*compared.scattered, measured)
                                       : InCommon{.samples = SamplesOf(measured), .others = {}};
  if (compared.scattered) PrintNotes(*compared.scattered);
  PrintNotes(measured);
  const ModelSpec spec = compared.SpecFor(common.samples);
  const Objective objective(std::move(common.samples), spec, weighting, threads);
  std::optional<Material> fitted;
  if (compared.is_material()) fitted = compared.material();
  if (compared.model && pictured.empty()) {
    common.others = EvaluateSamples(*compared.model, objective.samples(), threads);
  } else if (compared.table) {
    common.others = ValuesAt(fitted->angular, objective.samples());
  }
  Scored scored{.model = arguments[0],
                .score = compared.model ? ScoreModel(objective, *compared.model)
                                        : ScoreValues(objective, common.others)};
  std::optional<SeenError> seen;
  if (!fitted) {
    seen = CompareSamples(objective.samples(), common.others);
  } else if (pictured.empty()) {
    seen = CompareSampledSphere(objective.samples(), common.others, fitted->spherical,
                                measured.anisotropic, appearance_options);
  } else {
    scored.appearance = CompareAppearance(pictured, *fitted, appearance_options);
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
  if (!FLAGS_out.empty()) {
    WriteSpherePair(pictured, *fitted, FLAGS_out, appearance_options);
  }
  return 0;
}

}  // namespace

Command ScoreCommand() {
  return {
      .name = "score",
      .summary = "compare a model or a measurement with another one",
      .arguments = "MODEL|SOURCE SOURCE|MODEL",
      .doing = "comparing",
      .min_arguments = 2,
      .max_arguments = 2,
      .details =
          "The second one is taken for the truth. Two lists of scattered samples are compared at "
          "the directions that both have. "
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
