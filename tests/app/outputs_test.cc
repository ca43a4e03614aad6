// Files that commands leave on the disk: one result per folder, and unchanged inputs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/formats/databases/merl_file.h"
#include "tests/app/run_on_terminal.h"
#include "tests/app/run_program.h"
#include "tests/paths.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

nlohmann::json Json(const std::string& path) { return nlohmann::json::parse(Contents(path)); }

std::vector<std::string> Quick(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--solver=awls", "--max_iterations=1", "--lobes=1",
                                     "--max_angle=30", "--nodiagnose"});
  return arguments;
}

std::vector<std::string> Names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  return names;
}

void ExpectRefusal(const ProgramResult& result, const std::string& part) {
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr(part));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
}

TEST(FitFolder, HoldsTheFilesOfOneRun) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(RunProgram(Quick({"fit", "synth:felt@30x30x60", "--plots", "--reconstruction",
                              "--convergence", "--out=" + out}))
                .status,
            0);
  EXPECT_THAT(Names(out),
              UnorderedElementsAre("model.json", "trace.csv", "report.json", "convergence.csv",
                                   "reconstruction.binary", "factors.png", "slices.png",
                                   "spheres.png", "trace.png", "view.html"));
  // The reconstruction has MERL's bins, though the fit had others.
  const BrdfTable table = ReadMerl(out + "/reconstruction.binary");
  const int bin = table.grid.Index(10, 20, 90);
  const double expected =
      Evaluate(ReadModel(out + "/model.json").model, ToDirections(table.grid.Center(bin)))[1];
  EXPECT_NEAR(table.Value(1, bin), expected, 1e-9 * expected);
  const nlohmann::json first = Json(out + "/report.json");
  EXPECT_EQ(first["files"].size(), 10U);
  EXPECT_EQ(ReadModel(out + "/model.json").fit.run, first["run"]);

  std::ofstream(out + "/notes.txt") << "mine";
  ASSERT_EQ(RunProgram(Quick({"fit", "synth:rubber@30x30x60", "--out=" + out})).status, 0);
  EXPECT_THAT(Names(out), UnorderedElementsAre("model.json", "model.previous.json", "trace.csv",
                                               "report.json", "notes.txt"));
  const nlohmann::json second = Json(out + "/report.json");
  EXPECT_EQ(second["files"], nlohmann::json({"model.json", "trace.csv", "report.json"}));
  EXPECT_EQ(ReadModel(out + "/model.json").fit.run, second["run"]);
  EXPECT_NE(first["run"], second["run"]);
  EXPECT_NE(first["key"], second["key"]);
}

// A fit that fails, or is refused, has not touched what was there.
TEST(FitFolder, KeepsTheEarlierRunUntilThereIsANewModel) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(RunProgram(Quick({"fit", "synth:felt@30x30x60", "--out=" + out})).status, 0);
  const std::string before = Contents(out + "/report.json");
  std::ofstream(folder / "bad.binary") << "no measurement";
  EXPECT_EQ(RunProgram(Quick({"fit", folder / "bad.binary", "--out=" + out})).status, 1);
  std::filesystem::create_directory(out + "/factors.png");
  ExpectRefusal(RunProgram(Quick({"fit", "synth:felt@30x30x60", "--out=" + out})),
                "factors.png': it is a directory");
  EXPECT_EQ(Contents(out + "/report.json"), before);
}

// RunProgram lets a fit draw none; flags may come before the command.
TEST(FitFolder, HasPicturesUnlessAskedForNone) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::vector<std::string> command = Quick({"--out=" + out, "fit", "synth:felt@30x30x60"});
  const ProgramResult without = RunProgram(command, {"PATH=/nowhere"});
  EXPECT_EQ(without.status, 0) << without.err;
  EXPECT_THAT(without.err, HasSubstr("no pictures, as gnuplot is not installed"));
  EXPECT_THAT(Names(out),
              UnorderedElementsAre("model.json", "trace.csv", "report.json", "view.html"));
  ASSERT_EQ(RunProgram(command).status, 0);
  EXPECT_THAT(Names(out),
              UnorderedElementsAre("model.json", "trace.csv", "report.json", "factors.png",
                                   "slices.png", "spheres.png", "trace.png", "view.html"));
}

