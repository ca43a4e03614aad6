// `trilobe fit` as a script or a person sees it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/formats/databases/merl_file.h"
#include "tests/app/run_on_terminal.h"
#include "tests/app/run_program.h"
#include "tests/paths.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/model/stretch.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

nlohmann::json Json(const std::string& path) { return nlohmann::json::parse(Contents(path)); }

// Names of the steps that followed the solver, in order.
std::vector<std::string> StepsOf(const nlohmann::json& report) {
  std::vector<std::string> names;
  for (const auto& step : report["finishing"]) names.push_back(step["step"]);
  return names;
}

// Arguments of a fit to few bins, which serve most tests and take a tenth of the time.
std::vector<std::string> Fit(const std::string& out, const std::vector<std::string>& more = {},
                             const std::string& source = "synth:plastic@30x30x60") {
  std::vector<std::string> arguments = {"fit",           source,          "--noise=0.02",
                                        "--missing=0.8", "--solver=awls", "--max_iterations=3",
                                        "--nodiagnose",  "--out=" + out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Fit, WritesModelTraceAndReport) {
  const TemporaryFolder folder;
  const std::string out = folder / "a/b";  // parents are made
  const ProgramResult result = RunProgram(
      Fit(out, {"--reconstruction", "--diagnose", "--missing=0", "--verbose"}, "synth:plastic"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");  // no progress line in a pipe

  const ModelFile file = ReadModel(out + "/model.json");
  EXPECT_EQ(file.model.spec(), ModelSpec::SharedFactors(3));
  EXPECT_EQ(file.fit.solver, "awls");
  EXPECT_EQ(file.fit.iterations, 3);

  EXPECT_THAT(Contents(out + "/trace.csv"), StartsWith("iteration,seconds,objective"));
  const std::vector<IterationRecord> trace = ReadTrace(out + "/trace.csv");
  ASSERT_EQ(trace.size(), 4U);
  EXPECT_EQ(trace[0].iteration, 0);
  EXPECT_LT(trace[3].objective, trace[0].objective);
  EXPECT_NEAR(file.fit.objective, trace[3].objective, 1e-12 * trace[3].objective);

  const nlohmann::json report = Json(out + "/report.json");
  EXPECT_EQ(report["objective"].get<double>(), file.fit.objective);
  EXPECT_EQ(report["stop_reason"], "max_iterations");
  EXPECT_EQ(report["best_iteration"], 3);
  EXPECT_THAT(StepsOf(report), testing::IsEmpty());  // it has not converged
  EXPECT_EQ(report["rejected_steps"], 0);
  EXPECT_EQ(report["options"]["given"]["max_iterations"], 3);
  EXPECT_TRUE(report["options"]["given"]["max_seconds"].is_null());  // no limit
  EXPECT_EQ(report["options"]["used"]["g_filter_sigma"], 0);
  EXPECT_FALSE(report["options"]["used"].contains("memory"));  // awls does not read it
  EXPECT_TRUE(report["notes"].is_array());
  EXPECT_TRUE(report["starts"].is_array());
  EXPECT_EQ(report["phases"]["reading"], report["seconds"]["read"]);
  EXPECT_GT(report["phases"]["evaluating"], 0);
  EXPECT_GT(report["peak_memory_bytes"], 35e6);  // the values alone
  ASSERT_TRUE(report.contains("diagnosis"));
  EXPECT_FALSE(report["diagnosis"].contains("gradient"));
  const nlohmann::json& appearance = report["appearance"];
  EXPECT_EQ(appearance["environment"], "studio");
  for (const char* const key : {"lights", "size", "mean_luminance", "psnr_db", "psnr_peak",
                                "exposure", "mean_delta_e", "delta_e_95", "mean_color_error"}) {
    ASSERT_TRUE(appearance[key].is_number()) << key;  // null where it is not finite
    EXPECT_GT(appearance[key], 0) << key;
  }
  for (const char* const part : {"at_centers", "between_centers"}) {
    EXPECT_GT(appearance[part]["mean_log_error"], 0) << part;
    EXPECT_GT(appearance[part]["mean_relative_error"], 0) << part;
  }
  EXPECT_GT(appearance["albedo"]["max_error"], 0);
  EXPECT_EQ(appearance["albedo"]["values"].size(), 6U);
  EXPECT_TRUE(appearance["beyond"].is_null());  // all directions were measured
  double shares = report["light"]["diffuse"]["share"];
  for (const auto& lobe : report["light"]["lobes"]) shares += lobe["share"].get<double>();
  EXPECT_NEAR(shares, 1, 1e-12);
  for (const char* const line :
       {"appearance   sphere in studio", "solver       awls: 3 iterations",
        "of a black model's, its scaled gradient ", "options      max_iterations 3",
        "phases       ", "error        E is "}) {
    EXPECT_THAT(result.out, HasSubstr(line));
  }

  const BrdfTable fitted = ReadMerl(out + "/reconstruction.binary");
  const int bin = fitted.grid.Index(10, 20, 90);
  const double expected =
      UnclampedValue(file.model, GridStencils(file.model.spec(), fitted.grid, bin), 1);
  EXPECT_NEAR(fitted.Value(1, bin), expected, 1e-12 * expected);

  // `score` finds the very objective that the fit reported.
  const ProgramResult score =
      RunProgram({"score", out + "/model.json", "synth:plastic", "--noise=0.02", "--json"});
  ASSERT_EQ(score.status, 0) << score.err;
  EXPECT_EQ(nlohmann::json::parse(score.out)["objective"].get<double>(), file.fit.objective);
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The first line says what a person would see, and the others what that rests on.
TEST(Fit, SaysItsVerdictFirstInFewLines) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const ProgramResult result = RunProgram(Fit(out, {"--missing=0", "--max_iterations=0"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<std::string> lines = LinesOf(result.out);
  ASSERT_FALSE(lines.empty());
  EXPECT_LE(lines.size(), 9U) << result.out;
  const nlohmann::json report = Json(out + "/report.json"), verdict = report["verdict"];
  EXPECT_THAT(lines[0],
              StartsWith("verdict      " + verdict["words"].get<std::string>() + " (Delta E "));
  EXPECT_THAT(lines[0], HasSubstr("; PSNR "));
  EXPECT_EQ(verdict["of"], "sphere");
  EXPECT_EQ(verdict["psnr_db"], report["appearance"]["psnr_db"]);
  EXPECT_EQ(verdict["mean_delta_e"], report["appearance"]["mean_delta_e"]);
  double share = 0;
  for (const auto& [name, place] : verdict["places"].items()) share += place["share"].get<double>();
  EXPECT_NEAR(share, 1, 1e-12);
  ASSERT_NE(verdict["visibility"], "none");  // it is the starting point
  EXPECT_EQ(verdict["advice"][0], "iterate");
  EXPECT_THAT(lines[1], StartsWith("advice       a limit stopped it"));

  // `score` finds the same.
  const ProgramResult score = RunProgram(
      {"score", out + "/model.json", "synth:plastic@30x30x60", "--noise=0.02", "--json"});
  ASSERT_EQ(score.status, 0) << score.err;
  const nlohmann::json scored = nlohmann::json::parse(score.out)["verdict"];
  EXPECT_EQ(scored["words"], verdict["words"]);
  EXPECT_EQ(scored["places"], verdict["places"]);
}

// The printed parts, in hundredths of a second, sum to the total, and so do the report's.
TEST(Fit, SecondsSumToTheTotal) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const ProgramResult result = RunProgram(Fit(out));
  ASSERT_EQ(result.status, 0) << result.err;
  const size_t at = result.out.find("\nseconds      ");
  ASSERT_NE(at, std::string::npos) << result.out;
  std::istringstream line(result.out.substr(at + 14, result.out.find('\n', at + 1) - at - 14));
  double total = 0, sum = 0;
  char colon = 0;
  ASSERT_TRUE(line >> total >> colon) << result.out;
  EXPECT_EQ(colon, ':');
  for (std::string part; std::getline(line, part, ',');) sum += std::stod(part);
  EXPECT_NEAR(sum, total, 1e-9);
  double reported = 0;
  const nlohmann::json seconds = Json(out + "/report.json")["seconds"];
  for (const auto& [name, part] : seconds.items()) {
    reported += part.get<double>();
  }
  EXPECT_NEAR(total, reported, 0.05);  // about ten parts, rounded
}

TEST(Fit, SaysWhatItLeftOutAndWhy) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const ProgramResult result =
      RunProgram(Fit(out, {"--max_angle=60", "--noise=0", "--missing=0", "--plots", "--verbose"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json report = Json(out + "/report.json"), bins = report["bins"];
  const int valid = report["valid_samples"];
  EXPECT_EQ(bins["valid"], valid);
  EXPECT_LT(valid, 40644);
  EXPECT_EQ(bins["below_surface"], 54000 - 40644);
  EXPECT_EQ(bins["beyond_max_angle"], 40644 - valid);
  EXPECT_EQ(bins["extrapolated"], 0);
  EXPECT_EQ(report["max_angle"], 60);
  EXPECT_GT(report["seconds"]["draw"], 0);
  EXPECT_THAT(result.out, HasSubstr(" drawing"));
  for (const char* const key : {"share", "largest", "largest_within", "psnr_db"}) {
    ASSERT_TRUE(report["appearance"]["beyond"][key].is_number()) << key;
    EXPECT_GT(report["appearance"]["beyond"][key], 0) << key;
  }
  EXPECT_EQ(ReadModel(out + "/model.json").fit.max_angle, report["max_angle"].get<double>());
  EXPECT_THAT(result.out, HasSubstr(std::to_string(valid) + " valid samples up to 60 deg\n"));
  EXPECT_THAT(result.out, HasSubstr("\nnot measured "));
  EXPECT_THAT(result.out, HasSubstr("left out     bins 13356 below the surface, " +
                                    std::to_string(40644 - valid) + " beyond --max_angle\n"));
}

// Side by side they are what they are one after the other.
TEST(Fit, PicturesAreTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::string one = folder / "one", all = folder / "all";
  ASSERT_EQ(RunProgram(Fit(one, {"--plots", "--threads=1"})).status, 0);
  ASSERT_EQ(RunProgram({"plot", one + "/model.json", "synth:plastic@30x30x60", "--noise=0.02",
                        "--missing=0.8", "--trace=" + one + "/trace.csv", "--out=" + all})
                .status,
            0);
  for (const char* const name : {"/factors.png", "/slices.png", "/spheres.png", "/trace.png"}) {
    EXPECT_EQ(Contents(one + name), Contents(all + name)) << name;
  }
}

TEST(Fit, CourseScoresTheModelsOnTheWay) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(RunProgram(Fit(out, {"--convergence"})).status, 0);
  const std::vector<IterationRecord> trace = ReadTrace(out + "/trace.csv");
  const nlohmann::json report = Json(out + "/report.json");
  std::istringstream curve(Contents(out + "/convergence.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(curve, line));
  EXPECT_EQ(line, "iteration,seconds,objective,psnr_db,rmse,mean_relative_error,mean_log_error");
  int rows = 0, iteration = -1;
  double seconds = -1, objective = 0, psnr_db = 0;
  while (std::getline(curve, line)) {
    const double before = seconds;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &iteration, &seconds, &objective, &psnr_db), 4);
    ASSERT_LT(iteration, static_cast<int>(trace.size()));
    EXPECT_EQ(iteration == 0, rows++ == 0);
    EXPECT_EQ(seconds, trace[iteration].seconds);
    EXPECT_GT(seconds, before);
    EXPECT_EQ(objective, trace[iteration].objective);
  }
  EXPECT_EQ(iteration, trace.back().iteration);
  EXPECT_NEAR(psnr_db, report["psnr_db"].get<double>(), 1e-9);     // that one is in canonical form
  EXPECT_TRUE(report["appearance"]["between_centers"].is_null());  // no whole cell was measured
}

TEST(Fit, RepeatsToTheBitAndThreadsAgree) {
  const TemporaryFolder folder;
  std::vector<FactorModel> models;
  for (const char* threads : {"1", "1", "2"}) {
    const std::string out = folder / std::to_string(models.size());
    ASSERT_EQ(RunProgram(Fit(out, {std::string("--threads=") + threads})).status, 0);
    models.push_back(ReadModel(out + "/model.json").model);
  }
  for (size_t k = 1; k < models.size(); ++k) {
    EXPECT_THAT(models[k].parameters(), ::testing::ElementsAreArray(models[0].parameters()));
  }
}

TEST(Fit, GoesOnFromAModelFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "first", {"--lobes=2"})).status, 0);
  const std::string model = folder / "first/model.json";
  ASSERT_EQ(RunProgram(Fit(folder / "second", {"--init=" + model})).status, 0);
  const auto first = ReadTrace(folder / "first/trace.csv");
  const auto second = ReadTrace(folder / "second/trace.csv");
  EXPECT_NEAR(second[0].objective, first.back().objective, 1e-10 * first.back().objective);
  EXPECT_LT(second.back().objective, first.back().objective);

  const ProgramResult other = RunProgram(Fit(folder / "third", {"--init=" + model, "--lobes=3"}));
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("--lobes"));
}

TEST(Fit, FitsTheOneLobeModelThatSharesNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out", {"--model=independent"})).status, 0);
  EXPECT_EQ(ReadModel(folder / "out/model.json").model.spec().num_parameters(),
            276);  // 92 a channel
}

TEST(Fit, TellsWhatTheMeasurementLacksOfReciprocityWhereThatIsMuch) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& noise) {
    const ProgramResult result = RunProgram({"fit", "synth:plastic@20x20x40", "--noise=" + noise,
                                             "--solver=awls", "--max_iterations=20", "--nodiagnose",
                                             "--noplots", "--verbose", "--out=" + folder / noise});
    EXPECT_EQ(result.status, 0) << result.err;
    const nlohmann::json report = Json(folder / noise + "/report.json");
    const double share =
        report["irreducible_objective"].get<double>() / report["objective"].get<double>();
    EXPECT_EQ(result.out.find("\nreciprocity ") != std::string::npos, share >= 0.1) << share;
    return share;
  };
  EXPECT_GT(told("0.1"), 0.1);
  EXPECT_LT(told("0"), 0.1);
}

