// `--spectral`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/formats/databases/rgl_file.h"
#include "io/formats/exports/rgl_export.h"
#include "model/spectral_color.h"
#include "tests/app/run_program.h"
#include "tests/model/spectral_materials.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/read_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// A table of `wavelengths` of a material that gets redder towards grazing, at 15 incidences.
void WriteSpectra(const std::vector<double>& wavelengths, const std::string& path) {
  ModelSpec spec = ModelSpec::SharedFactors(2);
  const SpectralModel model = AnalyticSpectralModel(spec, wavelengths);
  std::ofstream out(path);
  out.precision(9);
  out << "theta_i,phi_i,theta_o,phi_o";
  for (const double wavelength : wavelengths) out << ',' << wavelength << "nm";
  for (int theta_i = 0; theta_i <= 75; theta_i += 15) {
    for (int theta_o = 0; theta_o <= 75; theta_o += 5) {
      for (int phi_o = 0; phi_o <= 180; phi_o += 20) {
        const SphericalAngles at = {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o),
                                    DegreesToRadians(phi_o)};
        out << '\n' << theta_i << ",0," << theta_o << ',' << phi_o;
        for (const double rho : Evaluate(model, ToDirections(at))) out << ',' << rho;
      }
    }
  }
}

TEST(Spectral, AFitOfSevenBandsIsAModelOfSeven) {
  const TemporaryFolder folder;
  const std::string csv = folder / "red.csv", out = folder / "red";
  WriteSpectra(VisibleWavelengths(7), csv);
  const ProgramResult fit =
      RunProgram({"fit", csv, "--spectral", "--out=" + out, "--lobes=2", "--plots"});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("spectra      7 wavelengths from 400 to 700 nm, by "));
  EXPECT_GT(Contents(out + "/spectral.png").size(), 10000);
  const json whole = json::parse(Contents(out + "/report.json"));
  EXPECT_GT(whole["seconds"]["bands"], 0);
  const json& report = whole["spectral"];
  EXPECT_EQ(report["wavelengths"].size(), 7);
  for (const json& error : report["relative_objective"]) EXPECT_LT(error, 1e-3);

  // Its colours are those of the fit to colours, and those measured.
  const ModelFile spectral = ReadModel(out + "/spectral.json"),
                  rgb = ReadModel(out + "/model.json");
  ASSERT_TRUE(spectral.spectral.has_value());
  EXPECT_FALSE(rgb.spectral.has_value());
  const Measurement measured = LoadMeasurement(csv);
  BrdfSamples samples = SamplesOf(measured);
  const std::vector<Rgb> values = EvaluateSamples(spectral.model, samples, 1);
  EXPECT_LT(CompareSamples(samples, values).mean_delta_e, 0.5);
  samples.rho = EvaluateSamples(rgb.model, samples, 1);
  EXPECT_LT(CompareSamples(samples, values).mean_delta_e, 0.5);

  // Without the flag the model is the same to the bit, but for when it was made.
  const std::string plain = folder / "plain";
  ASSERT_EQ(RunProgram({"fit", csv, "--noplots", "--out=" + plain, "--lobes=2"}).status, 0);
  json a = json::parse(Contents(out + "/model.json")),
       b = json::parse(Contents(plain + "/model.json"));
  for (json* model : {&a, &b}) {
    for (const char* key : {"date", "run", "seconds"}) (*model)["fit"].erase(key);
  }
  EXPECT_EQ(a, b);

  // Commands read it as its colour.
  EXPECT_THAT(RunProgram({"info", out + "/spectral.json"}).out,
              HasSubstr("7 wavelengths from 400 to 700 nm, by "));
  EXPECT_EQ(RunProgram({"score", out + "/spectral.json", csv}).status, 0);

  // Its spectra as CSV and for renderers.
  const std::string at = folder / "values.csv", bsdf = folder / "red.bsdf";
  ASSERT_EQ(
      RunProgram({"convert", out + "/spectral.json", "--spectral", "--at=" + csv, "--out=" + at})
          .status,
      0);
  const Measurement written = LoadMeasurement(at);
  ASSERT_EQ(written.samples.size(), measured.samples.size());
  const std::vector<double> rho =
      Evaluate(*spectral.spectral, ToDirections(written.samples.directions[100]));
  for (size_t l = 0; l < rho.size(); ++l) {
    EXPECT_NEAR(written.samples.SpectrumOf(100)[l], rho[l], 1e-9 * rho[l]);
  }
  const ProgramResult exported = RunProgram(
      {"convert", out + "/spectral.json", "--spectral", "--error=0.05", "--out=" + bsdf});
  ASSERT_EQ(exported.status, 0) << exported.err;
  EXPECT_THAT(exported.out, HasSubstr("RGL tensor file of 7 wavelengths from 400 to 700 nm"));
  const RglBrdf read = RglBrdf::Parse(Contents(bsdf), "red.bsdf");
  const DirectionPair pair = {DirectionAt(0.5, 0), DirectionAt(0.6, 2.5)};
  const SpectralColor color(spectral.spectral->wavelengths(), "test");
  EXPECT_LT(RelativeDistance(read.Evaluate(pair), color(Evaluate(*spectral.spectral, pair))), 0.1);
}

