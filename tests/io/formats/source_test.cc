#include "trilobe/io/formats/source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/formats/databases/merl_file.h"
#include "io/formats/databases/rgl_file.h"
#include "tests/error_of.h"
#include "tests/io/formats/tensor_bytes.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

TEST(LoadTable, TellsFilesApartByContent) {
  const TestDirectory directory;
  BrdfTable table = MakeInvalidTable("white", {});
  table.SetValue(1, 5, 0.25);
  WriteMerl(table, directory.Path("a.bsdf"));  // the name says RGL, the content does not
  const BrdfTable merl = LoadTable(directory.Path("a.bsdf"));
  EXPECT_EQ(merl.stored, table.stored);
  EXPECT_EQ(merl.source, directory.Path("a.bsdf"));

  TinyRgl file;
  file.FillConstant(4, 1, 1);
  const std::string path = directory.Make("b.binary", file.Bytes());
  const BrdfTable rgl = LoadTable(path, {.num_threads = 2, .outliers = true});
  EXPECT_EQ(rgl.source, path);
  EXPECT_EQ(rgl.grid, MerlGrid());
  EXPECT_EQ(rgl.stored, TabulateRgl(RglBrdf::Parse(file.Bytes(), path), path).stored);
}

TEST(LoadTable, MakesSyntheticMaterials) {
  const BrdfTable table = LoadTable("synth:plastic", {.noise = 0.1, .seed = 3, .num_threads = 2});
  EXPECT_EQ(table.source, "synth:plastic");
  EXPECT_EQ(table.stored,
            LoadTable("synth:plastic", {.noise = 0.1, .seed = 3, .num_threads = 1}).stored);
  EXPECT_NE(table.stored, LoadTable("synth:plastic", {.noise = 0.1, .seed = 4}).stored);
}

TEST(LoadTable, DecidesWhatCountsAsMeasured) {
  const TestDirectory directory;
  TinyRgl file;
  file.theta_i = {0, 1.2F, 1.5707964F};
  file.FillConstant(4, 1, 1);
  file.MaskAll();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(0, row, 3, false);
  const std::string path = directory.Make("masked.bsdf", file.Bytes());
  const BrdfTable whole = LoadTable(path, {.extrapolated = true});
  EXPECT_TRUE(whole.unmeasured.empty());
  EXPECT_EQ(whole.max_theta, kPi / 2);
  const BinCounts all = CountBins(LoadTable(path));
  EXPECT_GT(all.extrapolated, 0);
  EXPECT_GT(all.beyond_nodes, 0);
  // Bins that were left out before keep their reason.
  const BrdfTable part = LoadTable(path, {.max_angle_deg = 40});
  EXPECT_DOUBLE_EQ(RadiansToDegrees(part.max_theta), 40);
  EXPECT_EQ(CountBins(part).extrapolated, all.extrapolated);
  EXPECT_EQ(CountBins(part).beyond_nodes, all.beyond_nodes);
  EXPECT_GT(CountBins(part).beyond_max_angle, 0);
  EXPECT_EQ(part.stored, whole.stored);
  const BinCounts both = CountBins(LoadTable(path, {.max_angle_deg = 40, .extrapolated = true}));
  EXPECT_EQ(both.extrapolated + both.beyond_nodes, 0);
  EXPECT_EQ(both.beyond_max_angle + both.valid, 1096216);
  // Other sources, too; a limit beyond the last node of an RGL file changes nothing.
  EXPECT_EQ(CountBins(LoadTable("synth:foam", {.max_angle_deg = 40})).valid, both.valid);
  EXPECT_EQ(LoadTable(path, {.max_angle_deg = 80}).unmeasured, LoadTable(path).unmeasured);
  // A MERL file can say no more than that a bin is lost.
  WriteMerl(part, directory.Path("part.binary"));
  const BinCounts merl = CountBins(LoadTable(directory.Path("part.binary")));
  EXPECT_EQ(merl.valid, CountBins(part).valid);
  EXPECT_EQ(merl.negative, 1096216 - merl.valid);
}

