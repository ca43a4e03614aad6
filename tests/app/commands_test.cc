// Runs the real program as a user would, on good and bad input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/run_program.h"
#include "tests/io/formats/tensor_bytes.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr int kMerlFileSize = 12 + 3 * 8 * 90 * 90 * 180;

// A model that a person can check by hand: albedo pi d, no lobe.
const char kLambertianModel[] = R"({"format": "trilobe-model", "version": 1, "kind": "isotropic",
  "lobes": 0, "d": [0.1, 0.2, 0.3], "s": [], "D": [], "F": [], "G": []})";

void Write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// Bad input ends in status 1 and exactly one line on standard error.
void ExpectError(const ProgramResult& result, const std::string& part) {
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(StartsWith("trilobe: error: "), HasSubstr(part)));
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
}

void ExpectPng(const std::string& path) {
  const std::string bytes = Contents(path);
  EXPECT_THAT(bytes, StartsWith("\x89PNG\r\n")) << path;
  EXPECT_GT(bytes.size(), 10000U) << path;
}

TEST(HelpTest, ListsCommandsAndTheFlagsOfEach) {
  const ProgramResult all = RunProgram({"help"});
  EXPECT_EQ(all.status, 0);
  for (const char* name : {"fit", "solvers", "score", "plot", "info", "convert", "synth"}) {
    EXPECT_THAT(all.out, HasSubstr(std::string("\n  ") + name + " "));
    const ProgramResult one = RunProgram({"help", name});
    EXPECT_EQ(one.status, 0);
    EXPECT_THAT(one.out, HasSubstr(std::string("usage: trilobe ") + name));
    EXPECT_EQ(RunProgram({name, "--help"}).out, one.out);
  }
}

TEST(HelpTest, IsTheSameInEveryPlaceAndNotThatOfGflags) {
  const std::string all = RunProgram({"help"}).out;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{}, {"--help"}, {"-help"}, {"-h"}, {"--help=1"}}) {
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, all);
  }
  const std::string fit = RunProgram({"help", "fit", "--solver=awls_literal"}).out;
  EXPECT_EQ(RunProgram({"fit", "--solver=awls_literal", "--help"}).out, fit);
  EXPECT_EQ(RunProgram({"--help", "fit", "synth:plastic@30x30x60", "--solver=awls_literal"}).out,
            fit);
}

TEST(HelpTest, HasTheRareFlagsWhereTheyAreAskedFor) {
  const std::string some = RunProgram({"help", "fit"}).out;
  EXPECT_THAT(some, HasSubstr("\n  --lobes=3\n"));
  EXPECT_THAT(some, Not(HasSubstr("\n  --dark_noise=")));
  EXPECT_THAT(some, HasSubstr("--dark_noise"));  // its name
  EXPECT_THAT(some, Not(HasSubstr("weightings:")));
  const std::string all = RunProgram({"help", "fit", "--all"}).out;
  EXPECT_EQ(RunProgram({"fit", "--all", "--help"}).out, all);
  EXPECT_THAT(all, HasSubstr("\n  --lobes=3\n"));
  EXPECT_THAT(all, HasSubstr("\n  --dark_noise=false\n"));
  EXPECT_THAT(all, HasSubstr("\nweightings:\n"));
  // Nothing is wider than a page.
  std::istringstream lines(all);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100) << line;
  ExpectError(RunProgram({"fit", "synth:felt", "--all"}), "--all is for `trilobe help COMMAND`");
}

TEST(HelpTest, WritesTheManualOfAllCommands) {
  const ProgramResult page = RunProgram({"help", "--man"});
  EXPECT_EQ(page.status, 0);
  EXPECT_THAT(page.out, StartsWith(".TH TRILOBE 1 "));
  EXPECT_EQ(RunProgram({"--help", "--man"}).out, page.out);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--man"}, {"help", "fit", "--man"}, {"info", "x", "--man"}}) {
    ExpectError(RunProgram(words), "give `trilobe help --man`");
  }
}

TEST(HelpTest, ShowsTheFlagsOfTheSolverGiven) {
  const ProgramResult result = RunProgram({"fit", "--solver=awls_literal", "--help", "--all"});
  EXPECT_EQ(result.status, 0);
  // Its description, its own flags, then those of all solvers; none that only others take.
  EXPECT_THAT(result.out, testing::ContainsRegex("solver awls_literal: .*\n  reference: .*\n"
                                                 "flags of solver awls_literal:\n"
                                                 "  --g_filter=0\n(.*\n)*"
                                                 "flags:\n(.*\n)*"
                                                 "  --max_iterations=100\n(.*\n)*"
                                                 "  --optimality_tolerance=1e-10\n(.*\n)*"
                                                 "  --diagnose=true\n"));
  EXPECT_THAT(result.out, Not(HasSubstr("--memory")));
  const ProgramResult unknown = RunProgram({"fit", "--solver=x", "--help"});
  ExpectError(unknown, "known: auto");
  EXPECT_EQ(unknown.out, "");
}