TEST(Fit, AutoChoosesAModelWithinTheBudget) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  // The flags make a quick fit with an edge of the data.
  const ProgramResult result =
      RunProgram({"fit", "synth:plastic@30x30x60", "--model=auto", "--max_parameters=150",
                  "--max_iterations=2", "--lobes=1", "--max_angle=40", "--noise=0.02", "--verbose",
                  "--noplots", "--out=" + out});
  ASSERT_EQ(result.status, 0) << result.err;
  const ModelFile file = ReadModel(out + "/model.json");
  ASSERT_TRUE(file.layout.has_value());
  const int parameters = file.layout->num_parameters(file.model.spec());
  EXPECT_LE(parameters, 150);
  EXPECT_LT(parameters, file.model.spec().num_parameters());

  const nlohmann::json report = Json(out + "/report.json");
  EXPECT_EQ(report["stored_parameters"], parameters);
  EXPECT_EQ(report["parameters"], file.model.spec().num_parameters());
  EXPECT_EQ(report["objective"].get<double>(), file.fit.objective);
  EXPECT_GT(report["seconds"]["finish"], 0);
  EXPECT_THAT(StepsOf(report), testing::IsSupersetOf({"data_edge", "form"}));
  const nlohmann::json& candidates = report["candidates"];
  ASSERT_GE(candidates.size(), 4U);  // the fit, thinned, and two forms
  EXPECT_EQ(candidates[0]["name"], "as fitted");
  EXPECT_EQ(candidates[0]["parameters"], 156);
  int like_the_chosen = 0;
  double best = 0;
  for (const auto& candidate : candidates) {
    for (const char* const key : {"objective", "psnr_db"}) {
      ASSERT_TRUE(candidate[key].is_number()) << key;
      EXPECT_GT(candidate[key], 0) << key;
    }
    EXPECT_GE(candidate["seconds"], 0);
    if (candidate["parameters"] > 150) continue;
    best = std::max(best, candidate["psnr_db"].get<double>());
    like_the_chosen +=
        candidate["parameters"] == parameters && candidate["objective"] == report["objective"];
  }
  EXPECT_EQ(like_the_chosen, 1);
  // The judge saw a quarter of the pixels only.
  EXPECT_NEAR(report["appearance"]["psnr_db"].get<double>(), best, 0.5);
  EXPECT_THAT(result.out, HasSubstr(", " + std::to_string(parameters) + " of them stored, "));
  EXPECT_THAT(result.out, HasSubstr("\ncandidates   as fitted: PSNR "));
  EXPECT_THAT(result.out, HasSubstr("   <- chosen\n"));
  EXPECT_THAT(result.out, HasSubstr(" %, after data edge "));

  // `score` finds the reported E in the stored model.
  const ProgramResult score = RunProgram({"score", out + "/model.json", "synth:plastic@30x30x60",
                                          "--noise=0.02", "--max_angle=40", "--json"});
  ASSERT_EQ(score.status, 0) << score.err;
  EXPECT_EQ(nlohmann::json::parse(score.out)["objective"].get<double>(), file.fit.objective);
}

