// Sentences of typical errors, word by word: all other tests compare kinds and facts alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/names.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/scene/scene_file.h"
#include "io/formats/databases/merl_file.h"
#include "io/pictures/image_file.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/check.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/formats/trace_file.h"
#include "trilobe/model/load_model.h"
#include "trilobe/model/measurement/corruption.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
const std::string kHeader = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";

struct Golden {
  ErrorKind kind;
  std::string message;
  std::function<void()> call;
};

void Expect(const std::vector<Golden>& all) {
  for (const auto& [kind, message, call] : all) {
    const std::optional<Error> error = ErrorOf(call);
    ASSERT_TRUE(error) << message;
    EXPECT_EQ(error->what(), message);
    EXPECT_EQ(error->kind(), kind) << message;
  }
}

void Read(const std::string& name, const std::string& text, const SourceOptions& options = {}) {
  Source(name, text).Read(options);
}

void Model(const std::string& text) { ParseModel(text, "model.json"); }

void Minimise(const std::function<void(BrdfSamples*)>& change) {
  BrdfSamples samples = ValidSamples(RandomTable(kGrid, 1));
  change(&samples);
  Objective(samples, ModelSpec::SharedFactors(1, kGrid), FindWeighting("appearance"), 1);
}

TEST(Messages, OfArguments) {
  Expect({
      {ErrorKind::kRange, "stride is 0; it must be 1 or more",
       [] { CheckNumber("stride", 0, false, "1 or more"); }},
      {ErrorKind::kRange, "the bin is 240; it must be from 0 to 239",
       [] { CheckIndex(240, 240, "the bin"); }},
      {ErrorKind::kMismatch, "wi has 2 values; it must have 3", [] { CheckSize("wi", 2, 3); }},
      {ErrorKind::kMissing, "the model must not be null",
       [] { NotNull(static_cast<int*>(nullptr), "the model"); }},
      {ErrorKind::kRange, "lobes is 9; it must be from 0 to 8",
       [] { FactorModel(ModelSpec::SharedFactors(9)); }},
      {ErrorKind::kUnknown, "unknown choice 'third'; known: first, second",
       [] {
         FindNamed("choice", "third", std::vector<NamedSpec>{{"first", {}}, {"second", {}}});
       }},
      {ErrorKind::kMismatch,
       "a model of another spec: it has 1 lobes, stretched in 0 ways, 1 tables D of 6, 3 tables F "
       "of 5, 1 tables G of 5; wanted are 2 lobes, stretched in 0 ways, 2 tables D of 6, 3 tables "
       "F of 5, 2 tables G of 5, shared alike",
       [] {
         CheckSameSpec(ModelSpec::SharedFactors(1, kGrid), ModelSpec::SharedFactors(2, kGrid));
       }},
      {ErrorKind::kFormat,
       "weighting 'power:exponent=x': 'exponent=x' is not KEY=NUMBER with a number from 0 to 10; "
       "write power:exponent=1,epsilon=0.001,relative=0,by_channel=0,both_cosines=0,solid_angle=0, "
       "or less of it",
       [] { FindWeighting("power:exponent=x"); }},
      {ErrorKind::kFormat, "'noise' is not KIND:STRENGTH, as noise:0.05",
       [] { ParseCorruptions("noise"); }},
      {ErrorKind::kRange,
       "'noise:2': the strength of noise is a number from 0 to 1 [relative standard deviation]",
       [] { ParseCorruptions("noise:2"); }},
  });
}

TEST(Messages, OfFiles) {
  Expect({
      {ErrorKind::kFile, "cannot read '/no/such/file': No such file or directory",
       [] { ReadFile("/no/such/file"); }},
      {ErrorKind::kFile, "cannot read '/': it is a directory; give the name of a file",
       [] { ReadFile("/"); }},
      {ErrorKind::kFile,
       "cannot write '/no/such/file': there is no folder '/no/such'; make it first",
       [] { WriteFile("/no/such/file", [](std::ostream& out) { out << "x"; }); }},
      {ErrorKind::kFormat, "file.json: line 3, column 8: expected a value",
       [] { JsonValue::Parse("{\n  \"a\": 1,\n  \"b\": x\n}", "file.json"); }},
      {ErrorKind::kLimit, "t: it has 16777217 bytes; at most 16777216 can be read",
       [] { JsonValue::Parse(std::string(kMaxJsonBytes + 1, ' '), "t"); }},
      {ErrorKind::kFormat, "model.json: not a model file: it must be a JSON object, not array",
       [] { Model("[1]"); }},
      {ErrorKind::kMissing, "model.json: key 'format' is missing", [] { Model("{}"); }},
      {ErrorKind::kFormat, "model.json: key 'format' must be \"trilobe-model\"",
       [] { Model(R"({"format": "other"})"); }},
      {ErrorKind::kUnsupported,
       "model.json: key 'version' is 9; this program reads versions 1 to 3; update it",
       [] { Model(R"({"format": "trilobe-model", "version": 9})"); }},
      {ErrorKind::kUnknown,
       "material:lines: there is no material of this name; did you mean 'material:linen'? `trilobe "
       "materials` lists all",
       [] { LoadModel("material:lines"); }},
      {ErrorKind::kFormat,
       "trace.csv: line 1: not a trace; the first line must be "
       "iteration,seconds,objective,filtered,accepted,step,optimality",
       [] { ParseTrace("", "trace.csv"); }},
      {ErrorKind::kFormat,
       "probe.hdr: not a Radiance picture; give a light probe as a lat-long .hdr file",
       [] { ParseProbe("", "probe.hdr"); }},
      {ErrorKind::kMissing, "s.json: /: the key 'format' is missing; add it",
       [] { ParseScene("{}", "s.json"); }},
      {ErrorKind::kUnknown,
       "s.json: /materials/0/nam: unknown key; did you mean 'name'? Known here: name, source, "
       "directions, channels, budget, leave_out, options",
       [] {
         ParseScene(R"({"format": "trilobe-scene", "version": 1, "materials": [{"nam": "a"}]})",
                    "s.json");
       }},
  });
}