TEST(FitFolder, WithoutGnuplotAllButThePicturesIsThere) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const ProgramResult result = RunProgram(
      Quick({"fit", "synth:felt@30x30x60", "--plots", "--out=" + out}), {"PATH=/nowhere"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err,
            "trilobe: pictures are missing: pictures need gnuplot, which is not on the PATH; "
            "install the package gnuplot-nox\n");
  EXPECT_THAT(Names(out),
              UnorderedElementsAre("model.json", "trace.csv", "report.json", "view.html"));
  EXPECT_EQ(Json(out + "/report.json")["run"], ReadModel(out + "/model.json").fit.run);
}

// Somebody removes the folder while the program draws into it.
TEST(FitFolder, ThatHasGoneCostsNoModel) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", tools = folder / "tools", elsewhere = folder / "tmp";
  std::filesystem::create_directory(tools);
  std::filesystem::create_directory(elsewhere);
  std::ofstream(tools + "/gnuplot") << "#!/bin/sh\nrm -rf '" << out << "'\nexit 1\n";
  std::filesystem::permissions(tools + "/gnuplot", std::filesystem::perms::owner_all);
  const ProgramResult result =
      RunProgram(Quick({"fit", "synth:felt@30x30x60", "--plots", "--out=" + out}),
                 {"PATH=" + tools + ":/usr/bin:/bin", "TMPDIR=" + elsewhere});
  ExpectRefusal(result, "cannot write '" + out + "/report.json'");
  ASSERT_THAT(Names(elsewhere), ::testing::SizeIs(1));
  const std::string saved = elsewhere + "/" + Names(elsewhere)[0];
  EXPECT_THAT(result.err, HasSubstr("; the model is saved as '" + saved + "' instead"));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("the model is in")));
  EXPECT_EQ(ReadModel(saved).fit.source, "synth:felt@30x30x60");

  const ProgramResult many =
      RunProgram(Quick({"fit", "synth:felt@30x30x60", "--shard=1/1", "--plots", "--out=" + out}),
                 {"PATH=" + tools + ":/usr/bin:/bin", "TMPDIR=" + elsewhere});
  EXPECT_EQ(many.status, 3);
  EXPECT_THAT(many.out, HasSubstr("; the model is saved as '" + elsewhere));
  EXPECT_THAT(Names(elsewhere), ::testing::SizeIs(2));
}

TEST(Outputs, AreNeverInputs) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", model = out + "/model.json";
  ASSERT_EQ(
      RunProgram(Quick({"fit", "synth:felt@30x30x60", "--reconstruction", "--out=" + out})).status,
      0);
  const std::string table = out + "/reconstruction.binary";
  std::filesystem::create_symlink(model, folder / "link");
  std::filesystem::create_hard_link(model, folder / "hard");
  std::filesystem::create_directory_symlink(out, folder / "linked");
  const std::string model_before = Contents(model), table_before = Contents(table);
  const std::vector<std::vector<std::string>> commands = {
      {"fit", table, "--out=" + out},
      {"fit", table, "--reconstruction", "--out=" + out + "/../out/."},
      {"fit", table, "--out=" + (folder / "linked")},
      {"fit", table, "synth:felt@30x30x60", "--out=" + (folder / "")},
      {"fit", "synth:felt@30x30x60", "--init=" + model, "--out=" + out},
      {"fit", "synth:felt@30x30x60", "--init=" + (folder / "hard"), "--out=" + out},
      {"convert", model, "--out=" + (folder / "link")},
      {"convert", table, "--out=" + table},
      {"score", model, "synth:felt@30x30x60", "--out=" + (folder / "hard")},
  };
  std::filesystem::create_directory(folder / "reconstruction");
  std::filesystem::create_symlink(table, folder / "reconstruction/pair.png");
  for (const std::vector<std::string>& command : commands) {
    const ProgramResult result = RunProgram(command);
    SCOPED_TRACE(command[0] + " " + command.back());
    ExpectRefusal(result, "would destroy '");
    EXPECT_EQ(Contents(model), model_before);
    EXPECT_EQ(Contents(table), table_before);
  }
}