TEST(SolversTest, ListsTheDefaultFirst) {
  const ProgramResult list = RunProgram({"solvers"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, StartsWith(Solvers().front().name + " (default)\n"));
  size_t at = 0;
  for (const SolverEntry& solver : Solvers()) {
    const size_t found = list.out.find(solver.name, at);
    ASSERT_NE(found, std::string::npos) << solver.name;
    EXPECT_THAT(list.out.substr(found), HasSubstr(solver.reference));
    at = found + solver.name.size();
  }
}

// Every option that a solver reads has a flag.
TEST(SolversTest, DescribesEach) {
  for (const SolverEntry& solver : Solvers()) {
    const ProgramResult one = RunProgram({"solvers", solver.name});
    EXPECT_EQ(one.status, 0) << one.err;
    EXPECT_THAT(one.out, StartsWith("solver " + solver.name + ": "));
    size_t flags = 0;
    for (size_t at = 0; (at = one.out.find("\n  --", at)) != std::string::npos; ++at) ++flags;
    EXPECT_EQ(flags, solver.options.size()) << one.out;
  }
}

TEST(SolversTest, RejectsBadInput) {
  ExpectError(RunProgram({"solvers", "x"}), "known: auto");
  ExpectError(RunProgram({"solvers", "--solver=awls_literal"}), "no flag --solver");
}

TEST(ProgramTest, RejectsWhatItDoesNotKnow) {
  ExpectError(RunProgram({"frobnicate"}), "known: fit, study, solvers, ");
  ExpectError(RunProgram({"help", "frobnicate"}), "known: fit, study, solvers, ");
  ExpectError(RunProgram({"socre"}), "help; did you mean 'score'?");
  ExpectError(RunProgram({"fit", "synth:felt", "--solver=alws"}), "did you mean 'awls'?");
  ExpectError(RunProgram({"info", "synth:cooper"}), "did you mean 'copper'?");
  ExpectError(RunProgram({"info"}), "takes SOURCE|MODEL");
  ExpectError(RunProgram({"info", "a", "b"}), "takes SOURCE|MODEL, but got 2; ");
  ExpectError(RunProgram({"synth", "--weighting=log"}), "no flag --weighting");
  ExpectError(RunProgram({"help", "synth", "--weighting=log"}), "no flag --weighting");
  ExpectError(RunProgram({"synth", "foam", "--out=x", "--threads=-1"}), "--threads is negative");
}

TEST(ProgramTest, SaysWhichFlagWasMeant) {
  ExpectError(RunProgram({"fit", "synth:felt", "--lobs=2"}),
              "trilobe fit has no flag --lobs; did you mean --lobes?");
  ExpectError(RunProgram({"fit", "--lobs", "2", "synth:felt"}), "did you mean --lobes?");
  ExpectError(RunProgram({"fit", "--nodiagnos", "synth:felt"}), "--nodiagnos");
  ExpectError(RunProgram({"help", "fit", "--weighing=log"}), "did you mean --weighting?");
  // Another command's, and one like none.
  for (const char* const flag : {"--weighing=log", "--frobnicate"}) {
    const ProgramResult result = RunProgram({"info", flag, "x"});
    ExpectError(result, "trilobe info has no flag --");
    EXPECT_THAT(result.err, Not(HasSubstr("did you mean")));
  }
}

TEST(ProgramTest, TakesFormerNamesOfFlags) {
  ExpectError(RunProgram({"fit", "synth:plastic", "--max_numbers=0"}),
              "--max_parameters is 0; it must be at least 1");
  ExpectError(RunProgram({"fit", "synth:linen@4x6", "--guide=-1"}), "--prior is -1; it must be");
  ExpectError(RunProgram({"fit", "--scene=x.json", "--out=x", "--course"}),
              "is for the fit of one SOURCE");
}

TEST(ProgramTest, SaysWhatAFlagMayBe) {
  ExpectError(RunProgram({"fit", "synth:felt", "--lobes=x"}), "--lobes=x: give a whole number");
  ExpectError(RunProgram({"fit", "synth:felt", "--lobes=99999999999"}), "to 2147483647");
  ExpectError(RunProgram({"fit", "synth:felt", "--noise=much"}), "--noise=much: give a number");
  ExpectError(RunProgram({"fit", "synth:felt", "--plots=perhaps"}), "give true or false");
  ExpectError(RunProgram({"fit", "synth:felt", "--lobes"}), "--lobes lacks its value");
}

TEST(ProgramTest, TakesAllThatFollowsTwoDashesForWords) {
  EXPECT_EQ(RunProgram({"info", "--", "synth:felt@9x36"}).out,
            RunProgram({"info", "synth:felt@9x36"}).out);
  ExpectError(RunProgram({"info", "--", "--lobs=2"}), "cannot read '--lobs=2'");
}

// "..csv" without its ending is no folder.
TEST(ProgramTest, FitsFilesOfAnyName) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "in");
  for (const char* const name : {"in/..csv", "in/index.html.csv", "in/b.csv"}) {
    RunProgram({"synth", "felt@2x4", "--out=" + (folder / name)});
  }
  const ProgramResult result = RunProgram(
      {"fit", folder / "in", "--lobes=0", "--max_iterations=0", "--out=" + (folder / "out")});
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* const name : {"..csv", "index.html.csv", "b"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / ("out/" + std::string(name) + "/model.json")))
        << name;
  }
}

// Control characters in names neither break the line nor steer the terminal.
TEST(ProgramTest, ShowsNamesInPrintableForm) {
  const TemporaryFolder folder;
  const std::string name = "a\nb\x1b[31m";
  const std::string shown = R"(a\nb\x1b[31m)";
  ExpectError(RunProgram({"info", name}), "cannot read '" + shown + "'");
  ExpectError(RunProgram({"fit", "synth:felt", "--weighting=" + name}), "'" + shown + "'");
  Write(folder / (name + ".csv"), "theta_i,phi_i,theta_o,phi_o,r,g,b\n0,0,10,0,1,1,1\n");
  Write(folder / "scene.json", "{\"a\\nb\\u001b[31m\": 1}");
  ExpectError(RunProgram({"plan", folder / "scene.json"}), shown);
  const ProgramResult info = RunProgram({"info", folder / (name + ".csv")});
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.out, HasSubstr(shown + ".csv\n"));
  const ProgramResult many =
      RunProgram({"fit", folder / (name + ".csv"), "synth:felt@2x4", "--shard=1/2", "--lobes=0",
                  "--max_iterations=0", "--out=" + (folder / name)});
  EXPECT_EQ(many.status, 0) << many.err;
  EXPECT_THAT(many.out,
              AllOf(HasSubstr("] " + shown + ": fitted"), HasSubstr("in " + (folder / shown))));
  for (const ProgramResult& result : {info, many}) {
    EXPECT_EQ((result.out + result.err).find('\x1b'), std::string::npos) << result.out;
  }
}

TEST(InfoTest, OneWavelengthIsNoColour) {
  const TemporaryFolder folder;
  Write(folder / "x.csv", "theta_i,theta_o,phi_o,532nm,633nm\n10,20,180,.25,1\n10,30,180,.5,2\n");
  const std::string one = RunProgram({"info", folder / "x.csv", "--bands=532"}).out;
  EXPECT_THAT(one, HasSubstr("values                    0.25 to 0.5 /sr\n"));
  EXPECT_THAT(one, HasSubstr("532 nm of 2 wavelengths"));
  EXPECT_EQ(one.find("RGB"), std::string::npos) << one;
  ExpectError(RunProgram({"info", folder / "x.csv"}), "--bands=532 takes one alone");
}

TEST(SynthTest, ListsMaterials) {
  const ProgramResult result = RunProgram({"synth"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("plastic "), HasSubstr("chrome "),
                    HasSubstr("satin: long shining threads over dull ones; anisotropic")));
}

