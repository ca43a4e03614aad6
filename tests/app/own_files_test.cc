// Commands overwrite and remove what Trilobe has written, and nothing else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/run_program.h"
#include "tests/paths.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* kSource = "synth:felt@12x12x24";

std::vector<std::string> Fit(const std::string& out, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"fit",         kSource,        "--solver=awls",
                                        "--lobes=1",   "--nodiagnose", "--max_iterations=1",
                                        "--out=" + out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// The content of all files below a folder, by path.
std::map<std::string, std::string> FilesIn(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().string()] = Contents(entry.path().string());
  }
  return files;
}

ProgramResult Succeed(std::vector<std::string> arguments) {
  ProgramResult result = RunProgram(arguments, {"TRILOBE_TEST_LIGHTS=6"});
  EXPECT_EQ(result.status, 0) << arguments[0] << ": " << result.err;
  return result;
}

// The command is refused in one line that names the file, and nothing has changed.
void ExpectRefusal(const std::vector<std::string>& arguments, const std::string& path,
                   const std::string& folder) {
  SCOPED_TRACE(arguments[0] + " " + path);
  const auto before = FilesIn(folder);
  const ProgramResult result = RunProgram(arguments, {"TRILOBE_TEST_LIGHTS=6"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("'" + path + "' exists, and "));
  EXPECT_THAT(result.err, HasSubstr("--force"));
  EXPECT_EQ(FilesIn(folder), before);
}

// A folder may be anybody's, whatever its files are called.
TEST(OwnFiles, AreKnownByWhatTheySay) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  fs::create_directory(out);
  std::ofstream(out + "/report.json") << R"({"tool": "other"})"
                                      << "\n";
  std::ofstream(out + "/view.html") << "mine";
  ExpectRefusal(Fit(out), out + "/report.json", out);
  fs::remove(out + "/report.json");
  ExpectRefusal(Fit(out), out + "/view.html", out);
  Succeed(Fit(out, {"--force"}));
  EXPECT_FALSE(fs::exists(out + "/view.html"));
  Succeed(Fit(out));
}

// Replaces each file that the command writes by one of the user's, beside the result and alone: the
// command must refuse to overwrite it.
void ExpectAllRefused(const std::vector<std::string>& command, const std::string& folder) {
  Succeed(command);
  const auto written = FilesIn(folder);
  ASSERT_FALSE(written.empty());
  Succeed(command);  // its own are not in its way
  for (const auto& [path, content] : written) {
    if (path.ends_with(".cache")) continue;
    std::ofstream(path) << "mine, " << content.substr(content.size() / 2, 40);
    ExpectRefusal(command, path, folder);
    std::ofstream(path) << content;
  }
}

TEST(OwnFiles, OfAFitWithAllItsFiles) {
  const TemporaryFolder folder;
  ExpectAllRefused(Fit(folder / "out", {"--plots", "--reconstruction", "--convergence"}),
                   folder / "out");
}

TEST(OwnFiles, OfManyFits) {
  const TemporaryFolder folder;
  ExpectAllRefused(Fit(folder / "out", {"synth:rubber@12x12x24"}), folder / "out");
}

TEST(OwnFiles, OfAStudy) {
  const TemporaryFolder folder;
  ExpectAllRefused({"study", kSource, "--solvers=awls", "--runs=1", "--max_iterations=2",
                    "--nodiagnose", "--out=" + (folder / "out")},
                   folder / "out");
}

TEST(OwnFiles, OfAScene) {
  const TemporaryFolder folder;
  std::ofstream(folder / "scene.json") << R"({"format": "trilobe-scene", "version": 1,
      "materials": [{"name": "felt", "source": "synth:felt@12x12x24"}]})";
  const std::vector<std::string> command = {"fit",
                                            "--scene=" + (folder / "scene.json"),
                                            "--nocache",
                                            "--solver=awls",
                                            "--lobes=1",
                                            "--max_iterations=1",
                                            "--out=" + (folder / "out")};
  ExpectAllRefused(command, folder / "out");
  // A model that no scene has left here is kept.
  const std::string model = folder / "out/felt.json", own = Contents(model);
  fs::remove(folder / "out/plan.json");
  Succeed(command);
  EXPECT_EQ(Contents(folder / "out/felt.previous.json"), own);
}

// The commands, whose --out is in the folder OUT.
void ExpectAllRefused(const std::vector<std::vector<std::string>>& commands,
                      const std::string& out) {
  for (std::vector<std::string> command : commands) {
    fs::remove_all(out);
    fs::create_directory(out);
    for (std::string& word : command) {
      if (word.starts_with("--out=OUT")) word = "--out=" + out + word.substr(9);
    }
    ExpectAllRefused(command, out);
  }
}

TEST(OwnFiles, OfPagesAndPictures) {
  const TemporaryFolder folder;
  const std::string fit = folder / "fit", model = fit + "/model.json";
  Succeed(Fit(fit));
  ExpectAllRefused({{"plot", model, kSource, "--trace=" + fit + "/trace.csv", "--out=OUT"},
                    {"info", kSource, "--out=OUT"},
                    {"view", model, kSource, "--out=OUT/page.html"},
                    {"score", model, kSource, "--out=OUT/seen.png"}},
                   folder / "out");
  const std::string many = folder / "many", page = many + "/index.html";
  Succeed(Fit(many, {"synth:rubber@12x12x24"}));
  Succeed({"view", many});
  std::ofstream(page) << "mine";
  ExpectRefusal({"view", many}, page, many);
  Succeed({"view", many, "--force"});
  EXPECT_THAT(Contents(page), HasSubstr("content=\"trilobe fit\""));
}