TEST(Outputs, APictureOfAMeasurementDoesNotReplaceIt) {
  const TemporaryFolder folder;
  const std::string file = folder / "measured.png";
  ASSERT_EQ(RunProgram({"synth", "felt", "--out=" + (folder / "felt")}).status, 0);
  std::filesystem::rename(folder / "felt", file);
  std::filesystem::create_symlink(file, folder / "link");
  for (const std::string& source : {file, folder / "link"}) {
    ExpectRefusal(RunProgram({"info", source, "--out=" + (folder / "")}), "would destroy '");
  }
  EXPECT_GT(std::filesystem::file_size(file), 30e6);
}

TEST(Outputs, AreCheckedBeforeTheWork) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "model.json");
  std::filesystem::create_symlink("nothing", folder / "trace.csv");
  const std::vector<std::string> endless = {"fit", "synth:felt@30x30x60",
                                            "--max_iterations=1000000", "--tolerance=0"};
  for (const std::string& out : {folder / "", std::string("/proc/nowhere")}) {
    std::vector<std::string> command = endless;
    command.push_back("--out=" + out);
    EXPECT_EQ(RunProgram(command).status, 1);  // it would never come back
  }
}

// The first signal ends the work and the next one would end the program, but for the model.
TEST(Interrupt, TwiceKeepsTheModel) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const TerminalResult result =
      RunOnTerminal({"fit", "synth:felt@30x30x60", "--solver=awls", "--max_iterations=1000000",
                     "--tolerance=0", "--plots", "--out=" + out},
                    "iteration 2", SIGINT, /*times=*/2);
  // A shell reports an end by SIGINT as 130, too.
  EXPECT_TRUE(result.status == -1 || result.status == 130) << result.text;
  EXPECT_EQ(ReadModel(out + "/model.json").fit.stop_reason, "interrupted");
  for (const std::string& name : Names(out)) EXPECT_FALSE(name.starts_with('.')) << name;
}

// An iteration of this solver takes longer than the three need to come.
TEST(Interrupt, ThriceEndsTheProgramWhateverItDoes) {
  const TemporaryFolder folder;
  const TerminalResult result =
      RunOnTerminal({"fit", "synth:felt", "--solver=awls_literal", "--max_iterations=1000000",
                     "--tolerance=0", "--out=" + (folder / "out")},
                    "iteration 0", SIGINT, /*times=*/3);
  EXPECT_EQ(result.status, -1) << result.text;
  EXPECT_THAT(result.text, HasSubstr("stopping: the best so far is kept"));
  EXPECT_THAT(result.text, HasSubstr("a third Ctrl-C ends at once"));
}

