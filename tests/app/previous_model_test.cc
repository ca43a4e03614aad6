// A fit does not replace a model that it would not make again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/paths.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PreviousModel : public ::testing::Test {
 protected:
  ProgramResult Fit(const std::vector<std::string>& more,
                    const std::string& source = "synth:felt@12x12x24") const {
    std::vector<std::string> arguments = {
        "fit", source, "--solver=awls", "--max_iterations=1", "--nodiagnose", "--out=" + out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result;
  }
  bool HasPrevious(const std::string& folder = "") const {
    return std::filesystem::exists(out_ + folder + "/model.previous.json");
  }

  const TemporaryFolder folder_;
  const std::string out_ = folder_ / "out";
};

TEST_F(PreviousModel, StaysWhereFlagsOrTheSourceAreOthers) {
  Fit({"--lobes=1"});
  const std::string first = Contents(out_ + "/model.json");
  const ProgramResult second = Fit({"--lobes=2"});
  EXPECT_THAT(second.out, HasSubstr("kept         the earlier model, of other flags, as "
                                    "model.previous.json\n"));
  EXPECT_EQ(Contents(out_ + "/model.previous.json"), first);
  EXPECT_EQ(ReadModel(out_ + "/model.json").model.spec().lobes, 2);

  const ProgramResult third = Fit({"--lobes=2"}, "synth:rubber@12x12x24");
  EXPECT_THAT(third.out, HasSubstr("the earlier model, of synth:felt@12x12x24, as "));
  EXPECT_EQ(ReadModel(out_ + "/model.previous.json").model.spec().lobes, 2);

  // It is no file that a fit may read and overwrite.
  const ProgramResult refused = RunProgram(
      {"fit", "synth:felt@12x12x24", "--out=" + out_, "--init=" + out_ + "/model.previous.json"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("would destroy"));
}

TEST_F(PreviousModel, IsNotKeptWhereTheSameIsFitted) {
  Fit({"--lobes=1"});
  const ProgramResult again = Fit({"--lobes=1", "--convergence", "--threads=1", "--diagnose"});
  EXPECT_THAT(again.out, Not(HasSubstr("kept")));
  EXPECT_FALSE(HasPrevious());
}

TEST_F(PreviousModel, StaysWhateverItIsIfForced) {
  std::filesystem::create_directory(out_);
  std::ofstream(out_ + "/model.json") << "no model";
  Fit({"--lobes=1", "--force"});
  EXPECT_EQ(Contents(out_ + "/model.previous.json"), "no model");
  // It is in the way of the next model that is to be kept, and of no other.
  Fit({"--lobes=1"});
  const ProgramResult refused =
      RunProgram({"fit", "synth:felt@12x12x24", "--lobes=2", "--out=" + out_});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err,
              HasSubstr("model.previous.json' exists, and Trilobe has not written it"));
  EXPECT_EQ(Contents(out_ + "/model.previous.json"), "no model");
}

TEST_F(PreviousModel, OfABatchStaysAndTheBatchGoesOn) {
  const auto fit = [&](const std::string& lobes) {
    ProgramResult result = Fit({"synth:rubber@12x12x24", lobes});
    return result.out;
  };
  fit("--lobes=1");
  EXPECT_THAT(fit("--lobes=1"), HasSubstr("felt: kept"));
  EXPECT_FALSE(HasPrevious("/felt"));
  EXPECT_THAT(fit("--lobes=2"),
              HasSubstr("; the earlier model, of other flags, is model.previous"));
  EXPECT_TRUE(HasPrevious("/felt"));
  EXPECT_TRUE(HasPrevious("/rubber"));
  EXPECT_THAT(fit("--lobes=2"), HasSubstr("felt: kept"));
  // An unfinished fit of the same flags is made again, and its model is not kept.
  std::filesystem::remove(out_ + "/felt/report.json");
  std::filesystem::remove(out_ + "/felt/model.previous.json");
  EXPECT_THAT(fit("--lobes=2"), HasSubstr("felt: fitted"));
  EXPECT_FALSE(HasPrevious("/felt"));
}

TEST_F(PreviousModel, OfASceneStays) {
  const auto fit = [&](const std::string& materials, const std::string& lobes) {
    std::ofstream(folder_ / "scene.json")
        << R"({"format": "trilobe-scene", "version": 1, "materials": [)" << materials << "]}";
    const ProgramResult result =
        RunProgram({"fit", "--scene=" + (folder_ / "scene.json"), "--nocache", "--solver=awls",
                    "--max_iterations=1", lobes, "--out=" + out_});
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  const std::string felt = R"({"name": "felt", "source": "synth:felt@12x12x24"})",
                    rubber = R"({"name": "rubber", "source": "synth:rubber@12x12x24"})";
  fit(felt + ", " + rubber, "--lobes=1");
  EXPECT_THAT(fit(felt + ", " + rubber, "--lobes=1"), Not(HasSubstr("an earlier scene")));
  EXPECT_FALSE(std::filesystem::exists(out_ + "/felt.previous.json"));
  const std::string before = Contents(out_ + "/rubber.json");
  EXPECT_THAT(fit(felt, "--lobes=1"), HasSubstr("kept: 2 models of an earlier scene"));
  EXPECT_TRUE(std::filesystem::exists(out_ + "/felt.previous.json"));
  EXPECT_EQ(Contents(out_ + "/rubber.previous.json"), before);
  EXPECT_FALSE(std::filesystem::exists(out_ + "/rubber.json"));
  EXPECT_THAT(fit(felt, "--lobes=2"), HasSubstr("kept: 1 model of"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
