// Rows of the same directions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Measurement Read(const std::string& text, const SourceOptions& options = {}) {
  return Source("x.csv", text).Read(options);
}

std::optional<Error> ReadError(const std::string& text, const SourceOptions& options = {}) {
  return ErrorOf([&] { Read(text, options); });
}

std::vector<double> FirstsOf(const Measurement& read) {
  std::vector<double> values;
  for (const Rgb& rho : read.samples.rho) values.push_back(rho[0]);
  return values;
}

// Two pairs of directions in light of two polarisations, the second in another order.
std::string Table(const std::string& name, const std::string& s, const std::string& p) {
  return "theta_i,theta_o,phi_o," + name + ",f\n30,10,0," + s + ",0.25\n30,10,0," + p +
         ",0.75\n30,20,0," + p + ",4\n30,20,0," + s + ",2\n";
}

TEST(RepeatedRows, TheMeanOfKindsIsTaken) {
  for (const char* const name : {"polarization", "Polarisation", "pol", "sample", "Run"}) {
    const Measurement read = Read(Table(name, "s", "p"));
    EXPECT_THAT(FirstsOf(read), ElementsAre(0.5, 3)) << name;
    EXPECT_EQ(RadiansToDegrees(read.samples.directions[1].theta_o), 20);
    EXPECT_THAT(read.notes,
                ElementsAre(HasSubstr("read as"),
                            std::string("column '") + name +
                                "' (s, p) tells rows of the same directions apart: their mean is "
                                "taken; --rows=" +
                                name + "=CELL reads one alone"));
  }
  EXPECT_THAT(FirstsOf(Read(Table("sample", "1", "2"))), ElementsAre(0.5, 3));
}

TEST(RepeatedRows, WhatTellsNothingApartIsReadRowByRow) {
  // Kinds of another number of polarisations, and a kind twice.
  for (const std::string& text : {Table("pol", "ss", "pp"), Table("side", "s", "s")}) {
    const Measurement read = Read(text);
    EXPECT_THAT(FirstsOf(read), ElementsAre(0.25, 0.75, 4, 2)) << text;
    EXPECT_THAT(read.notes, Not(Contains(HasSubstr("mean is taken"))));
  }
  EXPECT_THAT(FirstsOf(Read("theta_i,theta_o,sample,f\n30,10,1,1\n30,20,2,2\n30,30,3,3\n")),
              ElementsAre(1, 2, 3));
}

TEST(RepeatedRows, ColumnsOfAnyNameTellRowsApart) {
  for (const char* const name : {"laser", "Probe", "no", "detector", "Muster"}) {
    const Measurement read = Read(Table(name, "A", "B"));
    EXPECT_THAT(FirstsOf(read), ElementsAre(0.5, 3)) << name;
    EXPECT_THAT(read.notes, Contains(HasSubstr(std::string("column '") + name +
                                               "' (A, B) tells rows of the same directions")));
    EXPECT_THAT(FirstsOf(Read(Table(name, "A", "B"), {.rows = std::string(name) + "=B"})),
                ElementsAre(0.75, 4));
  }
  EXPECT_THAT(FirstsOf(Read(Table("no", "1", "2"))), ElementsAre(0.5, 3));
  // Numbers may be an angle that is not read, and cells that differ everywhere are no kinds.
  EXPECT_THAT(ReadError(Table("w", "0", "180")),
              IsError(ErrorKind::kUnsupported, {.line = 1, .key = "rows", .value = "w"}));
  EXPECT_THAT(FirstsOf(Read(Table("w", "0", "180"), {.columns = "-=w"})),
              ElementsAre(0.25, 0.75, 4, 2));
  EXPECT_THAT(FirstsOf(Read("theta_i,theta_o,std,f\n30,10,.1,1\n30,10,.2,2\n30,20,.3,3\n")),
              ElementsAre(1, 2, 3));
}

TEST(RepeatedRows, TwoColumnsOfPolarisationsAreOne) {
  const Measurement read = Read(
      "theta_i,theta_o,pol_in,pol_out,f\n30,10,s,s,1\n30,10,s,p,0.25\n30,10,p,s,0.25\n"
      "30,10,p,p,0.5\n");
  EXPECT_THAT(FirstsOf(read), ElementsAre(1));
  EXPECT_THAT(read.notes, Contains(HasSubstr("--rows=pol_in=CELL,pol_out=CELL reads one")));
}