TEST(FitMany, FitsEachIntoItsFolderAndGathersThem) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", data = folder / "data";
  std::filesystem::create_directory(data);
  ASSERT_EQ(RunProgram({"synth", "copper", "--out=" + data + "/a & b.binary"}).status, 0);
  std::ofstream(data + "/torn.binary") << "no measurement";
  std::ofstream(data + "/notes.txt") << "no measurement, by its name";
  std::ofstream(data + "/coating.txt") << "Made by TracePro\nVersion 7.0\n";
  std::ofstream(data + "/photo.jpg") << "\xFF\xD8\xFF\xE0 JFIF";
  std::ofstream(data + "/empty.dat");
  std::ofstream(data + "/meta.json") << R"({"operator": "me"})";
  std::ofstream(data + "/.hidden") << "nothing to say of it";
  const std::vector<std::string> command =
      Quick({"fit", data, "synth:felt@30x30x60", "--threads=2", "--out=" + out});
  const ProgramResult result = RunProgram(command);
  EXPECT_EQ(result.status, 3);                             // one failed
  const std::string skipped = "trilobe: skipped " + data;  // why, and no list of formats each time
  EXPECT_EQ(result.err,
            skipped +
                "/coating.txt: this is a TracePro file, whose format is not "
                "public; save it as CSV, with the header "
                "theta_i,phi_i,theta_o,phi_o,r,g,b\n" +
                skipped + "/empty.dat: the file is empty\n" + skipped +
                "/meta.json: this is a JSON file, with no columns theta_i, theta_o and "
                "brdf; save its samples as CSV, with the header "
                "theta_i,phi_i,theta_o,phi_o,r,g,b\n" +
                skipped +
                "/notes.txt: this is text, with no line of names of columns, or of numbers; save "
                "its samples as CSV, with the header theta_i,phi_i,theta_o,phi_o,r,g,b\n" +
                skipped + "/photo.jpg: this is a JPEG picture\n");
  EXPECT_THAT(result.out, HasSubstr("] torn: failed: "));
  EXPECT_THAT(result.out, HasSubstr("] felt: fitted, "));
  EXPECT_THAT(result.out, HasSubstr("1 failed\n"));
  EXPECT_THAT(Names(out), UnorderedElementsAre("a & b", "felt", "fits.csv", "index.html"));
  for (const char* const name : {"a & b", "felt"}) {
    EXPECT_THAT(Names(out + "/" + name),
                UnorderedElementsAre("model.json", "trace.csv", "report.json", "pair.png"));
  }
  const std::string table = Contents(out + "/fits.csv"), page = Contents(out + "/index.html");
  EXPECT_EQ(std::ranges::count(table, '\n'), 4);
  EXPECT_THAT(table, HasSubstr("\nfelt,synth:felt@30x30x60,fitted,"));
  EXPECT_THAT(table, HasSubstr("\ntorn,torn.binary,failed,,,,,,,,"));
  EXPECT_THAT(page, HasSubstr("<h1>2 of 3 measurements in pictures</h1>"));
  EXPECT_THAT(page, HasSubstr("src=\"a%20%26%20b/pair.png\""));
  EXPECT_THAT(page, HasSubstr("<b>a &amp; b</b>"));
  const std::string words = Json(out + "/felt/report.json")["verdict"]["words"];
  EXPECT_THAT(result.out, HasSubstr("] felt: fitted, " + words + ", sphere "));
  EXPECT_THAT(table, HasSubstr("\nfelt,synth:felt@30x30x60,fitted,\"" + words + "\","));
  EXPECT_THAT(page, HasSubstr("<b>felt</b><span class=\"unknown\">" + words + "</span><br>PSNR "));
  EXPECT_THAT(result.out, HasSubstr(" of 2 cannot be told apart; sphere "));

  // A thread more or less, and alone or with others: the same model.
  ASSERT_EQ(RunProgram(Quick({"fit", "synth:felt@30x30x60", "--out=" + (folder / "alone")})).status,
            0);
  EXPECT_THAT(
      ReadModel(out + "/felt/model.json").model.parameters(),
      ::testing::ElementsAreArray(ReadModel(folder / "alone/model.json").model.parameters()));

  // The same again keeps what is there; other data or missing files make it anew.
  const std::string felt = Contents(out + "/felt/report.json");
  const ProgramResult again = RunProgram(command);
  EXPECT_THAT(again.out, HasSubstr("] felt: kept, "));
  EXPECT_THAT(again.out, HasSubstr("] a & b: kept, "));
  EXPECT_EQ(Contents(out + "/felt/report.json"), felt);
  ASSERT_EQ(
      RunProgram({"synth", "rubber", "--force", "--out=" + (folder / "data/a & b.binary")}).status,
      0);
  std::filesystem::remove(out + "/felt/trace.csv");
  std::vector<std::string> shard = command;  // a & b.binary and synth:felt
  shard.emplace_back("--shard=1/2");
  const std::string page_before = Contents(out + "/index.html");
  const ProgramResult half = RunProgram(shard);
  EXPECT_EQ(half.status, 0) << half.err;
  EXPECT_THAT(half.out, HasSubstr("/2] a & b: fitted"));
  EXPECT_EQ(Contents(out + "/index.html"), page_before);
  const ProgramResult all = RunProgram(command);
  EXPECT_THAT(all.out, HasSubstr("] felt: kept"));
  EXPECT_THAT(all.out, HasSubstr("] a & b: kept"));
}