TEST(Fit, WithoutABudgetThereAreNoCandidates) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out")).status, 0);
  const nlohmann::json report = Json(folder / "out/report.json");
  EXPECT_EQ(report["candidates"], nlohmann::json::array());
  EXPECT_EQ(report["stored_parameters"], 282);
  EXPECT_THAT(StepsOf(report), testing::Not(testing::Contains("data_edge")));  // all was measured
}

// The loss that is linear for large errors gives up some of E for it, and what comes after, at the
// edge of the data, does not win it back.
TEST(Fit, ARobustFitWeighsLargeErrorsLess) {
  const TemporaryFolder folder;
  const std::vector<std::string> few = {
      "--lobes=1",      "--solver=auto",  "--max_iterations=15",  "--noise=0.3",
      "--max_angle=40", "--smoothness=0", "--nomatch_reflectance"};
  std::vector<double> E;
  for (const char* const robust : {"0", "1e6", "0.01"}) {
    std::vector<std::string> flags = few;
    flags.push_back(std::string("--robust=") + robust);
    const ProgramResult result = RunProgram(Fit(folder / robust, flags));
    ASSERT_EQ(result.status, 0) << result.err;
    const nlohmann::json report = Json(folder / (std::string(robust) + "/report.json"));
    EXPECT_THAT(StepsOf(report), testing::Contains("data_edge")) << robust;
    E.push_back(report["objective"]);
  }
  EXPECT_NEAR(E[1], E[0], 1e-5 * E[0]);  // no error is so large: the same loss
  EXPECT_GT(E[2], 1.00005 * E[1]);
}

