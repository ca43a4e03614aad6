// What is said of tables that lack a column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string Problem(const std::string& text, const SourceOptions& options = {}) {
  const std::optional<Error> error = ErrorOf([&] { Source("x.csv", text).Read(options); });
  return error ? error->what() : "";
}

TEST(TableAdvice, ColumnsThatCouldBeItAreNamed) {
  EXPECT_THAT(
      Problem("theta_i,Winkel,BRDF\n30,10,1\n"),
      AllOf(HasSubstr("no column theta_o; if it is 'Winkel', type --columns=theta_o=Winkel"),
            Not(HasSubstr("DEGREES"))));
  EXPECT_THAT(Problem("invalshoek,uitvalshoek,azimut,BRDF\n30,10,0,1\n"),
              HasSubstr("type --columns=theta_i=invalshoek,theta_o=uitvalshoek"));
  EXPECT_THAT(Problem("theta_i,theta_o,FDRB (sr-1)\n30,10,1\n"),
              HasSubstr("'--columns=f=FDRB (sr-1)'"));
  EXPECT_THAT(Problem("detector angle,Intensity\n10,1\n20,2\n"), Not(HasSubstr("=Intensity")));
  EXPECT_THAT(Problem("theta_i,phi,brdf_data_1D\n10,0,1\n20,0,2\n"),
              HasSubstr("--theta_o=DEGREES gives it"));
  EXPECT_THAT(Problem("alpha,beta,gamma,BRDF\n10,0,1,1\n"),
              HasSubstr("--columns=theta_i=alpha,theta_o=beta"));
  // What holds no numbers cannot be it.
  EXPECT_THAT(Problem("theta_i,operator,BRDF\n30,J. Smith,1\n"),
              HasSubstr("--theta_o=DEGREES gives it, and --columns=theta_i,theta_o,f names"));
}

TEST(TableAdvice, ALineAboveTheRowsIsTheHeader) {
  const std::string text = "Einfallswinkel: 20\u00B0\nWinkel;BRDF\n-75;0,25\n75;0,5\n";
  EXPECT_THAT(Problem(text),
              HasSubstr("line 2: the header has no column theta_o; if it is 'Winkel'"));
  EXPECT_EQ(Source("x.csv", text).Read({.columns = "theta_o=Winkel"}).samples.size(), 2);
  EXPECT_THAT(Problem("Harvey plot\n|B-Bo|\tBSDF\n0.001\t0.1\n0.002\t0.1\n"),
              HasSubstr("|beta - beta0|"));
}

TEST(TableAdvice, AnExampleHasAsManyColumns) {
  EXPECT_THAT(Problem("30,10,0.5\n30,20,0.5\n"), HasSubstr("--columns=theta_i,theta_o,f names"));
  EXPECT_THAT(Problem("30;0;10;0;0.5\n30;0;20;0;0.5\n"),
              HasSubstr("--columns=theta_i,phi_i,theta_o,phi_o,f names"));
}

TEST(TableAdvice, ALineOfCountsIsNoExample) {
  EXPECT_THAT(Problem("52 5 -1.000\n30 0 10 0 0.5\n30 0 20 0 0.5\n"),
              HasSubstr("--columns=theta_i,phi_i,theta_o,phi_o,f names"));
}

TEST(TableAdvice, AMatrixHasThreeNumberedNames) {
  EXPECT_THAT(Problem("theta_o,at 10 deg,at 30 deg,at 50 deg\n10,1,2,3\n"),
              HasSubstr("--columns=theta_o/theta_i"));
  EXPECT_THAT(Problem("theta_o,BRDF,at 10 deg,at 30 deg,at 50 deg\n10,1,2,3,4\n"),
              Not(HasSubstr("theta_o/theta_i")));
  EXPECT_THAT(Problem("sample,20\u00B0,60\u00B0,85\u00B0\nA,1,2,3\nB,1,2,3\n"), HasSubstr("gloss"));
}

TEST(TableAdvice, WhatIsNoBrdfIsNamedBeforeAngles) {
  EXPECT_THAT(Problem("theta_i,phi_i,theta_t,phi_t,BTDF\n0,0,0,0,1\n"), HasSubstr("transmitted"));
  for (const std::string head : {"theta_m,NDF", "half angle (deg),D(h)", "theta,ndf"}) {
    EXPECT_THAT(Problem(head + "\n0,3\n2,2\n4,1\n"), HasSubstr("distribution of normals")) << head;
  }
  EXPECT_THAT(Problem("kx_in,ky_in,kz_in,kx_out,ky_out,kz_out,BRDF\n0,0,1,0,0,1,1\n"),
              HasSubstr("directions are vectors"));
}

TEST(TableAdvice, MarkupAndOtherJsonAreNamed) {
  for (const std::string text :
       {"<!-- saved -->\n<html><p>theta_i,f</p></html>\n", "<head><title>x</title></head>\n"}) {
    EXPECT_THAT(Problem(text), HasSubstr("a web page"));
  }
  EXPECT_THAT(Problem("{\"theta_i\": 1}\n{\"theta_i\": 2}\n"), HasSubstr("lines of JSON"));
  EXPECT_THAT(Problem("[[30, 10, 1], [30, 20, 1]]\n"), HasSubstr("a list in JSON"));
  EXPECT_THAT(Problem("{\"message\": \"Not Found\"}\n"),
              HasSubstr("with no columns theta_i, theta_o and brdf"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
