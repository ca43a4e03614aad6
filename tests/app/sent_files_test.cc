// Files that are meant to be sent say nothing of the folders of the machine where they were made.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/text.h"
#include "core/system/content_hash.h"
#include "tests/app/run_program.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kUser = "ann-of-cleves";

class SentFiles : public ::testing::Test {
 protected:
  SentFiles() : home_(folder_ / kUser) {
    std::filesystem::create_directories(home_);
    Run({"convert", "synth:rubber@12x12x24", "--missing=0.6", "--out=" + measured_});
  }

  static ProgramResult Run(const std::vector<std::string>& arguments, int status = 0) {
    ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.status, status) << result.out << result.err;
    return result;
  }

  std::vector<std::string> Fit(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"fit",          measured_,     "--out=" + out,
                                          "--lobes=1",    "--prior=0",   "--solver=awls",
                                          "--nodiagnose", "--threads=2", "--max_iterations=2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  // All files in a folder but reports, and all of their text.
  static std::string TextIn(const std::string& folder) {
    std::string text;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && entry.path().filename() != "report.json") {
        text += entry.path().filename().string() + ":\n" + Contents(entry.path().string());
      }
    }
    return text;
  }

  const TemporaryFolder folder_;
  const std::string home_, measured_ = home_ + "/felt.csv";
};

TEST_F(SentFiles, NameTheFileAndItsChecksum) {
  const std::string out = folder_ / "fit", start = home_ + "/start.json";
  Run(Fit(folder_ / "first", {}));
  std::filesystem::copy(folder_ / "first/model.json", start);
  std::vector<std::string> fit = Fit(out, {"--plots", "--init=" + start});
  std::erase(fit, "--lobes=1");
  Run(fit);
  const std::string model = out + "/model.json", sum = ContentHash(Contents(measured_));
  const json info = json::parse(Contents(model))["fit"];
  EXPECT_EQ(info["source"], "felt.csv");
  EXPECT_EQ(info["source_xxh128"], sum);
  EXPECT_EQ(info["init"], "start.json");
  const json report = json::parse(Contents(out + "/report.json"));
  EXPECT_EQ(report["source"], measured_);
  EXPECT_EQ(report["source_xxh128"], sum);

  for (const char* const ending : {".glsl", ".mtlx", ".bsdf"}) {
    Run({"convert", model, "--out=" + out + "/x" + ending});
  }
  Run({"view", model, measured_, "--out=" + out + "/other.html"});
  EXPECT_THAT(TextIn(out), Not(HasSubstr(kUser)));
  EXPECT_THAT(Contents(out + "/x.mtlx"),
              HasSubstr("model.json, fitted to felt.csv (XXH128 " + sum + ")"));
}

TEST_F(SentFiles, OfABatchNameNoFolderEvenInErrors) {
  const std::string bad = home_ + "/bad.csv", out = home_ + "/fits";
  std::ofstream(bad) << "no measurement\n";
  const ProgramResult result = Run(Fit(out, {bad, home_ + "/gone.csv"}), 3);
  EXPECT_THAT(result.out, HasSubstr(bad));  // the terminal shows the whole path
  EXPECT_THAT(TextIn(out), HasSubstr("\nfelt,felt.csv,fitted,"));
  EXPECT_THAT(TextIn(out), HasSubstr("bad.csv: "));
  EXPECT_THAT(TextIn(out), Not(HasSubstr(kUser)));
}

TEST_F(SentFiles, OfASceneNameNoFolder) {
  const std::string out = folder_ / "models", scene = home_ + "/scene.json";
  std::ofstream(home_ + "/bad.csv") << "no measurement\n";
  std::ofstream(scene) << R"({"format": "trilobe-scene", "version": 1, "materials": [
      {"name": "a", "source": "felt.csv"}, {"name": "b", "source": "bad.csv"}]})";
  Run({"fit", "--scene=" + scene, "--lobes=1", "--solver=awls", "--max_iterations=2", "--nocache",
       "--out=" + out},
      3);
  json plan = json::parse(Contents(out + "/plan.json"));
  EXPECT_EQ(plan["scene"], scene);  // which `trilobe compare` reads
  plan.erase("scene");
  std::ofstream(out + "/plan.json") << plan;
  EXPECT_EQ(plan["materials"][0]["source"], "felt.csv");
  EXPECT_THAT(plan["failed"][0]["error"].get<std::string>(), ::testing::StartsWith("bad.csv: "));
  EXPECT_THAT(TextIn(out), Not(HasSubstr(kUser)));
}

// Models that have been written before hold paths: they are read, and written without.
TEST_F(SentFiles, OfOldModelsLoseTheirPaths) {
  const std::string old = folder_ / "old.json", page = folder_ / "page.html";
  Run(Fit(folder_ / "first", {}));
  json model = json::parse(Contents(folder_ / "first/model.json"));
  model["fit"]["source"] = measured_;
  model["fit"].erase("source_xxh128");
  std::ofstream(old) << model;
  EXPECT_EQ(ReadModel(old).fit.source, measured_);
  Run({"view", old, "--out=" + page});
  EXPECT_THAT(Contents(page), HasSubstr("felt.csv"));
  EXPECT_THAT(Contents(page), Not(HasSubstr(kUser)));
}

bool IsUtf8(std::string_view text) {
  while (!text.empty()) {
    const size_t length = Utf8Length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

// A name may have any bytes. What is written is text all the same, and tells which file was meant.
TEST_F(SentFiles, AreUtf8WhateverAFileIsCalled) {
  const std::string name = "f\xfcr,1", shown = R"(f\xfcr,1)", out = folder_ / "fits";
  for (const std::string& file : {name, std::string("\xff\xfe")}) {
    std::filesystem::copy(measured_, home_ + "/" + file + ".csv");
  }
  std::ofstream(home_ + "/bad\xc3.csv") << "no measurement\n";
  Run({"fit", home_, "--out=" + out, "--lobes=1", "--prior=0", "--solver=awls",
       "--max_iterations=2", "--nodiagnose", "--plots"},
      3);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    const std::string path = entry.path().string();
    if (entry.is_directory() || path.ends_with(".png")) continue;
    EXPECT_TRUE(IsUtf8(Contents(path))) << path;
  }
  const std::string table = Contents(out + "/fits.csv"), page = Contents(out + "/index.html");
  EXPECT_THAT(table, HasSubstr("\n\"" + shown + "\",\"" + shown + ".csv\",fitted,"));
  EXPECT_THAT(table, HasSubstr(R"(bad\xc3.csv,failed)"));
  EXPECT_THAT(page, HasSubstr("<b>" + shown + "</b> fitted"));
  const std::string folder = out + "/" + name;
  EXPECT_EQ(json::parse(Contents(folder + "/model.json"))["fit"]["source"], shown + ".csv");
  const json report = json::parse(Contents(folder + "/report.json"));
  EXPECT_EQ(report["source"], home_ + "/" + shown + ".csv");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