// A highlight that gets narrower along the plane of both directions, which D of theta_h cannot
// follow: the least E leaves it too dark.
TEST(Fit, ReflectsAsMuchLightAsWasMeasured) {
  const TemporaryFolder folder;
  ModelSpec spec = ModelSpec::SharedFactors(1);
  spec.stretches = Stretch{.along = -1, .across = 0};
  FactorModel material(spec);
  std::ranges::fill(material.d(), 0.02);
  std::ranges::fill(material.s(0), 4.0);
  for (int k = 0; k < spec.d_axis.size; ++k) {
    material.table(Factor::kD, 0)[k] = std::exp(-std::pow(k / 25.0, 4));
  }
  for (int c = 0; c < kChannels; ++c) {
    std::ranges::fill(material.table(Factor::kF, c), 0.3 + 0.2 * c);
  }
  for (int k = 0; k < spec.g_axis.size; ++k) {
    material.table(Factor::kG, 0)[k] = std::cos(DegreesToRadians(k + 0.5));
  }
  WriteModel({material, {}, {}}, folder / "material.json");
  const std::string table = folder / "narrowing.binary";
  ASSERT_EQ(RunProgram({"convert", folder / "material.json", "--out=" + table}).status, 0);
  const auto fit = [&](const char* name, const char* match) {
    return RunProgram({"fit", table, "--lobes=1", "--missing=0.9", "--solver=varpro",
                       "--tolerance=1e-2", "--nodiagnose", "--verbose", match, "--smoothness=0",
                       "--noplots", "--out=" + folder / name});
  };
  const ProgramResult matched = fit("with", "--match_reflectance"),
                      unmatched = fit("without", "--nomatch_reflectance");
  ASSERT_EQ(matched.status, 0) << matched.err;
  ASSERT_EQ(unmatched.status, 0) << unmatched.err;
  const nlohmann::json report = Json(folder / "with/report.json"),
                       plain = Json(folder / "without/report.json");
  ASSERT_EQ(report["stop_reason"], "converged");  // or it is left as it is
  EXPECT_THAT(StepsOf(plain), testing::IsEmpty());
  EXPECT_THAT(matched.out, HasSubstr("reflectance  was off by "));
  ASSERT_THAT(StepsOf(report), testing::ElementsAre("reflected_light"));
  const nlohmann::json& how = report["finishing"][0];
  EXPECT_GT(how["error_before"], 0.01);
  EXPECT_LT(how["error_after"], 0.6 * how["error_before"].get<double>());
  EXPECT_NEAR(how["objective_before"], plain["objective"], 1e-9 * plain["objective"].get<double>());
  EXPECT_EQ(how["objective_after"], report["objective"]);
  EXPECT_EQ(report["solver_objective"], plain["solver_objective"]);
  EXPECT_LT(report["appearance"]["mean_color_error"],
            plain["appearance"]["mean_color_error"].get<double>());
  EXPECT_GE(report["appearance"]["psnr_db"], plain["appearance"]["psnr_db"].get<double>() - 0.3);
}