TEST(SynthTest, WritesAnisotropicMaterials) {
  const TemporaryFolder folder;
  const ProgramResult result =
      RunProgram({"synth", "velvet", "--out=" + (folder / "velvet.bin"), "--missing=0.1"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(Contents(folder / "velvet.bin").size(), 1990656U);
  const json file = json::parse(RunProgram({"info", folder / "velvet.bin", "--json"}).out);
  const json source =
      json::parse(RunProgram({"info", "synth:velvet", "--missing=0.1", "--json"}).out);
  EXPECT_EQ(file["kind"], "UTIA measurement");
  EXPECT_EQ(file["anisotropy"], source["anisotropy"]);
  EXPECT_EQ(file["samples"]["valid"], source["samples"]["valid"]);
  EXPECT_EQ(file["samples"]["negative"], source["samples"]["missing"]);
  EXPECT_GT(source["samples"]["missing"], 8000);
  EXPECT_EQ(file["phi_i"]["values"], 48);
  EXPECT_EQ(file["notes"], source["notes"]);  // that it is brightest towards the light
  EXPECT_EQ(RunProgram({"synth", "linen@2x4", "--out=" + (folder / "linen.csv")}).status, 0);
  EXPECT_EQ(
      json::parse(RunProgram({"info", folder / "linen.csv", "--json"}).out)["samples"]["valid"],
      64);
  ExpectError(RunProgram({"synth", "velvet", "--out=" + (folder / "x.binary")}),
              "needs a table on the MERL grid");
  ExpectError(RunProgram({"synth", "linen@2x7", "--out=" + (folder / "x.bin")}),
              "is at no node of the grid");
  ExpectError(RunProgram({"synth", "linen@2", "--out=x.csv"}), "'2' is no grid of directions");
  ExpectError(RunProgram({"synth", "linen", "--missing=1", "--out=x.csv"}), "from 0 up to 1");
}

TEST(SynthTest, WritesTheSameFileForTheSameSeed) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    const ProgramResult result =
        RunProgram({"synth", "foam", "--out=" + (folder / name), "--noise=0.05", "--seed=3"});
    EXPECT_EQ(result.status, 0) << result.err;
  }
  const std::string bytes = Contents(folder / "a");
  EXPECT_EQ(bytes.size(), kMerlFileSize);
  EXPECT_TRUE(bytes == Contents(folder / "b"));
}

TEST(SynthTest, RejectsBadInput) {
  ExpectError(RunProgram({"synth", "unobtainium", "--out=x"}), "known: plastic, ");
  ExpectError(RunProgram({"synth", "plastic"}), "needs --out=FILE");
  ExpectError(RunProgram({"synth", "plastic", "--out=x", "--noise=2"}), "must be from 0 to 1");
  ExpectError(RunProgram({"synth", "plastic", "--out=/nonexistent/folder/x"}), "/nonexistent");
}

TEST(ConvertTest, CopiesAMerlFileBitForBit) {
  const TemporaryFolder folder;
  RunProgram({"synth", "felt", "--out=" + (folder / "felt"), "--noise=0.1"});
  const ProgramResult result =
      RunProgram({"convert", folder / "felt", "--out=" + (folder / "copy")});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(Contents(folder / "felt") == Contents(folder / "copy"));
}

// An RGL material of which the innermost and the outermost theta_i, and not all theta_m, were
// measured.
std::string MaskedRgl() {
  TinyRgl file;
  file.theta_i = {0, 1.2F, 1.5707964F};
  file.FillRandom(1);
  file.MaskAll();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(0, row, 3, false);
  return file.Bytes();
}

TEST(ConvertTest, MarksWhatWasNotMeasured) {
  const TemporaryFolder folder;
  Write(folder / "tiny.bsdf", MaskedRgl());
  const auto valid_after = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> words = {"convert", folder / "tiny.bsdf", "--force",
                                      "--out=" + (folder / "merl")};
    words.insert(words.end(), flags.begin(), flags.end());
    EXPECT_EQ(RunProgram(words).status, 0);
    const json bins =
        json::parse(RunProgram({"info", folder / "merl", "--json", "--outliers"}).out)["bins"];
    EXPECT_EQ(bins["valid"].get<int>() + bins["negative"].get<int>(), 1096216);
    return bins["valid"].get<int>();
  };
  const int measured = valid_after({});
  EXPECT_LT(measured, 1096216);
  EXPECT_LT(valid_after({"--max_angle=30"}), measured);
  EXPECT_EQ(valid_after({"--extrapolated"}), 1096216);
}

TEST(ConvertTest, WritesAModelsReconstruction) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  const ProgramResult result =
      RunProgram({"convert", folder / "model.json", "--out=" + (folder / "merl")});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("1096216 of 1458000 bins valid"));
  EXPECT_EQ(Contents(folder / "merl").size(), kMerlFileSize);
  // The model's reconstruction is what the model itself says, to rounding.
  const json score =
      json::parse(RunProgram({"score", folder / "model.json", folder / "merl", "--json"}).out);
  EXPECT_LT(score["relative_objective"], 1e-28);
}

TEST(ConvertTest, WritesModelsForRenderers) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  const std::string file = folder / "model.bsdf";
  const ProgramResult written = RunProgram({"convert", folder / "model.json", "--out=" + file});
  EXPECT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(written.out, HasSubstr("RGL tensor file"));
  // A file that the program reads as it reads measured ones.
  const json info = json::parse(RunProgram({"info", file, "--json"}).out);
  EXPECT_GT(info["bins"]["valid"], 1000000);
  EXPECT_EQ(RunProgram({"convert", folder / "model.json", "--out=" + file, "--spectral"}).status,
            0);
  EXPECT_THAT(RunProgram({"info", file}).out, HasSubstr("RGL measurement"));
  const ProgramResult measured =
      RunProgram({"convert", "synth:felt@30x30x60", "--noise=0.1", "--out=" + file});
  EXPECT_EQ(measured.status, 0) << measured.err;
  EXPECT_THAT(measured.out, ContainsRegex("fitted synth:felt@30x30x60 by .* parameters, in .* s"));
  EXPECT_THAT(measured.out, ContainsRegex("RGB, .* MB, off the measurement by .* %"));
  ExpectError(RunProgram({"convert", folder / "model.json", "--out=" + file, "--noise=0.1"}),
              "--noise");
  ExpectError(RunProgram({"convert", folder / "model.json", "--out=" + file, "--error=2"}),
              "--error must be from 0 to 1");
  ExpectError(
      RunProgram({"convert", folder / "model.json", "--out=" + (folder / "x.csv"), "--error=0.1"}),
      "ends in .bsdf");
  ExpectError(RunProgram({"convert", "synth:felt", "--out=" + (folder / "x.csv"), "--spectral"}),
              "--spectral goes with an --out that ends in .bsdf");
  for (const std::string& source : {std::string("synth:felt"), folder / "model.json"}) {
    const ProgramResult result =
        RunProgram({"convert", source, "--out=" + (folder / "no/way.bsdf")});
    ExpectError(result, "way.bsdf': there is no folder '");
    EXPECT_EQ(result.out, "");
  }
}

