#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

Measurement Parse(const std::string& text) { return ReadAs("radiance", text, "x.xml"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

std::string Document(const std::string& structure, const std::string& rest) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement "
         "xmlns=\"http://windows.lbl.gov\">\n<Optical><Layer>\n<DataDefinition>"
         "<IncidentDataStructure> " +
         structure + " </IncidentDataStructure></DataDefinition>\n" + rest +
         "</Layer></Optical>\n</WindowElement>\n";
}

std::string Data(const std::string& wavelength, const std::string& side, const std::string& block) {
  return "<WavelengthData><Wavelength unit=\"Integral\">" + wavelength +
         "</Wavelength>\n<WavelengthDataBlock><WavelengthDataDirection>" + side +
         "</WavelengthDataDirection>" + block + "</WavelengthDataBlock></WavelengthData>\n";
}

// --- Klems bases ---------------------------------------------------------------------------------

struct Basis {
  std::string name;
  std::vector<double> thetas;  // middles of the rings [degrees]
  std::vector<int> patches;
};
const Basis kFull = {
    "LBNL/Klems Full", {0, 10, 20, 30, 40, 50, 60, 70, 82.5}, {1, 8, 16, 20, 24, 24, 24, 16, 12}};
const Basis kHalf = {
    "LBNL/Klems Half", {0, 13, 26, 39.5, 54, 69, 83.25}, {1, 8, 12, 16, 20, 12, 4}};
const Basis kQuarter = {"LBNL/Klems Quarter", {0, 18, 36.5, 56, 78}, {1, 8, 12, 12, 8}};

// theta and phi of each patch [degrees].
std::vector<std::array<double, 2>> Patches(const Basis& basis) {
  std::vector<std::array<double, 2>> patches;
  for (size_t ring = 0; ring < basis.thetas.size(); ++ring) {
    for (int k = 0; k < basis.patches[ring]; ++k) {
      patches.push_back({basis.thetas[ring], 360.0 * k / basis.patches[ring]});
    }
  }
  return patches;
}

// A row is a direction out and a column one in, or the other way round.
std::string Matrix(const Basis& basis, bool is_by_columns, int channel) {
  std::string text = "<ColumnAngleBasis>" + basis.name + "</ColumnAngleBasis><RowAngleBasis>" +
                     basis.name + "</RowAngleBasis><ScatteringData>\n";
  for (const auto& row : Patches(basis)) {
    for (const auto& column : Patches(basis)) {
      const auto& in = is_by_columns ? column : row;
      const auto& out = is_by_columns ? row : column;
      text += Text(TrueValue(in[0], in[1] + 180, out[0], out[1], true)[channel]) + ",\t";
    }
    text += "\n";
  }
  return text + "</ScatteringData>";
}

TEST(RadianceFile, ReadsBackAKnownMaterial) {
  for (const Basis& basis : {kFull, kHalf, kQuarter}) {
    for (const bool is_by_columns : {true, false}) {
      const Measurement measurement =
          Parse(Document(is_by_columns ? "Columns" : "Rows",
                         Data("Solar", "Reflection Front", "<unread/>") +
                             Data("Visible", "Transmission Front", "<unread/>") +
                             Data("Visible", "Reflection Front", Matrix(basis, is_by_columns, 1))));
      const size_t patches = Patches(basis).size();
      EXPECT_EQ(measurement.counts.total, patches * patches) << basis.name;
      EXPECT_TRUE(measurement.anisotropic);
      EXPECT_THAT(measurement.notes, ElementsAre("read as: Reflection Front, Visible"));
      ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
    }
  }
}

TEST(RadianceFile, TheBackIsReadIfThereIsNoFront) {
  const std::string matrix = Matrix(kQuarter, true, 1);
  std::string data;
  for (const char* const wavelength : {"CIE-X", "Visible", "CIE-Z"}) {
    data += Data(wavelength, "reflection back", matrix);
  }
  const Measurement measurement = Parse(Document("Columns", data));
  EXPECT_THAT(measurement.notes,
              ElementsAre("read as: Reflection Back, X, Y, Z relative to white"));
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true, 1e-5);
  EXPECT_THAT(ParseError(Document("Columns", Data("Visible", "Transmission Front", matrix))),
              IsError(ErrorKind::kUnsupported, {.line = 3, .key = "WavelengthData"}));
}

TEST(RadianceFile, BasesThatTheFileDefines) {
  const std::string basis =
      "<AngleBasis><AngleBasisName>mine</AngleBasisName><AngleBasisBlock><nPhis>1</nPhis>"
      "<ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>20</UpperTheta></ThetaBounds>"
      "</AngleBasisBlock><AngleBasisBlock><nPhis>3</nPhis><ThetaBounds><LowerTheta>20</LowerTheta>"
      "<UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
  std::string text = Document(
      "Columns", Data("Visible", "Reflection Front", Matrix({"mine", {0, 55}, {1, 3}}, true, 1)));
  EXPECT_THAT(ParseError(text), IsError(ErrorKind::kUnknown,
                                        {.line = 6, .key = "ColumnAngleBasis", .value = "mine"}));
  text.insert(text.find("</DataDefinition>"), basis);
  const Measurement measurement = Parse(text);
  EXPECT_EQ(measurement.counts.total, 16);
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
  EXPECT_THAT(ParseError(text.replace(text.find("<nPhis>3"), 8, "<nPhis>1e9")),
              IsError(ErrorKind::kRange, {.line = 4, .key = "nPhis"}));
}