// Noise leaves the least E too dark. A thinned model is held where nothing was measured: else it
// overshot there on its way to more light, and stayed as it was.
TEST(Fit, AThinnedModelReflectsAsMuchToo) {
  const TemporaryFolder folder;
  const ProgramResult result =
      RunProgram({"fit", "synth:rubber@30x30x60", "--noise=0.3", "--max_angle=40", "--model=auto",
                  "--max_parameters=150", "--lobes=1", "--nodiagnose", "--convergence", "--noplots",
                  "--out=" + folder / "out"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json report = Json(folder / "out/report.json");
  EXPECT_LT(report["stored_parameters"], report["parameters"]);
  ASSERT_THAT(StepsOf(report), testing::Contains("reflected_light"));
  const nlohmann::json& how = *std::ranges::find_if(
      report["finishing"], [](const auto& step) { return step["step"] == "reflected_light"; });
  EXPECT_GT(how["error_before"], 0.03);
  EXPECT_LT(how["error_after"], 0.5 * how["error_before"].get<double>());
}

// The solver's result is printed, reported, stored and traced alike.
TEST(Fit, RawReportsAndStoresWhatTheSolverFound) {
  const TemporaryFolder folder;
  const ProgramResult result = RunProgram(Fit(folder / "out", {"--raw", "--max_angle=60"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const double E = ReadTrace(folder / "out/trace.csv").back().objective;
  const nlohmann::json report = Json(folder / "out/report.json");
  EXPECT_EQ(report["raw"], true);
  EXPECT_EQ(report["solver_objective"], E);
  EXPECT_EQ(ReadModel(folder / "out/model.json").fit.solver_objective, E);
  EXPECT_NEAR(report["objective"], E, 1e-12 * E);
  EXPECT_THAT(StepsOf(report), testing::IsEmpty());
  EXPECT_EQ(report["raised"]["iterations"], nlohmann::json::array());
  EXPECT_THAT(result.out, testing::Not(HasSubstr("\nfinished ")));
  for (const char* const flag :
       {"--robust=0.1", "--smoothness=0.01", "--match_reflectance", "--model=auto"}) {
    const ProgramResult refused = RunProgram(Fit(folder / "refused", {"--raw", flag}));
    EXPECT_EQ(refused.status, 1) << flag;
    EXPECT_THAT(refused.err, HasSubstr("--raw stores what the solver found; leave out --")) << flag;
  }
}

// With --data_seed, seeds change the fit, and not the data.
TEST(Fit, ADataSeedKeepsTheDataWhileTheSeedMovesTheStart) {
  const TemporaryFolder folder;
  const auto initial = [&](const char* name, const std::vector<std::string>& seeds) {
    const ProgramResult result = RunProgram(Fit(folder / name, seeds));
    EXPECT_EQ(result.status, 0) << result.err;
    const nlohmann::json report = Json(folder / (std::string(name) + "/report.json"));
    return std::pair<double, int>(report["initial_objective"], report["valid_samples"]);
  };
  const auto one = initial("one", {"--seed=1"});
  EXPECT_EQ(initial("same", {"--seed=7", "--data_seed=1"}), one);  // the start is not random
  EXPECT_NE(initial("other", {"--seed=1", "--data_seed=7"}), one);
  EXPECT_NE(initial("both", {"--seed=7"}), one);
  const ProgramResult wrong = RunProgram(Fit(folder / "wrong", {"--data_seed=-2"}));
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("--data_seed=-2: give an integer from 0"));
}

TEST(Fit, CtrlCKeepsTheBestModelSoFar) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const TerminalResult result = RunOnTerminal(
      Fit(out, {"--max_iterations=1000000", "--tolerance=0", "--plots"}), "iteration 2", SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.text, HasSubstr("stopping: the best so far is kept"));  // before it has
  EXPECT_THAT(result.text, HasSubstr("interrupted"));
  EXPECT_THAT(result.text, HasSubstr("s left"));  // the progress line of a terminal
  const auto trace = ReadTrace(out + "/trace.csv");
  ASSERT_GE(trace.size(), 3U);
  const ModelFile file = ReadModel(out + "/model.json");
  EXPECT_EQ(file.fit.stop_reason, "interrupted");
  EXPECT_FALSE(std::filesystem::exists(out + "/spheres.png"));  // for which nobody waits
  EXPECT_NEAR(file.fit.objective, trace.back().objective, 1e-12 * trace.back().objective);
}

// Parts of a line that is drawn over and over.
std::vector<std::string> Drawn(const std::string& text) {
  const std::string clear = "\r\033[K";
  std::vector<std::string> parts;
  for (size_t at = text.find(clear); at != std::string::npos;) {
    const size_t begin = at + clear.size(), next = text.find(clear, begin);
    const std::string part = text.substr(begin, next == std::string::npos ? next : next - begin);
    if (part.find('\n') == std::string::npos) parts.push_back(part);
    at = next;
  }
  return parts;
}

TEST(Fit, SaysOnATerminalWhatGoesOn) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments = {"fit", "synth:plastic@30x30x60", "--max_iterations=3",
                                              "--out=" + (folder / "a folder of a long name")};
  for (const uint16_t columns : {uint16_t{40}, uint16_t{80}}) {
    const TerminalResult result = RunOnTerminal(arguments, "", 0, 1, columns);
    EXPECT_EQ(result.status, 0);
    const std::vector<std::string> drawn = Drawn(result.text);
    for (const char* const stage : {"reading synth:plastic", "fitting", "finishing: data edge",
                                    "comparing with the measure"}) {
      EXPECT_THAT(drawn, testing::Contains(testing::StartsWith(stage))) << columns;
    }
    for (const std::string& line : drawn) EXPECT_LT(line.size(), columns) << line;
  }
  std::vector<std::string> quiet = arguments;
  quiet.emplace_back("--quiet");
  EXPECT_THAT(Drawn(RunOnTerminal(quiet, "", 0).text), testing::Each(""));
}

// The solver is through at once; what comes then takes seconds.
TEST(Fit, CtrlCWhileFinishingKeepsTheModelToo) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const TerminalResult result =
      RunOnTerminal(Fit(out, {"--model=auto", "--max_parameters=500", "--max_iterations=0"}),
                    "iteration 0", SIGINT);
  EXPECT_EQ(result.status, 130) << result.text;
  EXPECT_THAT(result.text, HasSubstr("interrupted"));
  const nlohmann::json report = Json(out + "/report.json");
  EXPECT_EQ(ReadModel(out + "/model.json").fit.objective, report["objective"].get<double>());
  EXPECT_LE(report["candidates"].size(), 4U);  // it did not go on as if nothing had happened
}

TEST(Fit, TellsOnATerminalHowFarItsStartsAre) {
  const TemporaryFolder folder;
  const TerminalResult result = RunOnTerminal(
      {"fit", "synth:felt@12x12x24", "--solver=multistart", "--starts=12", "--lobes=1",
       "--max_iterations=4", "--nodiagnose", "--out=" + (folder / "out")},
      "", 0);
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.text, HasSubstr("start 1 of 8, round 1 of 3"));
  EXPECT_THAT(result.text, HasSubstr("s left for starts"));
  EXPECT_THAT(result.text, HasSubstr("the lowest so far"));
}