// A table at MERL's bins, whose spectra are looked up.
TEST(Spectral, AnRglFileOfSpectraIsFittedAsSuch) {
  const TemporaryFolder folder;
  const SpectralModel model =
      AnalyticSpectralModel(ModelSpec::SharedFactors(2), VisibleWavelengths(7));
  std::ofstream(folder / "red_spec.bsdf", std::ios::binary)
      << ExportRgl(model, {.max_error = 0.1}).bytes;
  const std::string out = folder / "red";
  const ProgramResult fit =
      RunProgram({"fit", folder / "red_spec.bsdf", "--spectral", "--lobes=2", "--max_iterations=3",
                  "--nodiagnose", "--noplots", "--out=" + out});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("spectra      7 wavelengths from 400 to 700 nm"));
  const ModelFile fitted = ReadModel(out + "/spectral.json");
  const DirectionPair pair = {DirectionAt(0.5, 0), DirectionAt(0.6, 2.5)};
  const std::vector<double> rho = Evaluate(*fitted.spectral, pair), truth = Evaluate(model, pair);
  for (int l = 0; l < 7; ++l) EXPECT_NEAR(rho[l] / truth[l], 1, 0.1);
}

TEST(Spectral, OneWavelengthIsToldAsOne) {
  const TemporaryFolder folder;
  const std::string csv = folder / "laser.csv", out = folder / "laser";
  WriteSpectra({633}, csv);
  const ProgramResult fit = RunProgram(
      {"fit", csv, "--spectral", "--out=" + out, "--lobes=1", "--max_iterations=3", "--noplots"});
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr("one value for all channels, 633 nm"));
  EXPECT_THAT(fit.out, HasSubstr("spectra      one wavelength, 633 nm, by "));
  EXPECT_THAT(fit.out, testing::Not(HasSubstr("colour")));
  EXPECT_THAT(RunProgram({"info", out + "/spectral.json"}).out,
              HasSubstr("one wavelength, 633 nm"));
  EXPECT_THAT(
      RunProgram({"convert", out + "/spectral.json", "--spectral", "--out=" + (folder / "x.bsdf")})
          .err,
      HasSubstr("needs two or more wavelengths"));
}

TEST(Spectral, MeasuredSpectraAreWrittenAsTheyWere) {
  const TemporaryFolder folder;
  const std::string csv = folder / "a.csv", copy = folder / "b.csv";
  WriteSpectra(VisibleWavelengths(4 + 3), csv);
  ASSERT_EQ(RunProgram({"convert", csv, "--spectral", "--out=" + copy, "--scale=2"}).status, 0);
  const Measurement a = LoadMeasurement(csv), b = LoadMeasurement(copy);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (int j = 0; j < a.samples.size(); ++j) {
    for (size_t l = 0; l < 7; ++l) {
      const double expected = 2 * a.samples.SpectrumOf(j)[l];
      EXPECT_NEAR(b.samples.SpectrumOf(j)[l], expected, 1e-12 * expected);
    }
  }
}

TEST(Spectral, ErrorsSayWhatHasNoWavelengths) {
  const TemporaryFolder folder;
  EXPECT_THAT(RunProgram({"fit", "synth:felt@4x4x4", "--spectral"}).err,
              HasSubstr("synth:felt@4x4x4: its samples have no spectra"));
  const std::string model = "material:" + std::string("paper_white");
  EXPECT_THAT(RunProgram({"convert", model, "--spectral", "--at=synth:felt@4x4x4",
                          "--out=" + (folder / "a.csv")})
                  .err,
              HasSubstr("paper_white has none"));
  EXPECT_THAT(RunProgram({"convert", model, "--spectral", "--out=" + (folder / "a.csv")}).err,
              HasSubstr("take the directions of --at=MEASUREMENT"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