TEST(RepeatedRows, KindsAtOtherDirectionsAreReadAsOneAndTold) {
  const std::string rows = ",f\n30,10,A,1\n30,20,A,2\n30,30,B,3\n30,40,B,4\n";
  for (const char* const name : {"sample", "Specimen", "material", "pol"}) {
    EXPECT_THAT(Read(std::string("theta_i,theta_o,") + name + rows).notes,
                Contains(std::string("column '") + name +
                         "' has A, B, which are read as one; --rows=" + name + "=A reads one"));
  }
  EXPECT_THAT(Read("theta_i,theta_o,side" + rows).notes, ElementsAre(HasSubstr("read as")));
  EXPECT_THAT(Read("theta_i,theta_o,pol,f\n30,10,s,1\n30,20,s,2\n").notes,
              Contains(HasSubstr("light of one polarisation")));
}

TEST(RepeatedRows, HalfTheSumOfFourPolarisationsCounts) {
  const Measurement read = Read(
      "theta_i,theta_o,phi_o,pol,f\n30,10,0,ss,1\n30,10,0,sp,0.25\n30,10,0,ps,0.25\n30,10,0,pp,0."
      "5\n");
  EXPECT_THAT(FirstsOf(read), ElementsAre(1));
  EXPECT_THAT(read.notes, Contains(HasSubstr("half their sum is taken")));
}

TEST(RepeatedRows, DirectionsThatLackAKindAreLeftOut) {
  const Measurement read = Read(Table("pol", "s", "p") + "30,30,0,s,9\n30,40,0,s,9\n30,40,0,p,\n");
  EXPECT_THAT(FirstsOf(read), ElementsAre(0.5, 3));
  EXPECT_EQ(read.counts.missing, 2);
  EXPECT_THAT(read.notes, Contains(HasSubstr("2 directions that lack one are left out")));
}

TEST(RepeatedRows, SpectraAreAveragedByWavelength) {
  std::string text = "theta_i,theta_o,phi_o,pol,wavelength,f\n";
  for (const char* const wavelength : {"500", "600"}) {
    text += std::string("30,10,0,s,") + wavelength + ",0.25\n";
    text += std::string("30,10,0,p,") + wavelength + ",0.75\n";
  }
  const Measurement read = Read(text, {.bands = "600"});
  EXPECT_THAT(FirstsOf(read), ElementsAre(0.5));
  EXPECT_EQ(read.samples.spectra->wavelengths, (std::vector<double>{600}));
  EXPECT_THAT(FirstsOf(Read("theta_i,theta_o,pol,500nm,600nm\n30,10,s,1,2\n30,10,p,3,6\n",
                            {.bands = "600"})),
              ElementsAre(4));
}

TEST(RepeatedRows, SomeRowsMayBeChosen) {
  const std::string table = Table("polarization", "s", "p");
  const Measurement read = Read(table, {.rows = "polarization=p"});
  EXPECT_THAT(FirstsOf(read), ElementsAre(0.75, 4));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("rows of polarization=p")));
  EXPECT_THAT(FirstsOf(Read(table, {.rows = "Polarization=p,theta_o=20.0"})), ElementsAre(4));
  // What remains apart is averaged.
  EXPECT_THAT(FirstsOf(Read("theta_i,theta_o,pol,sample,f\n30,10,s,1,1\n30,10,p,1,3\n"
                            "30,10,s,2,5\n30,10,p,2,7\n",
                            {.rows = "sample=2"})),
              ElementsAre(6));
  EXPECT_THAT(FirstsOf(Read("theta_i,theta_o,f\n30,10,1\n30,20,2\n", {.rows = "theta_o=20"})),
              ElementsAre(2));
  EXPECT_THAT(ReadError(table, {.rows = "polarization=x"}),
              IsError(ErrorKind::kMissing,
                      {.file = "x.csv", .line = 1, .key = "rows", .value = "polarization=x"}));
  EXPECT_THAT(
      ReadError(table, {.rows = "cheese=1"}),
      IsError(ErrorKind::kUnknown, {.file = "x.csv", .line = 1, .key = "rows", .value = "cheese"}));
  EXPECT_THAT(ReadError(table, {.rows = "s"}),
              IsError(ErrorKind::kFormat, {.line = 1, .key = "rows", .value = "s"}));
  EXPECT_THAT(Source("synth:felt@2x4").Read({.rows = "a=b"}).notes,
              ElementsAre("--rows is of text tables, and changes nothing here"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