// --- Tensor trees --------------------------------------------------------------------------------

// The point of the disk, by the regions of Shirley and Chiu's paper.
std::array<double, 2> OfSquare(double x, double y) {
  const double a = 2 * x - 1, b = 2 * y - 1;
  double r = 0, phi = 0;
  if (a > -b && a > b) {
    r = a, phi = kPi / 4 * (b / a);
  } else if (a > -b) {
    r = b, phi = kPi / 4 * (2 - a / b);
  } else if (a < b) {
    r = -a, phi = kPi / 4 * (4 + b / a);
  } else if (b != 0) {
    r = -b, phi = kPi / 4 * (6 - a / b);
  }
  return {r * std::cos(phi), r * std::sin(phi)};
}

Direction Above(double x, double y) { return {x, y, std::sqrt(std::max(1 - x * x - y * y, 0.0))}; }

std::string TruthOf(const std::vector<double>& x) {
  DirectionPair pair;
  if (x.size() == 3) {
    const auto out = OfSquare(x[1], x[2]);
    pair = {Above(2 * x[0] - 1, 0), Above(out[0], out[1])};
  } else {
    const auto in = OfSquare(x[0], x[1]), out = OfSquare(x[2], x[3]);
    pair = {Above(-in[0], -in[1]), Above(out[0], out[1])};
  }
  return Text(TrueMaterial(x.size() == 4).brdf(pair)[1]) + " ";
}

// A grid of 2^level along each axis of a cell, the last axis fastest.
std::string Grid(const std::vector<double>& begin, double size, int level) {
  const int n = 1 << level;
  std::string text = "{";
  std::vector<int> index(begin.size(), 0);
  for (;;) {
    std::vector<double> x = begin;
    for (size_t k = 0; k < x.size(); ++k) x[k] += size / n * (index[k] + 0.5);
    text += TruthOf(x);
    size_t axis = x.size();
    while (axis > 0 && ++index[axis - 1] == n) index[--axis] = 0;
    if (axis == 0) return text + "}\n";
  }
}

// Halves of each axis, the first axis by the lowest bit; the first cell is finer.
std::string Tree(int rank) {
  std::string text = "{";
  for (int child = 0; child < 1 << rank; ++child) {
    std::vector<double> begin(rank);
    for (int k = 0; k < rank; ++k) begin[k] = (child >> k & 1) / 2.0;
    text += Grid(begin, 0.5, child == 0 ? 2 : 1);
  }
  return text + "}";
}

std::string TreeData(const std::string& tree) {
  return Data(
      "Visible", "Reflection Front",
      "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>" + tree + "</ScatteringData>");
}

TEST(RadianceFile, TensorTreesOfRank3AreIsotropic) {
  const Measurement measurement = Parse(Document("TensorTree3", TreeData(Tree(3))));
  EXPECT_EQ(measurement.counts.total, 64 + 3 * 8);  // half of the cells are used
  EXPECT_FALSE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true);
}

TEST(RadianceFile, TensorTreesOfRank4) {
  const Measurement measurement = Parse(Document("TensorTree4", TreeData(Tree(4))));
  EXPECT_EQ(measurement.counts.total, 256 + 15 * 16);
  EXPECT_TRUE(measurement.anisotropic);
  ExpectTruth(measurement, /*grey=*/true, /*anisotropic=*/true);
}

TEST(RadianceFile, ErrorsSayWhereAndWhatIsExpected) {
  EXPECT_THAT(ParseError("<?xml version=\"1.0\"?>\n<WindowElement>\n</WindowElement>\n"),
              IsError(ErrorKind::kMissing, {.file = "x.xml", .line = 2, .key = "Optical"}));
  EXPECT_THAT(
      ParseError("<WindowElement>\n<a></WindowElement>"),
      IsError(ErrorKind::kFormat, {.line = 2, .key = "xml", .value = "Start-end tags mismatch"}));
  EXPECT_THAT(ParseError("<a/>"),
              IsError(ErrorKind::kMissing, {.line = 1, .key = "WindowElement"}));
  EXPECT_THAT(ParseError(Document("Columns", "")),
              IsError(ErrorKind::kMissing, {.line = 3, .key = "WavelengthData"}));
  const std::string matrix = Matrix({"LBNL/Klems Quarter", {0}, {1}}, true, 1);
  EXPECT_THAT(ParseError(Document("Columns", Data("Visible", "Reflection Front", matrix))),
              IsError(ErrorKind::kMismatch, {.line = 6, .key = "ScatteringData", .value = "1"}));
  const auto tree = [](const std::string& text) {
    return ParseError(Document("TensorTree3", TreeData(text)));
  };
  EXPECT_THAT(tree(""),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "{"}));
  EXPECT_THAT(tree("{1 2 3}"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "3"}));
  EXPECT_THAT(tree("{1 x}"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "x"}));
  EXPECT_THAT(tree("{1"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "}"}));
  EXPECT_THAT(tree("{{1}}"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "{"}));
  EXPECT_THAT(tree("{1} 2"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "more"}));
  EXPECT_THAT(tree(std::string(1000, '{')),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "ScatteringData", .value = "levels"}));
  EXPECT_THAT(ParseError(Document("TensorTree5", TreeData("{1}"))),
              IsError(ErrorKind::kUnsupported,
                      {.line = 4, .key = "IncidentDataStructure", .value = "TensorTree5"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