TEST(Messages, OfMeasurements) {
  Expect({
      {ErrorKind::kFormat,
       "x.csv: the file is empty; a table begins with a header row, as "
       "theta_i,phi_i,theta_o,phi_o,r,g,b",
       [] { Read("x.csv", ""); }},
      {ErrorKind::kMissing,
       "x.csv: line 1: the header has no column phi_o; it must be "
       "theta_i,phi_i,theta_o,phi_o,r,g,b, in any order",
       [] { Read("x.csv", "theta_i,phi_i,theta_o,r,g,b\n1,2,3,4,5,6\n"); }},
      {ErrorKind::kFormat, "x.csv: line 2: 3 columns; expected 7, from theta_i to b",
       [] { Read("x.csv", kHeader + "1,2,3\n"); }},
      {ErrorKind::kFormat,
       "x.csv: line 2, column 4 (phi_o): 'abc' is no number; give the number alone, as 1.5e-3, and "
       "an empty cell where nothing was measured",
       [] { Read("x.csv", kHeader + "1,2,3,abc,5,6,7\n"); }},
      {ErrorKind::kRange,
       "x.csv: line 2, column 1 (theta_i): -190 is no such angle; expected degrees from -180 to "
       "180",
       [] { Read("x.csv", kHeader + "-190,2,3,4,5,6,7\n"); }},
      {ErrorKind::kFormat,
       "chrome.binary: the header says 0 x 0 x 0 bins in a file of 12 bytes; a MERL file has 90 x "
       "90 x 180 bins, or others with 8 or 4 bytes for each and channel",
       [] { ParseMerl(std::string(12, '\0'), "chrome.binary"); }},
      {ErrorKind::kUnknown,
       "unknown synthetic material 'cheese'; known: plastic, car-paint, copper, aluminium, chrome, "
       "felt, foam, rubber, linen, crepe_de_chine, charmeuse, shot_silk, velvet, rolled_brass, "
       "rolled_aluminium, brushed_aluminium, varnished_plywood, enamelled_metal, aniso_ggx_steel, "
       "aniso_ggx_gold, aniso_ggx_lacquer",
       [] { LoadMeasurement("synth:cheese"); }},
      {ErrorKind::kFormat,
       "'3' is no grid of directions; give the numbers of theta and phi, as 6x48, of at most 3162 "
       "directions",
       [] { LoadMeasurement("synth:foam@3"); }},
      {ErrorKind::kRange, "--noise is 2; it must be from 0 to 1",
       [] { Read("x.csv", kHeader + "0,0,30,0,1,1,1\n", {.noise = 2}); }},
      {ErrorKind::kUnsupported,
       "synth:linen: this command needs a table on the MERL grid, and this is a synthetic "
       "measurement, scattered; take a MERL or RGL file, or synth:NAME",
       [] { LoadTable("synth:linen"); }},
      {ErrorKind::kUnsupported,
       "x.zip: trilobe writes no '.zip'; end the name in .binary for MERL layout, .csv for CSV, "
       ".bin for UTIA layout",
       [] { WritableFormat("x.zip"); }},
      {ErrorKind::kData,
       "synth:foam: no valid bin: nowhere are both directions above the surface and all three "
       "values finite and >= 0 where it was measured; --max_angle, --min_theta_d and "
       "--extrapolated say what counts",
       [] { SamplesOf(LoadMeasurement("synth:foam", {.max_angle_deg = 1e-9})); }},
  });
}

TEST(Messages, OfFits) {
  Expect({
      {ErrorKind::kUnknown,
       "unknown init 'psychic'; known: analytic, highlight, moments, freed, constant, roughness, "
       "random",
       [] { FindInitialModel("psychic"); }},
      {ErrorKind::kRange, "starts is 0; it must be 1 or more",
       [] { CheckSolverOptions({.starts = 0}); }},
      {ErrorKind::kData, "random: no sample; an objective needs one or more",
       [] { Minimise([](BrdfSamples* samples) { *samples = Selected(*samples, {}); }); }},
      {ErrorKind::kMismatch, "random: 153 samples have 152 bins; each needs one",
       [] { Minimise([](BrdfSamples* samples) { samples->bins.pop_back(); }); }},
      {ErrorKind::kRange, "random: sample 3 is -1/sr; it must be 0 or more",
       [] { Minimise([](BrdfSamples* samples) { samples->rho[3][1] = -1; }); }},
      {ErrorKind::kUnsupported,
       "synth:plastic@20x20x40: --prior is for scattered samples, and a synthetic measurement is a "
       "table",
       [] { Fit(LoadMeasurement("synth:plastic@20x20x40"), {.prior = 1}); }},
      {ErrorKind::kConflict, "--raw stores what the solver found; leave out --robust",
       [] { Fit(LoadMeasurement("synth:plastic@20x20x40"), {.robust = 0.1, .raw = true}); }},
      {ErrorKind::kMissing,
       "synth:velvet@4x12: its samples have no spectra, so there is no model of wavelengths; leave "
       "out --spectral",
       [] { Fit(LoadMeasurement("synth:velvet@4x12"), {.bands = true}); }},
  });
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