TEST(LoadTable, ErrorsSayWhatToDo) {
  const TestDirectory directory;
  EXPECT_THAT(ErrorOf([] { LoadTable("synth:cheese"); }),
              IsError(ErrorKind::kUnknown, {.key = "synthetic material", .value = "cheese"}));
  EXPECT_THAT(ErrorOf([&] { LoadTable(directory.Path("missing")); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("missing"),
                                         .key = "read",
                                         .value = "No such file or directory"}));
  EXPECT_THAT(
      ErrorOf([&] { LoadTable(directory.path()); }),
      IsError(ErrorKind::kFile, {.file = directory.path(), .key = "read", .value = "directory"}));
  EXPECT_THAT(ErrorOf([&] { LoadTable(directory.Make("empty", "")); }),
              IsError(ErrorKind::kFormat,
                      {.file = directory.Path("empty"), .key = "content", .value = "empty"}));
  EXPECT_THAT(ErrorOf([&] { LoadTable(directory.Make("text", "BRDF of a cheese\n")); }),
              IsError(ErrorKind::kUnsupported,
                      {.file = directory.Path("text"), .key = "content", .value = "text"}));
  WriteModel(ModelFile(), directory.Path("model.json"));
  EXPECT_THAT(
      ErrorOf([&] { LoadTable(directory.Path("model.json")); }),
      IsError(ErrorKind::kUnsupported,
              {.file = directory.Path("model.json"), .key = "content", .value = "a JSON file"}));
}

const char kCsv[] = "theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,70,0,1,2,3\n10,0,20,0,4,5,6\n";

TEST(LoadMeasurement, IsATableOrScattered) {
  const TestDirectory directory;
  const Measurement synthetic = LoadMeasurement("synth:foam", {.max_angle_deg = 40});
  EXPECT_EQ(synthetic.kind, "synthetic measurement");
  EXPECT_EQ(synthetic.source, "synth:foam");
  ASSERT_TRUE(synthetic.table);
  EXPECT_EQ(SamplesOf(synthetic).size(), CountsOf(synthetic).valid);
  EXPECT_EQ(MaxAngleDegrees(synthetic), 40);
  WriteMerl(*synthetic.table, directory.Path("foam.binary"));
  EXPECT_EQ(LoadMeasurement(directory.Path("foam.binary")).kind, "MERL measurement");

  TinyRgl file;
  file.FillConstant(4, 1, 1);
  const Measurement rgl = LoadMeasurement(directory.Make("b.bsdf", file.Bytes()));
  EXPECT_EQ(rgl.kind, "RGL measurement, at MERL bins");
  ASSERT_TRUE(rgl.table && rgl.look_up);

  const std::string path = directory.Make("x", kCsv);  // told by its content
  const Measurement csv = LoadMeasurement(path);
  EXPECT_FALSE(csv.table);
  EXPECT_EQ(csv.kind, "CSV file of scattered samples");
  EXPECT_EQ(SamplesOf(csv).source, path);
  EXPECT_EQ(SamplesOf(csv).size(), 2);
  const Measurement limited = LoadMeasurement(path, {.max_angle_deg = 60});
  EXPECT_EQ(CountsOf(limited).valid, 1);
  EXPECT_EQ(CountsOf(limited).beyond_max_angle, 1);
  EXPECT_EQ(MaxAngleDegrees(limited), 20);
  EXPECT_EQ(SamplesOf(limited).rho, (std::vector<Rgb>{{4, 5, 6}}));
}

