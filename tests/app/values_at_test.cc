// `trilobe convert MODEL --at=MEASUREMENT`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/files/text_lines.h"
#include "tests/app/run_program.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/load_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(ValuesAt, StandBesideThoseMeasured) {
  const TemporaryFolder folder;
  const std::string model = "material:" + std::string(MaterialNames().at(0)),
                    csv = folder / "measured.csv", out = folder / "values.csv";
  std::ofstream(csv) << "theta_i,phi_i,theta_o,phi_o,r,g,b\n"
                        "10,0,20,180,0.25,0.5,0.75\n60,0,30,90,0.1,0.2,0.3\n";
  const ProgramResult result = RunProgram({"convert", model, "--at=" + csv, "--out=" + out});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("2 samples, measured and fitted"));
  const std::string text = Contents(out);
  EXPECT_THAT(text, StartsWith("theta_i,phi_i,theta_o,phi_o,measured_r,measured_g,measured_b,"
                               "fitted_r,fitted_g,fitted_b\n"));
  const Measurement measurement = LoadMeasurement(csv);
  const FactorModel factors = LoadModel(model).model;
  TextLines lines(text, out);
  ASSERT_TRUE(lines.Next());
  for (const SphericalAngles& at : measurement.samples.directions) {
    ASSERT_TRUE(lines.Next());
    const auto cells = SplitCells(lines.line());
    ASSERT_EQ(cells.size(), 10);
    EXPECT_NEAR(ToNumber(cells[0]).value(), RadiansToDegrees(at.theta_i), 1e-9);
    EXPECT_NEAR(ToNumber(cells[3]).value(), RadiansToDegrees(at.phi_o), 1e-9);
    const Rgb fitted = Evaluate(factors, ToDirections(at));
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(ToNumber(cells[7 + c]).value(), fitted[c], 1e-9 * fitted[c]);
    }
  }
  EXPECT_FALSE(lines.Next());
}

TEST(ValuesAt, NeedOnlyDirections) {
  const TemporaryFolder folder;
  const std::string model = "material:" + std::string(MaterialNames().at(0)),
                    csv = folder / "directions.csv", out = folder / "values.csv";
  std::ofstream(csv) << "theta_i,phi_i,theta_o,phi_o\n10,0,20,180\n60,0,30,90\n60,90,30,180\n";
  const ProgramResult result = RunProgram({"convert", model, "--at=" + csv, "--out=" + out});
  ASSERT_EQ(result.status, 0) << result.err;
  const Measurement measurement = LoadMeasurement(out);
  ASSERT_EQ(measurement.samples.size(), 3);
  const FactorModel factors = LoadModel(model).model;
  for (int j = 0; j < 3; ++j) {
    const Rgb value = Evaluate(factors, ToDirections(measurement.samples.directions[j]));
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(measurement.samples.rho[j][c], value[c], 1e-12 * value[c]);
    }
  }
  // Other commands ask for values.
  EXPECT_THAT(RunProgram({"info", csv}).err, HasSubstr("no column of values"));
  EXPECT_THAT(RunProgram({"info", csv}).err, HasSubstr("add what you measured at each"));
}

TEST(ValuesAt, ErrorsSayWhatItGoesWith) {
  const TemporaryFolder folder;
  const std::string model = "material:" + std::string(MaterialNames().at(0));
  EXPECT_THAT(
      RunProgram({"convert", model, "--at=synth:felt@4x4x4", "--out=" + (folder / "a.bin")}).err,
      HasSubstr("--at goes with an --out that ends in .csv"));
  EXPECT_THAT(RunProgram({"convert", "synth:felt@4x4x4", "--at=synth:felt@4x4x4",
                          "--out=" + (folder / "a.csv")})
                  .err,
              HasSubstr("synth:felt@4x4x4: --at goes with a model"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