TEST(ConvertTest, WritesStandardMaterials) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  std::vector<std::string> words = {"convert", folder / "model.json",
                                    "--out=" + (folder / "x.mtlx")};
  if (!kSanitized) words.push_back("--picture");
  const ProgramResult mtlx = RunProgram(words);
  EXPECT_EQ(mtlx.status, 0) << mtlx.err;
  EXPECT_THAT(mtlx.out, ContainsRegex("open_pbr_surface, beside it on a sphere Delta E is .*; lost "
                                      "against the model: nothing to be seen"));
  EXPECT_THAT(Contents(folder / "x.mtlx"), HasSubstr("<surfacematerial name=\"x\""));
  EXPECT_THAT(Contents(folder / "x.mtlx"), HasSubstr("lost against the model: nothing to be seen"));
  if (!kSanitized) {
    EXPECT_THAT(Contents(folder / "x.png"), testing::StartsWith("\x89PNG"));
  }
  // A measurement is fitted first. Plastic becomes a dielectric; for a matt material `Metallic` may
  // be 0.5, since nothing of it glitters.
  const ProgramResult blender =
      RunProgram({"convert", "synth:plastic@20x20x40", "--out=" + (folder / "x.principled.json")});
  EXPECT_EQ(blender.status, 0) << blender.err;
  EXPECT_THAT(blender.out, ContainsRegex("fitted synth:plastic.*\nwrote .*Principled BSDF"));
  const json principled = json::parse(Contents(folder / "x.principled.json"));
  EXPECT_LT(principled["inputs"]["Metallic"], 0.2);
  const ProgramResult engine =
      RunProgram({"convert", "synth:plastic@20x20x40", "--out=" + (folder / "x.gltf")});
  EXPECT_EQ(engine.status, 0) << engine.err;
  EXPECT_THAT(engine.out,
              ContainsRegex("wrote .*metallic 0.*, roughness .*, base colour .*, PSNR"));
  const json gltf = json::parse(Contents(folder / "x.gltf"));
  EXPECT_EQ(gltf["materials"][0]["name"], "x");

  ExpectError(RunProgram({"convert", folder / "none.json", "--out=" + (folder / "y.mtlx")}),
              "cannot read '" + (folder / "none.json") + "'");
  ExpectError(RunProgram({"convert", "synth:none", "--out=" + (folder / "y.glsl")}),
              "unknown synthetic material 'none'");
  ExpectError(RunProgram({"convert", folder / "model.json", "--out=" + (folder / "y.json")}),
              "y.json: trilobe writes no '.json'");
  ExpectError(RunProgram({"convert", folder / "model.json", "--out=" + (folder / "no/y.mtlx")}),
              "there is no folder '");
  ExpectError(
      RunProgram({"convert", folder / "model.json", "--out=" + (folder / "y.bsdf"), "--picture"}),
      "--picture goes with an --out that ends in .mtlx, .principled.json, .gltf or .usda");
  ExpectError(
      RunProgram({"convert", folder / "model.json", "--out=" + (folder / "y.mtlx"), "--error=0.1"}),
      "--error goes with an --out that ends in .bsdf");
}

// JSON that is a measurement is none of the model files, however long what it says of itself is.
TEST(InfoTest, ATableInJsonIsAMeasurement) {
  const TemporaryFolder folder;
  Write(folder / "x.xompt", R"({"metadata": {"description": ")" + std::string(300, 'x') +
                                R"("}, "brdf": {"lookupTable": [[9e-7, 0.1, 0.2, 0, 0.3]]}})");
  const ProgramResult result = RunProgram({"info", folder / "x.xompt"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("OpenMATERIAL 3D table of scattered samples"));
}

TEST(ConvertTest, WritesFilesOfOpticalDesign) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  const auto convert = [&](const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"convert", folder / "model.json", "--out=" + (folder / out)};
    words.insert(words.end(), more.begin(), more.end());
    return RunProgram(words);
  };
  const ProgramResult zemax = convert("x.zemax.bsdf");
  EXPECT_EQ(zemax.status, 0) << zemax.err;
  EXPECT_THAT(zemax.out,
              ContainsRegex("Zemax BSDF of 11 incidences, 19 x 41 directions, .* MB, off "
                            "the model by .* in the median"));
  const ProgramResult klems = convert("x.xml");
  EXPECT_EQ(klems.status, 0) << klems.err;
  EXPECT_THAT(klems.out, ContainsRegex("pairs of patches of the full Klems basis, .* MB, off the "
                                       "model by"));
  const ProgramResult open_material = convert("x.xompt");
  EXPECT_EQ(open_material.status, 0) << open_material.err;
  EXPECT_THAT(
      open_material.out,
      ContainsRegex("OpenMATERIAL 3D table of 10 incidences, 19 x 24 directions, .* MB, off "
                    "the model by"));
  for (const std::string name : {"x.zemax.bsdf", "x.xml", "x.xompt"}) {
    EXPECT_EQ(RunProgram({"info", folder / name}).status, 0) << name;
  }
  const ProgramResult measured = RunProgram(
      {"convert", "synth:plastic@20x20x40", "--out=" + (folder / "y.zemax.bsdf"), "--error=0.5"});
  EXPECT_THAT(measured.out,
              ContainsRegex("fitted synth:plastic.*\nwrote .*off the measurement by"));
  ExpectError(convert("y.xml", {"--error=0.1"}), "--error goes with an --out that ends in .bsdf");
  ExpectError(convert("y.zemax.bsdf", {"--spectral"}),
              "--spectral goes with an --out that ends in .bsdf, but not in .zemax.bsdf");
}

// `info` and `convert` treat scattered samples alike in every format.
const char kCsv[] =
    "theta_i,phi_i,theta_o,phi_o,r,g,b\n# a comment\n"
    "10,0,70,0,1,2,3\n70,0,10,0,1,2,3.3\n10,0,20,0,4,5,6\n10,0,20,0,-1,5,6\n";