TEST(FitMany, WhatIsNotWholeIsFittedAgain) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  // A fit by itself has no thumbnail, which a page needs.
  ASSERT_EQ(RunProgram(Quick({"fit", "synth:felt@30x30x60", "--out=" + out + "/felt"})).status, 0);
  const std::vector<std::string> command =
      Quick({"fit", "synth:felt@30x30x60", "--shard=1/1", "--plots", "--out=" + out});
  const ProgramResult without = RunProgram(command, {"PATH=/nowhere"});
  EXPECT_EQ(without.status, 0);
  EXPECT_THAT(without.out, HasSubstr("felt: fitted"));
  EXPECT_THAT(without.err, StartsWith("trilobe: pictures of felt are missing: pictures need"));
  EXPECT_EQ(std::ranges::count(without.err, '\n'), 1) << without.err;
  EXPECT_TRUE(std::filesystem::exists(out + "/felt/pair.png"));
  const ProgramResult with = RunProgram(command);
  EXPECT_EQ(with.status, 0);
  EXPECT_THAT(with.out, HasSubstr("felt: fitted"));
  EXPECT_THAT(RunProgram(command).out, HasSubstr("felt: kept"));
}

// A folder may hold measurements and their fits, and be given again.
TEST(FitMany, FitsAFolderIntoItself) {
  const TemporaryFolder folder;
  std::ofstream(folder / "few.CSV") << "theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,20,180,1,1,1\n"
                                       "20,0,20,180,1,1,1\n30,0,10,90,1,1,1\n";
  const std::vector<std::string> command = Quick({"fit", folder / "", "--out=" + (folder / "")});
  EXPECT_THAT(RunProgram(command).out, HasSubstr("[1/1] few: fitted"));
  EXPECT_THAT(RunProgram(command).out, HasSubstr("[1/1] few: kept"));
  // Another build of the same version may fit otherwise.
  const std::string program = folder / "program";
  std::filesystem::copy(Program(), program);
  EXPECT_THAT(RunProgram(command, {}, program).out, HasSubstr("[1/1] few: kept"));
  std::ofstream(program, std::ios::app) << "other bytes";
  EXPECT_THAT(RunProgram(command, {}, program).out, HasSubstr("[1/1] few: fitted"));
}

TEST(FitMany, AnInterruptKeepsWhatIsThereAndTheSameCommandGoesOn) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  std::vector<std::string> command = {"fit",
                                      "synth:felt@30x30x60",
                                      "synth:rubber@30x30x60",
                                      "synth:copper@30x30x60",
                                      "--threads=1",
                                      "--solver=awls",
                                      "--max_iterations=3",
                                      "--lobes=1",
                                      "--max_angle=30",
                                      "--out=" + out};
  const TerminalResult result = RunOnTerminal(command, "1 of 3 measurements finished", SIGTERM);
  EXPECT_EQ(result.status, 128 + SIGTERM) << result.text;
  EXPECT_THAT(result.text, HasSubstr("the same command goes on"));
  EXPECT_TRUE(std::filesystem::exists(out + "/felt/report.json"));
  EXPECT_FALSE(std::filesystem::exists(out + "/copper"));
  EXPECT_FALSE(std::filesystem::exists(out + "/rubber/pair.png"));  // for which nobody waits
  EXPECT_THAT(Contents(out + "/fits.csv"), HasSubstr("\ncopper,synth:copper@30x30x60,missing,"));
  const ProgramResult rest = RunProgram(command);
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_THAT(rest.out, HasSubstr("] felt: kept"));
  EXPECT_THAT(rest.out, HasSubstr("] copper: fitted"));
  EXPECT_THAT(rest.out, ::testing::Not(HasSubstr("rubber: kept")));  // it had been cut short
}