TEST(Fit, SaysWhereEachStartHasEnded) {
  const TemporaryFolder folder;
  const std::vector<std::string> words = {
      "fit",          "synth:felt@12x12x24", "--solver=multistart",
      "--starts=12",  "--lobes=1",           "--max_iterations=9",
      "--nodiagnose", "--noplots",           "--out=" + (folder / "out")};
  EXPECT_THAT(RunProgram(words).err, Not(HasSubstr("lowest")));
  std::vector<std::string> verbose = words;
  verbose.push_back("--verbose");
  const ProgramResult result = RunProgram(verbose);
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json starts = Json(folder / "out/report.json")["starts"];
  EXPECT_EQ(starts[0]["minimum"], 1);
  for (const nlohmann::json& start : starts) {
    EXPECT_THAT(result.err, HasSubstr("start " + start["name"].get<std::string>() + " "));
  }
  EXPECT_THAT(result.err, HasSubstr("the lowest so far"));
  EXPECT_THAT(result.out, HasSubstr("ended in the lowest of"));
}

TEST(Fit, HonoursItsTimeLimit) {
  const TemporaryFolder folder;
  const ProgramResult result = RunProgram(
      Fit(folder / "out", {"--max_iterations=1000000", "--tolerance=0", "--max_seconds=0.5"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto trace = ReadTrace(folder / "out/trace.csv");
  EXPECT_GE(trace.back().seconds, 0.5);
  // On a slow machine the start alone may take that long.
  for (size_t k = 0; k + 1 < trace.size(); ++k) EXPECT_LT(trace[k].seconds, 0.5);
}

// Every common flag arrives where it should; in nodes of 3 degrees, --g_filter=2 are 2/3.
TEST(Fit, HandsItsFlagsToTheSolver) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out",
                           {"--solver=awls", "--max_iterations=0", "--max_seconds=7",
                            "--tolerance=0.5", "--optimality_tolerance=1e-3", "--g_filter=2"}))
                .status,
            0);
  const nlohmann::json report = Json(folder / "out/report.json");
  EXPECT_EQ(report["options"]["given"], nlohmann::json({{"max_iterations", 0},
                                                        {"max_seconds", 7.0},
                                                        {"relative_decrease_tolerance", 0.5},
                                                        {"optimality_tolerance", 1e-3},
                                                        {"diagnose", false},
                                                        {"g_filter_sigma", 2.0 / 3}}));
  EXPECT_TRUE(report["diagnosis"].is_null());
}