// A flag for what the data have not is told, as is one that their format does not read.
TEST(LoadMeasurement, SaysWhichOptionsChangeNothing) {
  const TestDirectory directory;
  const auto notes = [](const std::string& source, const SourceOptions& options) {
    std::string text;
    for (const std::string& note : LoadMeasurement(source, options).notes) text += note + "\n";
    return text;
  };
  const auto nothing = testing::HasSubstr("changes nothing here");
  for (const SourceOptions& options :
       {SourceOptions{.extrapolated = true}, {.outliers = true}, {.dark_noise = true}}) {
    EXPECT_THAT(notes("synth:felt@12x12x24", options), nothing);
    EXPECT_THAT(notes("synth:felt@6x12", options), nothing);
  }
  EXPECT_EQ(notes("synth:felt@12x12x24", {.as_they_are = true}), "");

  BrdfTable table = LoadTable("synth:felt");
  for (int bin = 0; bin < 40; ++bin) {
    const int at = table.grid.Index(20, 2 * bin, 90);
    for (std::vector<double>& plane : table.stored) plane[at] *= 1000;
  }
  const std::string spoiled = directory.Path("spoiled.binary");
  WriteMerl(table, spoiled);
  EXPECT_THAT(notes(spoiled, {}), HasSubstr("--outliers takes them"));
  EXPECT_THAT(notes(spoiled, {.outliers = true}), testing::Not(nothing));
  EXPECT_THAT(notes(spoiled, {.dark_noise = true}), HasSubstr("--dark_noise takes"));
}

TEST(LoadMeasurement, TheEndingTellsWhereTheContentCannot) {
  const TestDirectory directory;
  const std::string text = "theta,phi\n1,2\n";
  EXPECT_THAT(
      ErrorOf([&] { LoadMeasurement(directory.Make("x.CSV", text)); }),
      IsError(ErrorKind::kMissing, {.file = directory.Path("x.CSV"), .line = 1, .key = "theta_i"}));
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make("x.astm", text)); }),
              IsError(ErrorKind::kMissing, {.file = directory.Path("x.astm"), .key = "VARS"}));
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make("x.brdf", text)); }),
              IsError(ErrorKind::kFormat, {.file = directory.Path("x.brdf"),
                                           .line = 1,
                                           .key = "number of wavelengths",
                                           .value = "theta,phi"}));
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make("x.bsdf", text)); }),
              IsError(ErrorKind::kFormat,
                      {.file = directory.Path("x.bsdf"), .line = 1, .key = "DataBegin"}));
  const std::string binary(100, '\1');
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make("x.bin", binary)); }),
              IsError(ErrorKind::kFormat,
                      {.file = directory.Path("x.bin"), .key = "bytes", .value = "100"}));
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make("x.dat", binary)); }),
              IsError(ErrorKind::kFormat, {.file = directory.Path("x.dat"),
                                           .key = "bins",
                                           .value = "16843009 x 16843009 x 16843009"}));
  for (const char* name : {"x.txt", "x.binary"}) {
    EXPECT_THAT(ErrorOf([&] { LoadMeasurement(directory.Make(name, text)); }),
                IsError(ErrorKind::kUnsupported,
                        {.file = directory.Path(name), .key = "content", .value = "text"}))
        << name;
  }
}

// Both leave out the angles at which a corruption makes the detector stand in its own light.
TEST(LoadMeasurement, TreatsSyntheticDataAsThoseOfAFile) {
  const TestDirectory directory;
  const std::string source = "synth:shot_silk@9x36", path = directory.Path("silk.csv");
  WriteMeasurement(LoadMeasurement(source), path);
  const SourceOptions options = {.corrupt = "shadow:5", .num_threads = 2};
  const Measurement synthetic = LoadMeasurement(source, options);
  const Measurement read = LoadMeasurement(path, options);
  EXPECT_GT(read.counts.below_min_theta_d, 0);
  EXPECT_EQ(synthetic.counts.below_min_theta_d, read.counts.below_min_theta_d);
  EXPECT_EQ(synthetic.counts.valid, read.counts.valid);
  EXPECT_EQ(synthetic.notes, read.notes);
  EXPECT_EQ(synthetic.samples.rho, read.samples.rho);
}