TEST(ConvertTest, WritesSamplesAsCsv) {
  const TemporaryFolder folder;
  const std::string felt = folder / "felt.csv", copy = folder / "copy.csv";
  const ProgramResult result =
      RunProgram({"convert", "synth:felt@30x30x60", "--max_angle=20", "--out=" + felt});
  EXPECT_EQ(result.status, 0) << result.err;
  const json table =
      json::parse(RunProgram({"info", "synth:felt@30x30x60", "--max_angle=20", "--json"}).out);
  const std::string valid = std::to_string(table["bins"]["valid"].get<int>());
  EXPECT_EQ(result.out, "wrote " + felt + ": CSV, " + valid + " samples\n");
  EXPECT_THAT(Contents(felt), StartsWith("# BRDF [1/sr] of " + valid + " pairs"));
  const json read = json::parse(RunProgram({"info", felt, "--json"}).out);
  EXPECT_EQ(read["bins"]["valid"], table["bins"]["valid"]);
  EXPECT_EQ(read["min"], table["min"]);
  EXPECT_EQ(read["max"], table["max"]);
  // CSV is converted to CSV, all of it or a part.
  EXPECT_EQ(RunProgram({"convert", felt, "--out=" + copy}).status, 0);
  json again = json::parse(RunProgram({"info", copy, "--json"}).out);
  EXPECT_EQ(again["bins"], read["bins"]);
  EXPECT_EQ(again["exchange_error"], read["exchange_error"]);
  EXPECT_EQ(RunProgram({"convert", felt, "--out=" + copy, "--max_angle=10"}).status, 0);
  again = json::parse(RunProgram({"info", copy, "--json"}).out);
  EXPECT_LT(again["bins"]["valid"], read["bins"]["valid"]);
  // A model is converted to CSV, too.
  Write(folder / "model.json", kLambertianModel);
  const ProgramResult model = RunProgram(
      {"convert", folder / "model.json", "--max_angle=5", "--out=" + (folder / "model.CSV")});
  EXPECT_EQ(model.status, 0) << model.err;
  const json lambertian = json::parse(RunProgram({"info", folder / "model.CSV", "--json"}).out);
  EXPECT_NEAR(lambertian["max"][2].get<double>(), 0.3, 1e-12);
}

TEST(ConvertTest, OfScatteredSamplesATableIsThatOfAModel) {
  const TemporaryFolder folder;
  const std::string satin = InRepository("docs/goniometer.csv"), table = folder / "y.binary";
  const ProgramResult made = RunProgram({"convert", satin, "--out=" + table});
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("all values of the table are the model's"));
  EXPECT_EQ(RunProgram({"fit", satin, "--noplots", "--out=" + (folder / "fit")}).status, 0);
  const ProgramResult score = RunProgram({"score", folder / "fit/model.json", table, "--json"});
  EXPECT_LT(json::parse(score.out)["relative_objective"], 1e-20) << score.err;
}

TEST(ConvertTest, KeepsScatteredSamples) {
  const TemporaryFolder folder;
  Write(folder / "x.csv", kCsv);
  ExpectError(RunProgram({"convert", folder / "x.csv", "--out=" + (folder / "x.csv")}), "x.csv");
  EXPECT_EQ(Contents(folder / "x.csv"), kCsv);
  ExpectError(RunProgram({"score", folder / "x.csv", "synth:felt@30x30x60"}),
              "give the table first");
}

TEST(ConvertTest, WritesUtiasDirections) {
  const TemporaryFolder folder;
  const std::string velvet = folder / "velvet.bin", copy = folder / "copy.bin";
  RunProgram({"synth", "velvet", "--out=" + velvet, "--noise=0.1", "--missing=0.2"});
  const ProgramResult result = RunProgram({"convert", velvet, "--out=" + copy});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              ContainsRegex("UTIA layout, 66[0-9]* of 82944 pairs of directions valid"));
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(Contents(velvet) == Contents(copy));
  // Through CSV, and back.
  EXPECT_EQ(RunProgram({"convert", velvet, "--out=" + (folder / "velvet.csv")}).status, 0);
  EXPECT_EQ(RunProgram({"convert", folder / "velvet.csv", "--out=" + copy}).status, 0);
  EXPECT_TRUE(Contents(velvet) == Contents(copy));
  // A table is interpolated.
  EXPECT_THAT(
      RunProgram({"convert", "synth:foam@30x30x60", "--max_angle=65", "--force", "--out=" + copy})
          .out,
      HasSubstr("57600 of 82944 pairs"));
  // Numbers in another order are told, and read all the same.
  std::string bytes = Contents(velvet), other = bytes;
  for (int row = 0; row < 3 * 288; ++row) {
    for (int k = 0; k < 288; ++k) {
      std::memcpy(&other[8 * (288 * row + 6 * (k % 48) + k / 48)], &bytes[8 * (288 * row + k)], 8);
    }
  }
  Write(folder / "other.bin", other);
  const ProgramResult told =
      RunProgram({"convert", folder / "other.bin", "--force", "--out=" + copy});
  EXPECT_EQ(told.status, 0);
  EXPECT_THAT(told.err, ContainsRegex("^trilobe: .*other.bin: the numbers look as if .*\n$"));
  EXPECT_THAT(
      RunProgram({"info", folder / "other.bin"}).out,
      ContainsRegex("\nnote +the numbers look as if they stood in another order: outgoing"));
  ExpectError(RunProgram({"convert", velvet, "--out=" + (folder / "x.binary")}),
              "needs a table on the MERL grid, and this is a UTIA measurement");
  ExpectError(RunProgram({"convert", velvet, "--radiometry=x", "--out=" + copy}),
              "known: brdf, cosine, srgb, dj_brdf");
}

TEST(ConvertTest, RejectsBadInput) {
  ExpectError(RunProgram({"convert", "synth:foam@30x30x60"}), "needs --out=FILE");
  const TemporaryFolder folder;
  for (const char* name : {"x.sbsdf", "x.json", "x.png", "x.exr", "x.binary.gz"}) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"convert", "synth:foam@30x30x60"}, {"synth", "foam"}}) {
      std::vector<std::string> arguments = words;
      arguments.push_back("--out=" + (folder / name));
      const ProgramResult result = RunProgram(arguments);
      ExpectError(result, std::string(name) + ": trilobe writes no '");
      EXPECT_THAT(result.err, AllOf(HasSubstr(".binary"), HasSubstr(".bin "), HasSubstr(".csv")));
      EXPECT_FALSE(std::filesystem::exists(folder / name));
    }
  }
  ExpectError(RunProgram({"convert", "nothing.binary", "--out=x"}), "nothing.binary");
  ExpectError(RunProgram({"convert", "synth:unobtainium", "--out=x"}), "known: plastic, ");
}