TEST(OwnFiles, OfConvertedModels) {
  const TemporaryFolder folder;
  const std::string model = folder / "fit/model.json", at = folder / "felt.csv";
  Succeed(Fit(folder / "fit"));
  Succeed({"synth", "felt@6x12", "--out=" + at});
  ExpectAllRefused({{"convert", model, "--out=OUT/felt.bsdf", "--error=0.05"},
                    {"convert", model, "--out=OUT/felt.xml"},
                    {"convert", model, "--out=OUT/felt.xompt"},
                    {"convert", model, "--out=OUT/felt.glsl"},
                    {"convert", model, "--out=OUT/felt.mtlx", "--picture"},
                    {"convert", model, "--at=" + at, "--out=OUT/at.csv"}},
                   folder / "out");
}

TEST(OwnFiles, OfMeasurements) {
  const TemporaryFolder folder;
  ExpectAllRefused({{"convert", kSource, "--out=OUT/felt.csv"},
                    {"synth", "felt", "--out=OUT/felt.binary"},
                    {"synth", "linen", "--out=OUT/linen.bin"},
                    {"synth", "felt@6x12", "--out=OUT/felt.csv"}},
                   folder / "out");
}

// A MERL file cannot say whose it is: it stays, unless it would be the same. Where a report has its
// checksum, it is known all the same.
TEST(OwnFiles, OfFormatsWithoutAMark) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", table = out + "/reconstruction.binary",
                    copy = folder / "copy.binary";
  Succeed(Fit(out, {"--reconstruction"}));
  Succeed({"convert", table, "--out=" + copy});
  Succeed({"convert", table, "--out=" + copy});
  const std::string before = Contents(copy);
  const ProgramResult refused = RunProgram({"synth", "felt", "--out=" + copy});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("' exists, and cannot say who wrote it, and would become "));
  EXPECT_TRUE(Contents(copy) == before);
  Succeed({"synth", "felt", "--force", "--out=" + copy});
  EXPECT_FALSE(Contents(copy) == before);
  Succeed({"synth", "felt", "--force", "--out=" + table});
  const std::string mine = Contents(table);
  const ProgramResult in_the_way = RunProgram(Fit(out));
  EXPECT_EQ(in_the_way.status, 1);
  EXPECT_THAT(in_the_way.err, HasSubstr(table));
  EXPECT_TRUE(Contents(table) == mine);
  Succeed(Fit(out, {"--force"}));
  EXPECT_FALSE(fs::exists(table));

  // A run that was cut off before its report has left the checksum.
  Succeed(Fit(out, {"--reconstruction"}));
  const nlohmann::json report = nlohmann::json::parse(Contents(out + "/report.json"));
  const nlohmann::json unfinished = {{"format", report["format"]},
                                     {"unfinished", true},
                                     {"run", report["run"]},
                                     {"checksums", report["checksums"]}};
  std::ofstream(out + "/report.json") << unfinished;
  Succeed(Fit(out, {"--reconstruction"}));
}

// Earlier versions wrote no marks into pictures, and no checksums.
TEST(OwnFiles, OfEarlierVersions) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  Succeed(Fit(out, {"--plots", "--reconstruction"}));
  const std::string mark = std::string("\0\0\0\x10tEXtSoftware\0Trilobe", 24);
  for (const auto& entry : fs::directory_iterator(out)) {
    if (entry.path().extension() != ".png") continue;
    std::string png = Contents(entry.path().string());
    const size_t at = png.find(mark);
    ASSERT_NE(at, std::string::npos);
    png.erase(at, mark.size() + 4);
    std::ofstream(entry.path()) << png;
  }
  auto report = nlohmann::ordered_json::parse(Contents(out + "/report.json"));
  report.erase("format");
  report.erase("checksums");
  std::ofstream(out + "/report.json") << report;
  const std::string picture = Contents(out + "/factors.png");
  std::ofstream(out + "/factors.png") << "mine";
  ExpectRefusal(Fit(out), out + "/factors.png", out);
  std::ofstream(out + "/factors.png") << picture;
  Succeed(Fit(out));
}

TEST(OwnFiles, AnEmptyFileIsNobodys) {
  const TemporaryFolder folder;
  const std::string file = folder / "felt.binary";
  std::ofstream{file};
  Succeed({"synth", "felt", "--out=" + file});
  EXPECT_GT(fs::file_size(file), 30e6);
}

// A link leads to whose content it is.
TEST(OwnFiles, ThroughLinks) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", mine = folder / "mine.html";
  fs::create_directory(out);
  std::ofstream(mine) << "mine";
  fs::create_symlink(mine, out + "/view.html");
  ExpectRefusal(Fit(out), out + "/view.html", out);
  EXPECT_EQ(Contents(mine), "mine");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