TEST(LoadTable, NeedsATable) {
  const TestDirectory directory;
  const std::string path = directory.Make("x.csv", kCsv);
  EXPECT_THAT(ErrorOf([&] { LoadTable(path); }),
              IsError(ErrorKind::kUnsupported, {.file = path, .key = "table"}));
  EXPECT_THAT(ErrorOf([&] { TableOf(Source("x.csv", kCsv).Read()); }),
              IsError(ErrorKind::kUnsupported, {.key = "table"}));
}

TEST(MeasurementFormats, EachRecognisesItsOwnAlone) {
  TinyRgl file;
  file.FillConstant(4, 1, 1);
  const std::map<std::string, std::string> begins = {
      {"merl", std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12)},
      {"rgl", file.Bytes()},
      {"mbsdf", "NVIDIA ARC MBSDF V1\n"},
      {"utia", std::string(1990656, '\0')},
      {"zemax", "Source\tMeasured\n"},
      {"lighttools", "Symmetry Asymmetric\n"},
      {"alta", "#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n"},
      {"fred", "type bsdf_data\n"},
      {"radiance", "<?xml version=\"1.0\"?>\n<WindowElement>\n"},
      {"cornell", "31\n400 410\n"},
      {"astm", "VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n"},
      {"speos", "OPTIS - brdf surface file v9.0\n"},
      {"ssdd", "VERSION 0.2\nDATA_TYPE brdf\n"},
      {"pab", "#sample_name \"x\"\n#intheta 30\n"},
      {"openmaterial", "{\"brdf\": {\"lookupTable\": []}}"},
      {"json", "{\"theta_i\": [10],\n\"theta_o\": [20],\n\"f\": [0.5]}"},
      {"csv", kCsv}};
  ASSERT_EQ(MeasurementFormats().size(), begins.size());
  for (const MeasurementFormat& format : MeasurementFormats()) {
    for (const auto& [name, bytes] : begins) {
      EXPECT_EQ(format.recognise(bytes), format.name == name) << format.name << " of " << name;
    }
  }
}

// The tilt is taken from the highlight, which shows it within a tenth.
TEST(LoadMeasurement, TakesOutTheTiltThatTheHighlightShows) {
  const std::string source = "synth:aluminium@60x30x60";
  const SourceOptions shown = {.corrupt = "tilt:1", .tilt_deg = std::nullopt, .outliers = true};
  const Measurement by_highlight = LoadMeasurement(source, shown);
  ASSERT_EQ(by_highlight.notes.size(), 1);
  EXPECT_THAT(by_highlight.notes[0], HasSubstr("deg off the mirror direction, which --tilt=auto"));
  const auto difference = [&](double degrees) {
    const SourceOptions given = {.corrupt = "tilt:1", .tilt_deg = degrees, .outliers = true};
    const std::vector<double>& a = by_highlight.table->stored[1];
    const std::vector<double> b = LoadMeasurement(source, given).table->stored[1];
    double sum = 0;
    for (size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
    return sum;
  };
  EXPECT_LT(difference(1), difference(0.8));
  EXPECT_LT(difference(1), difference(1.2));
}

TEST(LoadMeasurement, SaysWhereNoTiltIsShown) {
  const SourceOptions shown = {.tilt_deg = std::nullopt};
  const Measurement straight = LoadMeasurement("synth:aluminium@60x30x60", shown);
  EXPECT_THAT(straight.notes, testing::ElementsAre(HasSubstr("--tilt=auto changes nothing")));
  EXPECT_EQ(straight.table->stored, LoadMeasurement("synth:aluminium@60x30x60").table->stored);
  EXPECT_THAT(
      ErrorOf([&] { LoadMeasurement("synth:felt@60x30x60", shown); }),
      IsError(ErrorKind::kData, {.file = "synth:felt@60x30x60", .key = "tilt", .value = "auto"}));
  EXPECT_THAT(ErrorOf([&] { LoadMeasurement("synth:plastic@4x8", shown); }),
              IsError(ErrorKind::kUnsupported, {.key = "tilt", .value = "auto"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