TEST(ScoreTest, PrintsATableOrOneJsonObject) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  const std::vector<std::string> arguments = {"score", folder / "model.json",
                                              "synth:foam@30x30x60"};
  const ProgramResult brief = RunProgram(arguments);
  EXPECT_EQ(brief.status, 0) << brief.err;
  EXPECT_THAT(brief.out, StartsWith("verdict      plainly visible "));
  EXPECT_THAT(brief.out, Not(HasSubstr("worst bins")));
  std::vector<std::string> verbose = arguments;
  verbose.emplace_back("--verbose");
  const ProgramResult table = RunProgram(verbose);
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, StartsWith(brief.out));
  EXPECT_THAT(table.out, AllOf(HasSubstr("PSNR"), HasSubstr("peak"), HasSubstr("worst bins"),
                               HasSubstr("appearance   sphere in studio: PSNR ")));
  EXPECT_THAT(table.out, Not(ContainsRegex("(^|[^a-z])nan")));  // "luminance" is none

  std::vector<std::string> with_json = arguments;
  with_json.insert(with_json.end(), {"--json", "--weighting=uniform"});
  const json score = json::parse(RunProgram(with_json).out);
  EXPECT_EQ(score["weighting"], "uniform");
  EXPECT_TRUE(score["appearance"]["beyond"].is_null());  // all bins have a value
  EXPECT_EQ(score["valid_samples"], 40644);
  EXPECT_EQ(score["worst_bins"].size(), 10U);
  for (const char* key : {"objective", "relative_objective", "psnr_db", "psnr_peak", "rmse",
                          "mean_relative_error", "mean_log_error"}) {
    EXPECT_TRUE(score[key].is_number()) << key;
  }
  // Uniform weights: E is the sum of squares that RMSE is the root mean of.
  const double mean = score["objective"].get<double>() / (3 * 40644.0);
  EXPECT_NEAR(score["rmse"].get<double>(), std::sqrt(mean), 1e-9 * std::sqrt(mean));
}

TEST(ScoreTest, ComparesTwoMeasurements) {
  const TemporaryFolder folder;
  for (const char* const name : {"foam", "felt"}) {
    RunProgram({"synth", name, "--out=" + (folder / name)});
  }
  const auto score = [&](const char* a, const char* b) {
    const ProgramResult result = RunProgram({"score", folder / a, folder / b, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out);
  };
  const json same = score("foam", "foam");
  EXPECT_LT(same["relative_objective"], 1e-28);
  EXPECT_GT(same["valid_samples"], 1000000);
  EXPECT_TRUE(same["appearance"]["psnr_db"].is_null());  // infinite
  EXPECT_EQ(same["appearance"]["mean_delta_e"], 0);
  EXPECT_EQ(same["appearance"]["at_centers"]["mean_log_error"], 0);
  const json other = score("felt", "foam");
  EXPECT_GT(other["relative_objective"], 1e-3);
  EXPECT_GT(other["appearance"]["mean_delta_e"], 1);
  EXPECT_TRUE(other["appearance"]["psnr_db"].is_number());
}

TEST(ScoreTest, ComparesTwoModelsAndTwoLists) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  const auto score = [&](const std::string& a, const std::string& b) {
    const ProgramResult result = RunProgram({"score", a, b, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(result.out);
  };
  EXPECT_LT(score(folder / "model.json", folder / "model.json")["relative_objective"], 1e-28);
  const json felts = score("material:acrylic_felt_pink", "material:acrylic_felt_green");
  EXPECT_GT(felts["appearance"]["mean_delta_e"], 5);
  EXPECT_LT(score("material:linen", "material:linen")["relative_objective"], 1e-12);
  EXPECT_GT(score("material:acrylic_felt_pink", "material:linen")["relative_objective"], 1e-3);
  // Rows in another order, turned about the normal, and one that the other list lacks.
  Write(folder / "a.csv",
        "theta_i,phi_i,theta_o,phi_o,f\n10,0,20,180,0.2\n10,0,30,90,0.1\n10,0,50,0,0.3\n");
  Write(folder / "b.csv", "theta_i,phi_i,theta_o,phi_o,f\n10,0,30,270,0.1\n10,0,20,-180,0.1\n");
  const json lists = score(folder / "a.csv", folder / "b.csv");
  EXPECT_EQ(lists["valid_samples"], 2);
  EXPECT_NEAR(lists["rmse"], 0.1 / std::sqrt(2), 1e-12);
}

// A mirror direction's value is lost below theta_d = 10 degrees.
TEST(DataNotes, TellOfADetectorInItsOwnLight) {
  const TemporaryFolder folder;
  const std::string csv = folder / "mirror.csv";
  std::ostringstream rows;
  rows << "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int theta = 0; theta < 40; ++theta) {
    const char* const rho = theta < 10 ? "0.01,0.01,0.01" : "1,1,1";
    for (int phi = 0; phi < 360; phi += 30) {
      rows << theta << "," << phi << "," << theta << "," << phi - 180 << "," << rho << "\n";
    }
  }
  Write(csv, rows.str());
  EXPECT_THAT(RunProgram({"score", "synth:foam@30x30x60", csv}).err,
              StartsWith("trilobe: " + csv + ": the highlight is 100 times darker"));
  EXPECT_THAT(RunProgram({"convert", csv, "--out=" + folder / "lit.csv"}).err,
              HasSubstr("120 samples below 10 deg"));
  EXPECT_EQ(RunProgram({"score", "synth:foam@30x30x60", csv, "--min_theta_d=0"}).err, "");

  const auto notes_of = [](const json& from) { return from["data_notes"].dump(); };
  const std::string out = folder / "fit";
  RunProgram({"fit", csv, "--max_iterations=1", "--noplots", "--out=" + out});
  EXPECT_THAT(notes_of(json::parse(Contents(out + "/report.json"))), HasSubstr("below 10 deg"));
  Write(folder / "scene.json", R"({"format": "trilobe-scene", "version": 1, "materials": [
      {"name": "mirror", "source": "mirror.csv", "budget": {"relative_rise": 0}}]})");
  for (const bool again : {false, true}) {  // from the cache, too
    const ProgramResult plan = RunProgram({"plan", folder / "scene.json", "--json",
                                           "--max_iterations=1", "--cache=" + (folder / "cache")});
    ASSERT_EQ(plan.status, 0) << plan.err;
    const json material = json::parse(plan.out)["materials"][0];
    EXPECT_EQ(material["from_cache"]["prune"], again);
    EXPECT_THAT(notes_of(material), HasSubstr("below 10 deg"));
  }
}