struct BadInput {
  std::vector<std::string> flags;
  std::string message;  // part of it
};

TEST(Fit, RefusesBadInputInOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::vector<BadInput> cases = {
      {{"--solver=x"}, "known: auto, "},
      {{"--weighting=x"},
       "known: appearance, appearance_channel, log_relative, log_relative_channel, cube_root, "
       "percentage, compressive, "
       "log, "
       "cosine, "
       "uniform"},
      {{"--weighting=power:exponent=9"}, "exponent must be at most 2"},
      {{"--stretch=1"}, "--stretch=1: give ALONG,ACROSS"},
      {{"--stretch=1,x"}, "--stretch=1,x: give"},
      {{"--stretch=0,2.5"}, "it must be from -2 to 2"},
      {{"--stretch=0,1,0.5"}, "--stretch=0,1,0.5: give"},
      {{"--stretch=0,1,0.5,1"}, "has 2 pairs for 3 lobes; give one, or one a lobe"},
      {{"--stretch=0,1,0,1"}, "has 2 pairs for 3 lobes"},
      {{"--probe=missing"}, "missing"},
      {{"--init=x"}, "known: "},
      {{"--init=/nowhere/model.json"}, "/nowhere/model.json"},
      {{"--model=x"},
       "unknown model 'x'; known: shared, isotropic, anisotropic, independent, auto"},
      {{"--model=GGX"}, "`trilobe convert SOURCE --out=FILE.gltf`"},
      {{"--max_parameters=100"}, "--max_parameters goes with --model=auto"},
      {{"--model=independent", "--max_parameters=100"}, "--max_parameters goes with --model=auto"},
      {{"--model=auto", "--max_parameters=0"}, "it must be at least 1"},
      {{"--max_parameters=0"}, "it must be at least 1"},
      {{"--model=auto", "--max_parameters=-5"}, "it must be at least 1"},
      {{"--robust=-1"}, "it must be from 0 to 1e6"},
      {{"--robust=nan"}, "it must be from 0 to 1e6"},
      {{"--smoothness=2"}, "it must be from 0 to 1"},
      {{"--smoothness=nan"}, "it must be from 0 to 1"},
      {{"--robust=inf"}, "it must be from 0 to 1e6"},
      {{"--model=independent", "--lobes=2"}, "--lobes"},
      {{"--lobes=-1"}, "lobes is -1"},
      {{"--lobes=9"}, "lobes is 9"},
      {{"--max_iterations=-1"}, "--max_iterations"},
      {{"--max_seconds=-1"}, "--max_seconds"},
      {{"--max_seconds=nan"}, "--max_seconds"},
      {{"--tolerance=1"}, "--tolerance"},
      {{"--optimality_tolerance=nan"}, "--optimality_tolerance"},
      {{"--g_filter=-1"}, "--g_filter"},
      {{"--solver=awls", "--starts=2"}, "awls does not take --starts; it takes --g_filter"},
      {{"--solver=awls", "--memory=3"}, "does not take --memory"},
      {{"--solver=awls", "--positivity=bounds"}, "does not take --positivity"},
      {{"--solver=awls", "--trust_region=dogleg"}, "does not take --trust_region"},
      {{"--threads=-1"}, "--threads"},
      {{"--noise=2"}, "noise"},
      {{"--max_angle=0"}, "--max_angle is 0; it must be in degrees above 0"},
      {{"--max_angle=-5"}, "above 0, up to 90"},
      {{"--max_angle=90.5"}, "above 0, up to 90"},
      {{"--max_angle=nan"}, "above 0, up to 90"},
      {{"--max_angle=0.001"}, "no valid bin"},
      {{"--min_theta_d=-2"}, "--min_theta_d is -2; it must be in degrees from 0"},
      {{"--min_theta_d=90"}, "from 0 to below 90"},
      {{"--min_theta_d=nan"}, "from 0 to below 90"},
      {{"--min_theta_d=89.9"}, "no valid bin"},
      {{"--json"}, "no flag --json"},
  };
  for (const BadInput& bad : cases) {
    SCOPED_TRACE(bad.flags[0]);
    const ProgramResult result = RunProgram(Fit(out, bad.flags));
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, StartsWith("trilobe: error: "));
    EXPECT_THAT(result.err, HasSubstr(bad.message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(Fit, SaysSoWhenItsReportIsLost) {
  const TerminalResult result = RunOnTerminal({"synth"}, "", 0);
  EXPECT_EQ(result.status, 0);
  // The same with standard output on a full disk.
  const std::string program = Program();
  const pid_t pid = fork();
  if (pid == 0) {
    const int full = open("/dev/full", O_WRONLY);
    if (dup2(full, STDOUT_FILENO) < 0 || dup2(full, STDERR_FILENO) < 0) _exit(126);
    execl(program.c_str(), program.c_str(), "synth", nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

// `sh` closes a stream with >&-. The next file that is opened must not take its place.
TEST(Fit, TakesNoFileForAStandardStream) {
  const auto run = [](const std::string& command) {
    return RunProgram({"-c", command, Program()}, {}, "/bin/sh");
  };
  for (const char* const command : {"\"$0\" synth >&-", "\"$0\" --version >&-",
                                    "\"$0\" --version > /dev/full", "\"$0\" help fit >&-"}) {
    const ProgramResult result = run(command);
    EXPECT_EQ(result.status, 1) << command;
    EXPECT_EQ(result.err, "trilobe: error: cannot write to standard output\n") << command;
  }
  for (const char* const command : {"\"$0\" info /dev/stdin <&-", "\"$0\" info /dev/stdout >&-"}) {
    EXPECT_THAT(run(command).err, HasSubstr("it is not a regular file")) << command;
  }
  EXPECT_EQ(run("\"$0\" --version").out.substr(0, 16), "trilobe version ");
}

TEST(Fit, ReportsTheModelThatAStartBroughtAlong) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "first", {"--model=independent"})).status, 0);
  const std::string init = "--init=" + (folder / "first/model.json");
  ASSERT_EQ(RunProgram(Fit(folder / "second", {init})).status, 0);
  EXPECT_EQ(Json(folder / "second/report.json")["model"], "independent");
}

TEST(Fit, PrefersANameToAFolderOfThatName) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "constant");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(std::filesystem::path(folder / "constant").parent_path());
  const ProgramResult result = RunProgram(Fit(folder / "out", {"--init=constant"}));
  std::filesystem::current_path(before);
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST(Fit, KeepsEarlierResultsWhenTheFolderIsAFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunProgram(Fit(folder / "out")).status, 0);
  const std::string before = Contents(folder / "out/model.json");
  const ProgramResult result = RunProgram(Fit(folder / "out/model.json"));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("model.json"));
  EXPECT_EQ(Contents(folder / "out/model.json"), before);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