// Samples on no grid: the same commands, but for what takes a picture.
TEST(FitScattered, FitsAndScoresACsvFile) {
  const TemporaryFolder folder;
  const std::string csv = folder / "felt.csv", out = folder / "out";
  std::string text = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int i = 5; i < 80; i += 15) {
    for (int o = 5; o < 80; o += 15) {
      for (int phi = 0; phi <= 180; phi += 30) {
        text += std::to_string(i) + ",0," + std::to_string(o) + "," + std::to_string(phi) +
                ",0.02,0.04," + std::to_string(0.06 + 0.0002 * (i + o)) + "\n";
      }
    }
  }
  std::ofstream(csv) << text;
  const ProgramResult fit =
      RunProgram({"fit", csv, "--solver=newton", "--max_iterations=5", "--lobes=1", "--plots",
                  "--reconstruction", "--out=" + out});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, StartsWith("verdict      "));
  EXPECT_THAT(fit.out, HasSubstr(" (Delta E of samples "));
  EXPECT_THAT(Names(out), UnorderedElementsAre("model.json", "trace.csv", "report.json",
                                               "reconstruction.binary", "factors.png", "slices.png",
                                               "spheres.png", "trace.png", "view.html"));
  const nlohmann::json report = Json(out + "/report.json");
  EXPECT_TRUE(report["appearance"].is_null());
  EXPECT_EQ(report["verdict"]["of"], "samples");
  EXPECT_EQ(report["valid_samples"], 175);
  const ProgramResult score = RunProgram({"score", out + "/model.json", csv, "--json"});
  ASSERT_EQ(score.status, 0) << score.err;
  const nlohmann::json scored = nlohmann::json::parse(score.out);
  EXPECT_EQ(scored["objective"], report["objective"]);
  EXPECT_TRUE(scored["appearance"].is_null());
  EXPECT_FALSE(scored["worst_bins"][0].contains("h"));

  ExpectRefusal(RunProgram({"score", out + "/model.json", csv, "--out=" + (folder / "x.png")}),
                "needs a table");
  const ProgramResult many =
      RunProgram({"fit", csv, "synth:copper@30x30x60", "--solver=awls", "--lobes=1",
                  "--max_iterations=1", "--max_angle=30", "--out=" + (folder / "many")});
  EXPECT_EQ(many.status, 0) << many.out << many.err;
}

TEST(FitMany, AFolderOfOddExports) {
  const TemporaryFolder folder;
  std::ofstream(folder / "few.txt") << "# by me\nInc [deg]\tscatter angle [deg]\tBSDF [1/sr]\n"
                                       "10\t20\t1\n20\t-20\t1\n30\t10\t1\n";
  std::ofstream(folder / "notes.txt") << "on these files\n";
  std::ofstream(folder / "table.xlsx") << "PK\3\4";
  const ProgramResult fit = RunProgram(Quick({"fit", folder / "", "--out=" + (folder / "out")}));
  EXPECT_EQ(fit.status, 3);
  EXPECT_THAT(fit.out, HasSubstr("/2] few: fitted"));
  EXPECT_THAT(fit.out + fit.err, HasSubstr("table.xlsx: this is a workbook; save it as CSV"));
  EXPECT_THAT(
      fit.err,
      HasSubstr("notes.txt: this is text, with no line of names of columns, or of numbers; "
                "save its samples as CSV, with the header theta_i,phi_i,theta_o,phi_o,r,g,b\n"));
}

TEST(FitMany, BadUseIsAnError) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "empty");
  ExpectRefusal(RunProgram({"fit", "synth:felt@30x30x60", "synth:rubber@30x30x60"}),
                "needs --out=DIR");
  ExpectRefusal(RunProgram({"fit", "synth:felt@30x30x60", "synth:rubber@30x30x60", "--verbose",
                            "--out=" + (folder / "o")}),
                "--verbose is for the fit of one SOURCE");
  ExpectRefusal(RunProgram({"fit", folder / "empty", "--out=" + (folder / "o")}),
                "has no measurement");
  ExpectRefusal(
      RunProgram({"fit", "synth:felt@30x30x60", "x/felt.binary", "--out=" + (folder / "o")}),
      "'synth:felt@30x30x60' and 'x/felt.binary' would both be fitted into 'felt'");
  for (const char* const shard : {"0/2", "3/2", "1", "1/2x", "-1/-1", "a/b"}) {
    ExpectRefusal(RunProgram({"fit", "synth:felt@30x30x60", "synth:rubber@30x30x60",
                              "--out=" + (folder / "o"), std::string("--shard=") + shard}),
                  "is no i/n");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "o"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