// `score` renders under another light, and writes pictures.
TEST(ScoreTest, TakesAProbeAndWritesBothSpheres) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  // Red light from above.
  std::string probe = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (int k = 0; k < 8; ++k) {
    probe += k < 4 ? std::string("\x80\x10\x10\x84", 4) : std::string(4, '\0');
  }
  Write(folder / "red.hdr", probe);
  const std::vector<std::string> arguments = {"score", folder / "model.json",
                                              "synth:foam@30x30x60"};
  std::vector<std::string> lit = arguments;
  lit.insert(lit.end(),
             {"--json", "--probe=" + (folder / "red.hdr"), "--out=" + (folder / "pair.png")});
  const ProgramResult result = RunProgram(lit);
  ASSERT_EQ(result.status, 0) << result.err;
  const json appearance = json::parse(result.out)["appearance"];
  EXPECT_EQ(appearance["environment"], folder / "red.hdr");
  EXPECT_THAT(Contents(folder / "pair.png"), StartsWith("\x89PNG\r\n"));
  std::vector<std::string> by_default = arguments;
  by_default.emplace_back("--json");
  const json studio = json::parse(RunProgram(by_default).out)["appearance"];
  EXPECT_EQ(studio["environment"], "studio");
  EXPECT_NE(studio["psnr_db"], appearance["psnr_db"]);
  EXPECT_EQ(studio["albedo"], appearance["albedo"]);  // which no light changes
}

TEST(ScoreTest, RejectsBadInput) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  ExpectError(RunProgram({"score", "nothing.json", "synth:foam@30x30x60"}), "nothing.json");
  ExpectError(RunProgram({"score", folder / "model.json", "nothing.binary"}), "nothing.binary");
  ExpectError(
      RunProgram({"score", folder / "model.json", "synth:foam@30x30x60", "--weighting=heavy"}),
      "known: appearance, appearance_channel, log_relative, log_relative_channel, "
      "cube_root, percentage, "
      "compressive, log, ");
  ExpectError(
      RunProgram({"score", folder / "model.json", "synth:foam@30x30x60", "--weighting=power:x=1"}),
      "unknown key 'x'");
  ExpectError(
      RunProgram({"score", folder / "model.json", "synth:foam@30x30x60", "--probe=missing"}),
      "missing");
  ExpectError(RunProgram({"score", folder / "model.json", "synth:foam@30x30x60",
                          "--probe=" + (folder / "model.json")}),
              "not a Radiance picture");
  ExpectError(RunProgram({"score", folder / "model.json", folder / "model.json", "--noise=0.1"}),
              "--noise is for measurements");
  Write(folder / "a.csv", "theta_i,phi_i,theta_o,phi_o,f\n10,0,20,180,0.1\n10,0,30,180,0.1\n");
  Write(folder / "b.csv", "theta_i,phi_i,theta_o,phi_o,f\n12,0,20,180,0.1\n12,0,30,180,0.1\n");
  ExpectError(RunProgram({"score", folder / "a.csv", folder / "b.csv"}),
              "no sample has the directions of one in ");
  ExpectError(RunProgram({"score", folder / "a.csv", "synth:foam@30x30x60"}),
              "give the table first");
}

TEST(InfoTest, DescribesAMeasurement) {
  const ProgramResult text = RunProgram({"info", "synth:chrome@30x30x60", "--noise=0.02"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("exchange error"), HasSubstr("directional albedo")));
  EXPECT_THAT(text.out, Not(HasSubstr("nan")));
  const json info = json::parse(RunProgram({"info", "synth:foam@30x30x60", "--json"}).out);
  EXPECT_EQ(info["bins"]["valid"], 40644);
  EXPECT_EQ(info["bins"]["below_surface"], 54000 - 40644);
  EXPECT_LT(info["exchange_error"]["median"], 1e-12);
  EXPECT_TRUE(info["albedo"]["passes_one_deg"]["red"].is_null());
}

TEST(InfoTest, CountsAndDrawsWhatWasNotMeasured) {
  const TemporaryFolder folder;
  Write(folder / "tiny.bsdf", MaskedRgl());
  const auto info = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> words = {"info", folder / "tiny.bsdf", "--json"};
    words.insert(words.end(), flags.begin(), flags.end());
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.status, 0) << result.err;
    json parsed = json::parse(result.out);
    int sum = 0;
    for (const auto& [key, bins] : parsed["bins"].items()) {
      if (key != "total") sum += bins.get<int>();
    }
    EXPECT_EQ(sum, 1458000);
    return parsed;
  };
  const json limited = info({"--max_angle=50", "--out=" + (folder / "pictures")});
  for (const char* reason : {"extrapolated", "beyond_nodes", "beyond_max_angle"}) {
    EXPECT_GT(limited["bins"][reason], 0) << reason;
  }
  EXPECT_EQ(limited["max_angle"], 50);
  EXPECT_EQ(limited["albedo"]["theta_i_deg"].size(), 51U);
  EXPECT_GT(limited["albedo"]["red"][50], 0);
  ExpectPng(folder / "pictures/measured.png");
  const json measured = info({}), whole = info({"--extrapolated"});
  EXPECT_EQ(measured["bins"]["extrapolated"], limited["bins"]["extrapolated"]);
  EXPECT_EQ(whole["bins"]["valid"], 1096216);
  EXPECT_EQ(whole["max_angle"], 90);
  EXPECT_LT(measured["reciprocity_error"]["pairs"], whole["reciprocity_error"]["pairs"]);
  EXPECT_LT(measured["albedo"]["red"][40], whole["albedo"]["red"][40]);
  const std::string text = RunProgram({"info", folder / "tiny.bsdf"}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("measured up to            68.75 deg\n"),
                          HasSubstr("directional albedo of what was measured")));
}

TEST(InfoTest, DescribesAFileWithoutAnyValidBin) {
  const TemporaryFolder folder;
  const int dims[] = {90, 90, 180};
  std::string bytes(kMerlFileSize, '\xff');  // NaN throughout
  std::memcpy(bytes.data(), dims, sizeof dims);
  Write(folder / "lost.binary", bytes);
  const ProgramResult text = RunProgram({"info", folder / "lost.binary"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("NaN or infinite         1096216"), HasSubstr("no pair to compare")));
  const json info = json::parse(RunProgram({"info", folder / "lost.binary", "--json"}).out);
  EXPECT_EQ(info["bins"]["valid"], 0);
  EXPECT_TRUE(info["albedo"].is_null());
}

