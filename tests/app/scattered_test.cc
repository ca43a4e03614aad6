// `trilobe fit` stores the model that was solved for scattered samples, on its own few nodes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Scattered : public ::testing::Test {
 protected:
  Scattered() {
    const ProgramResult made = RunProgram(
        {"convert", "synth:rubber@30x30x60", "--missing=0.9", "--out=" + folder_ / "few.csv"});
    EXPECT_EQ(made.status, 0) << made.err;
  }

  // Without a prior, so that the solver's E is that of the data.
  json Fit(const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"fit", folder_ / "few.csv", "--prior=0", "--solver=awls",
                                          "--out=" + folder_ / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult fit = RunProgram(arguments);
    EXPECT_EQ(fit.status, 0) << fit.err;
    return json::parse(Contents(folder_ / name + "/report.json"));
  }

  const TemporaryFolder folder_;
};

TEST_F(Scattered, StoresTheModelThatWasSolved) {
  const json report = Fit("fit", {"--lobes=1", "--max_iterations=20", "--plots"});
  EXPECT_EQ(report["model"], "shared");
  EXPECT_GT(report["reach"]["between_samples"], 0.1);
  const std::string path = folder_ / "fit/model.json";
  const ModelFile file = ReadModel(path);
  EXPECT_EQ(file.model.spec(),
            ModelSpec::SharedFactors(1).ForScattered(report["valid_samples"].get<int>()));

  const std::vector<IterationRecord> trace = ReadTrace(folder_ / "fit/trace.csv");
  const double solved = std::ranges::min(trace, {}, &IterationRecord::objective).objective;
  EXPECT_EQ(report["solver_objective"], solved);
  EXPECT_EQ(file.fit.solver_objective, solved);
  EXPECT_EQ(report["finishing"], json::array());  // nothing follows awls that has not converged
  EXPECT_NEAR(report["objective"], solved, 1e-9 * solved);
  EXPECT_EQ(file.fit.objective, report["objective"]);
  const json score = json::parse(RunProgram({"score", path, folder_ / "few.csv", "--json"}).out);
  EXPECT_NEAR(score["objective"], solved, 1e-9 * solved);

  // Evaluators take its few nodes.
  const PreparedModel<double> prepared(file.model);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> theta(0, 1.5), phi(0, 6);
  for (int k = 0; k < 100; ++k) {
    const DirectionPair at =
        ToDirections(SphericalAngles{theta(random), phi(random), theta(random), phi(random)});
    const Rgb expected = Evaluate(file.model, at), value = prepared.Value(at.wi, at.wo);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], 1e-9 * (1 + expected[c]));
  }
  // The model can be compared with the whole table that the samples are of.
  const json whole =
      json::parse(RunProgram({"score", path, "synth:rubber@30x30x60", "--json"}).out);
  EXPECT_LT(whole["relative_objective"], 0.1);
  const ProgramResult info = RunProgram({"info", path});
  EXPECT_THAT(info.out, HasSubstr(std::to_string(file.model.spec().num_parameters())));
  EXPECT_EQ(RunProgram({"convert", path, "--out=" + folder_ / "fit.bin"}).status, 0);
}

TEST_F(Scattered, AFitFromAStoredModelKeepsItsSmallForm) {
  const json first = Fit("first", {"--lobes=1", "--max_iterations=10"});
  const json second =
      Fit("second", {"--init=" + folder_ / "first/model.json", "--max_iterations=3"});
  EXPECT_EQ(second["parameters"], first["parameters"]);
  EXPECT_EQ(ReadModel(folder_ / "second/model.json").model.spec(),
            ReadModel(folder_ / "first/model.json").model.spec());
  EXPECT_NEAR(second["initial_objective"], first["objective"],
              1e-9 * first["objective"].get<double>());
}

// The report says by what; too few samples are fitted by the default form, with a line about it.
TEST_F(Scattered, AFormIsChosenByHeldOutSamples) {
  const json report = Fit("auto", {"--model=auto", "--lobes=1", "--max_parameters=120",
                                   "--max_iterations=10", "--noplots"});
  const json& candidates = report["candidates"];
  ASSERT_GE(candidates.size(), 3U);
  EXPECT_EQ(candidates[0]["name"], "as fitted");
  EXPECT_NEAR(report["candidates_held_out"], 0.2 * report["valid_samples"].get<double>(),
              0.05 * report["valid_samples"].get<double>());
  EXPECT_LE(report["stored_parameters"], 120);
  const ModelFile file = ReadModel(folder_ / "auto/model.json");
  ASSERT_TRUE(file.layout);
  EXPECT_EQ(file.layout->num_parameters(file.model.spec()), report["stored_parameters"]);
  const json score = json::parse(
      RunProgram({"score", folder_ / "auto/model.json", folder_ / "few.csv", "--json"}).out);
  EXPECT_NEAR(score["objective"], report["objective"], 1e-9 * score["objective"].get<double>());

  const ProgramResult few = RunProgram({"fit", folder_ / "few.csv", "--missing=0.9", "--model=auto",
                                        "--lobes=1", "--solver=awls", "--max_iterations=3",
                                        "--verbose", "--noplots", "--out=" + folder_ / "few"});
  ASSERT_EQ(few.status, 0) << few.err;
  EXPECT_THAT(few.out, HasSubstr("note         no form was chosen, which takes 1350 samples"));
  EXPECT_EQ(json::parse(Contents(folder_ / "few/report.json"))["candidates"], json::array());
}

TEST_F(Scattered, AnisotropicFormsAreChosenByHeldOutSamples) {
  const std::string csv = folder_ / "cloth.csv";
  ASSERT_EQ(
      RunProgram({"convert", "synth:charmeuse@6x24", "--missing=0.75", "--out=" + csv}).status, 0);
  const std::vector<std::string> quick = {"fit",
                                          csv,
                                          "--model=auto",
                                          "--lobes=1",
                                          "--solver=awls",
                                          "--out=" + folder_ / "cloth",
                                          "--max_iterations=2",
                                          "--nodiagnose",
                                          "--noplots"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = quick;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  };
  const ProgramResult fit = with({"--max_parameters=350", "--verbose"});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("samples, by which candidates were judged"));
  EXPECT_THAT(fit.out, HasSubstr("<- chosen"));
  EXPECT_LE(ReadModel(folder_ / "cloth/model.json").model.spec().num_parameters(), 350);
  const ProgramResult small = with({"--max_parameters=40"});
  EXPECT_NE(small.status, 0);
  EXPECT_THAT(small.err, HasSubstr("no anisotropic form keeps to 40 parameters"));
  const ProgramResult nodes = with({"--nodes=held_out"});
  EXPECT_NE(nodes.status, 0);
  EXPECT_THAT(nodes.err, HasSubstr("--model=auto chooses the nodes"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