TEST(InfoTest, DescribesScatteredSamples) {
  const TemporaryFolder folder;
  Write(folder / "x.csv", kCsv);
  const ProgramResult text = RunProgram({"info", folder / "x.csv"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(ContainsRegex("kind +CSV file of scattered samples\n"),
                              ContainsRegex("samples +4\n +valid +3\n +lost .negative. +1\n"),
                              ContainsRegex("theta_i +10 to 70 deg, 2 values\n"),
                              ContainsRegex("reciprocity error +median 0 %,.* 1 pairs\n")));
  const json info = json::parse(RunProgram({"info", folder / "x.csv", "--json"}).out);
  EXPECT_EQ(info["samples"]["total"], 4);
  EXPECT_EQ(info["samples"]["negative"], 1);
  EXPECT_EQ(info["max_angle"], 70);
  EXPECT_NEAR(info["theta_o"]["max"].get<double>(), 70, 1e-9);
  EXPECT_EQ(info["max"], (json{4, 5, 6}));
  EXPECT_EQ(info["reciprocity_error"]["pairs"], 1);
  const json limited =
      json::parse(RunProgram({"info", folder / "x.csv", "--json", "--max_angle=60"}).out);
  EXPECT_EQ(limited["samples"]["beyond_max_angle"], 2);
  EXPECT_TRUE(limited["reciprocity_error"]["median"].is_null());
  EXPECT_THAT(RunProgram({"info", folder / "x.csv", "--out=" + (folder / "p")}).out,
              AllOf(ContainsRegex("reflects at least|written"), HasSubstr("p/measured.png")));
  EXPECT_THAT(Contents(folder / "p/measured.png"), testing::StartsWith("\x89PNG"));
  const ProgramResult none = RunProgram({"info", folder / "x.csv", "--max_angle=5"});
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_THAT(none.out, ContainsRegex("valid +0\n"));
  Write(folder / "bad.csv", std::string(kCsv) + "1,2,3,4,5,6,x\n");
  ExpectError(RunProgram({"info", folder / "bad.csv"}),
              "bad.csv: line 7, column 7 (b): 'x' is no number");
}

TEST(InfoTest, DrawsAllPairsOfAnAnisotropicMeasurement) {
  const TemporaryFolder folder;
  const ProgramResult result =
      RunProgram({"info", "synth:charmeuse", "--missing=0.1", "--out=" + (folder / "p")});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(ContainsRegex("phi_i +0 to 352.5 deg, 48 values\n"),
                                ContainsRegex("anisotropy +[0-9.]+ % of the energy"),
                                ContainsRegex("written +.*/p/measured.png\n")));
  EXPECT_THAT(Contents(folder / "p/measured.png"), testing::StartsWith("\x89PNG"));
  ExpectError(RunProgram({"info", "synth:charmeuse@2x7", "--out=" + (folder / "q")}),
              "is at no node of the grid");
}

TEST(InfoTest, DescribesAModel) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  EXPECT_THAT(RunProgram({"info", folder / "model.json"}).out, HasSubstr("0 lobes, 3 parameters"));
  const json info = json::parse(RunProgram({"info", folder / "model.json", "--json"}).out);
  EXPECT_NEAR(info["albedo"]["blue"][40].get<double>(), 0.3 * 3.14159265, 1e-4);
}

TEST(InfoTest, TellsWhatACompactModelStores) {
  const TemporaryFolder folder;
  Write(folder / "model.json", R"({"format": "trilobe-model", "version": 1, "kind": "isotropic",
    "lobes": 1, "d": [0.1], "s": [[0.2]],
    "sharing": {"D": {"per_lobe": true, "per_channel": false},
                "F": {"per_lobe": false, "per_channel": false},
                "G": {"per_lobe": true, "per_channel": false}},
    "D": [{"size": 90, "nodes": [0, 20, 40], "values": [9, 1, 0]}],
    "F": {"size": 90, "nodes": [0, 89], "values": [1, 2]},
    "G": [{"size": 90, "nodes": [45], "values": [1]}]})");
  EXPECT_THAT(RunProgram({"info", folder / "model.json"}).out,
              AllOf(HasSubstr("8 parameters, and 6 places of nodes"), HasSubstr("3 stored")));
  const json info = json::parse(RunProgram({"info", folder / "model.json", "--json"}).out);
  EXPECT_EQ(info["stored_parameters"], 8);
  EXPECT_EQ(info["tables"]["F"]["stored"], 2);
}

TEST(InfoTest, RejectsBadInput) {
  const TemporaryFolder folder;
  Write(folder / "broken.json", "{\"format\": ");
  Write(folder / "empty", "");
  ExpectError(RunProgram({"info", folder / "nothing"}), "nothing");
  ExpectError(RunProgram({"info", folder / "broken.json"}), "broken.json");
  ExpectError(RunProgram({"info", folder / "empty"}), "empty");
  ExpectError(RunProgram({"info", folder / "."}), "directory");
  ExpectError(RunProgram({"info", "synth:foam@30x30x60", "--max_angle=91"}), "up to 90");
  Write(folder / "model.json", kLambertianModel);
  ExpectError(RunProgram({"info", folder / "model.json", "--out=" + (folder / "p")}), "is a model");
  TinyRgl file;
  file.FillConstant(1, 1, 1);
  file.MaskAll();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(1, row, 0, false);
  Write(folder / "unclear.bsdf", file.Bytes());
  ExpectError(RunProgram({"info", folder / "unclear.bsdf"}), "field 'valid' has 3 ones");
}

TEST(PlotTest, DrawsWhatTheInputsAllow) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  Write(folder / "trace.csv",
        "iteration,seconds,objective,filtered,accepted,step,optimality\n"
        "0,0,10,0,1,0,\n1,0.5,1,0,1,0.25,\n");
  const ProgramResult alone =
      RunProgram({"plot", folder / "model.json", "--out=" + (folder / "alone")});
  EXPECT_EQ(alone.status, 0) << alone.err;
  ExpectPng(folder / "alone/factors.png");
  EXPECT_FALSE(std::filesystem::exists(folder / "alone/slices.png"));
  const ProgramResult all =
      RunProgram({"plot", folder / "model.json", "synth:foam@30x30x60",
                  "--trace=" + (folder / "trace.csv"), "--out=" + (folder / "all")});
  EXPECT_EQ(all.status, 0) << all.err;
  for (const char* name : {"factors.png", "slices.png", "spheres.png", "trace.png"}) {
    ExpectPng(folder / ("all/" + std::string(name)));
  }
}

TEST(PlotTest, SaysWhichPackageIsMissing) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  ExpectError(RunProgram({"plot", folder / "model.json", "--out=" + (folder / "pictures")},
                         {"PATH=" + (folder / "no-programs")}),
              "install the package gnuplot-nox");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "pictures"));
}

TEST(PlotTest, RejectsBadInput) {
  const TemporaryFolder folder;
  Write(folder / "model.json", kLambertianModel);
  ExpectError(RunProgram({"plot", folder / "model.json"}), "needs --out=DIR");
  ExpectError(RunProgram({"plot", "nothing.json", "--out=" + (folder / "p")}), "nothing.json");
  ExpectError(
      RunProgram({"plot", folder / "model.json", "--trace=nothing.csv", "--out=" + (folder / "p")}),
      "nothing.csv");
  EXPECT_FALSE(std::filesystem::exists(folder / "p"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
