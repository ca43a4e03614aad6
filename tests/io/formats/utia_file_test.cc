#include "io/formats/databases/utia_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kNodes = 288, kPlane = kNodes * kNodes;

// The numbers of a file, as the format's description has them.
class UtiaNumbers {
 public:
  explicit UtiaNumbers(double value) : numbers_(3 * kPlane, value) {}
  explicit UtiaNumbers(const Measurement& measurement) : UtiaNumbers(-1) {
    for (int j = 0; j < measurement.samples.size(); ++j) {
      const SphericalAngles& at = measurement.samples.directions[j];
      const int row = Node(at.theta_i, at.phi_i), column = Node(at.theta_o, at.phi_o);
      for (int c = 0; c < 3; ++c) numbers_[Index(c, row, column)] = measurement.samples.rho[j][c];
    }
  }
  static int Index(int channel, int row, int column) {
    return channel * kPlane + row * kNodes + column;
  }
  static int Node(double theta, double phi) {
    return static_cast<int>(48 * std::lround(RadiansToDegrees(theta) / 15) +
                            std::lround(RadiansToDegrees(phi) / 7.5));
  }

  double& operator()(int channel, int row, int column) {
    return numbers_[Index(channel, row, column)];
  }
  std::string Bytes() const {
    std::string bytes(numbers_.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), numbers_.data(), bytes.size());
    return bytes;
  }

 private:
  std::vector<double> numbers_;
};

Measurement Parse(const UtiaNumbers& numbers, const std::string& radiometry = "brdf") {
  return ParseUtia(numbers.Bytes(), "x.bin", radiometry);
}

TEST(UtiaFile, RowsAreIncidentAndColumnsOutgoingDirections) {
  UtiaNumbers numbers(1);
  for (int c = 0; c < 3; ++c) numbers(c, 48 * 2 + 5, 48 * 4 + 47) = 10 + c;
  const Measurement measurement = Parse(numbers);
  EXPECT_EQ(measurement.kind, "UTIA measurement");
  EXPECT_TRUE(measurement.anisotropic);
  EXPECT_FALSE(measurement.table);
  EXPECT_EQ(measurement.counts.valid, kPlane);
  const int j = (48 * 2 + 5) * kNodes + 48 * 4 + 47;
  const SphericalAngles at = measurement.samples.directions[j];
  EXPECT_NEAR(RadiansToDegrees(at.theta_i), 30, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(at.phi_i), 37.5, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(at.theta_o), 60, 1e-12);
  EXPECT_NEAR(RadiansToDegrees(at.phi_o), 352.5, 1e-12);
  EXPECT_THAT(measurement.samples.rho[j], ElementsAre(10, 11, 12));
  EXPECT_NEAR(MaxAngleDegrees(measurement), 75, 1e-12);
  // phi is that of the file where it means nothing.
  EXPECT_NEAR(RadiansToDegrees(measurement.samples.directions[7 * kNodes].phi_i), 52.5, 1e-12);
  EXPECT_NO_THROW(CheckSamples(SamplesOf(measurement)));
}

TEST(UtiaFile, CountsWhatIsNotValid) {
  UtiaNumbers numbers(0.5);
  numbers(0, 3, 4) = -1e-9;
  numbers(1, 3, 4) = std::nan("");  // not finite, whatever the others
  numbers(2, 9, 9) = std::numeric_limits<double>::infinity();
  numbers(1, 200, 100) = -3;
  const Measurement measurement = Parse(numbers);
  EXPECT_EQ(measurement.counts.total, kPlane);
  EXPECT_EQ(measurement.counts.non_finite, 2);
  EXPECT_EQ(measurement.counts.negative, 1);
  EXPECT_EQ(measurement.counts.valid, kPlane - 3);
  EXPECT_EQ(measurement.samples.size(), kPlane - 3);
}

TEST(UtiaFile, RadiometriesSayWhatTheNumbersAre) {
  UtiaNumbers numbers(0.5);
  numbers(0, 0, 0) = -0.1;
  const auto last = [&](const std::string& radiometry) {  // theta_i = 75 degrees
    return Parse(numbers, radiometry).samples.rho.back()[0];
  };
  EXPECT_EQ(last("brdf"), 0.5);
  EXPECT_NEAR(last("cosine"), 0.5 / std::cos(DegreesToRadians(75)), 1e-12);
  EXPECT_NEAR(last("srgb"), 0.21404114, 1e-8);  // IEC 61966-2-1
  EXPECT_NEAR(last("dj_brdf"), 100 * 0.5 / 140 / 12.92, 1e-12);
  EXPECT_EQ(Parse(numbers, "srgb").counts.negative, 1);
  EXPECT_EQ(Parse(numbers, "dj_brdf").counts.negative, 0);  // it sets them to 0
  EXPECT_THAT(ErrorOf([&] { last("gamma"); }),
              IsError(ErrorKind::kUnknown, {.key = "radiometry", .value = "gamma"}));
  const TestDirectory directory;
  const std::string path = directory.Make("x.bin", numbers.Bytes());
  EXPECT_NEAR(LoadMeasurement(path, {.radiometry = "srgb"}).samples.rho.back()[0], 0.21404114,
              1e-8);
}

TEST(UtiaFile, IsToldBySizeAndByEnding) {
  const TestDirectory directory;
  const std::string bytes = UtiaNumbers(0.25).Bytes();
  EXPECT_EQ(LoadMeasurement(directory.Make("any.name", bytes)).kind, "UTIA measurement");
  EXPECT_THAT(ErrorOf([&] { Source("x.bin", bytes.substr(8)).Read(); }),
              IsError(ErrorKind::kFormat, {.file = "x.bin", .key = "bytes", .value = "1990648"}));
  EXPECT_THAT(ErrorOf([&] { Source("x.bin", bytes + "12345678").Read(); }),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "1990664"}));
  EXPECT_THAT(ErrorOf([&] { Source("x.binary", bytes.substr(8)).Read(); }),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "0 x 1070596096 x 0"}));
}

TEST(UtiaFile, WritesWhatItReads) {
  const TestDirectory directory;
  const Measurement charmeuse = LoadMeasurement("synth:charmeuse", {.noise = 0.1, .missing = 0.05});
  const std::string path = directory.Path("charmeuse.bin");
  WriteUtia(charmeuse, path);
  const std::string bytes = TestDirectory::Content(path);
  EXPECT_TRUE(bytes == UtiaNumbers(charmeuse).Bytes());
  const Measurement read = LoadMeasurement(path);
  EXPECT_EQ(read.samples.rho, charmeuse.samples.rho);
  EXPECT_EQ(read.counts.negative, charmeuse.counts.missing);  // the only mark of the format
  WriteUtia(read, path);
  EXPECT_TRUE(TestDirectory::Content(path) == bytes);
}

TEST(UtiaFile, HasNoPlaceForOtherDirections) {
  const TestDirectory directory;
  const auto error_of = [&](const SphericalAngles& degrees) {
    SampleCollector collector("x.csv", "list");
    for (const double theta_o : {15.0, degrees.theta_o}) {
      collector.Add({DegreesToRadians(degrees.theta_i), DegreesToRadians(degrees.phi_i),
                     DegreesToRadians(theta_o), DegreesToRadians(degrees.phi_o)},
                    {1, 1, 1});
    }
    return ErrorOf([&] { WriteUtia(collector.Take(), directory.Path("x.bin")); });
  };
  EXPECT_THAT(error_of({15, 0, 20, 0}),
              IsError(ErrorKind::kMismatch, {.file = "x.csv", .key = "sample", .value = "1"}));
  EXPECT_THAT(error_of({15, 5, 30, 0}),
              IsError(ErrorKind::kMismatch, {.key = "sample", .value = "0"}));
  EXPECT_THAT(error_of({15, 0, 15, 0}),
              IsError(ErrorKind::kConflict, {.key = "sample", .value = "1"}));
  EXPECT_THAT(directory.Names(), IsEmpty());
  SampleCollector collector("x.csv", "list");
  collector.Add({DegreesToRadians(15), DegreesToRadians(-7.5), 0, 2 * kPi}, {1, 2, 3});
  EXPECT_NO_THROW(WriteUtia(collector.Take(), directory.Path("x.bin")));
}

// A file with its numbers in an order in which somebody else might have written them.
std::string InOtherOrder(UtiaNumbers numbers, bool rows_by_phi, bool columns_by_phi,
                         bool interleaved) {
  UtiaNumbers other(0);
  const auto place = [](int node, bool by_phi) {
    return by_phi ? 6 * (node % 48) + node / 48 : node;
  };
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < kNodes; ++i) {
      for (int o = 0; o < kNodes; ++o) {
        const int pair = place(i, rows_by_phi) * kNodes + place(o, columns_by_phi);
        const int index = interleaved ? 3 * pair + c : c * kPlane + pair;
        other(index / kPlane, index % kPlane / kNodes, index % kNodes) = numbers(c, i, o);
      }
    }
  }
  return other.Bytes();
}

TEST(UtiaFile, ANoteTellsNumbersInAnotherOrder) {
  const std::vector<const char*> names = {"charmeuse",
                                          "velvet",
                                          "linen",
                                          "rolled_brass",
                                          "varnished_plywood",
                                          "aniso_ggx_steel",
                                          "aniso_ggx_lacquer",
                                          "plastic@6x48",
                                          "felt@6x48"};
  for (const char* const& name : names) {
    SCOPED_TRACE(name);
    if (kSanitized && name != std::string_view("felt@6x48")) continue;
    const Measurement measurement =
        LoadMeasurement(std::string("synth:") + name, {.noise = 0.03, .missing = 0.01});
    const UtiaNumbers numbers(measurement);
    EXPECT_THAT(Parse(numbers).notes, IsEmpty());
    for (int k = 1; k < 8; ++k) {
      if (!IsOneIn(3, {k, NumberOf(name, names)})) continue;  // three materials in each order
      const bool rows = (k & 1) != 0, columns = (k & 2) != 0, interleaved = (k & 4) != 0;
      const auto notes =
          ParseUtia(InOtherOrder(numbers, rows, columns, interleaved), "x.bin").notes;
      ASSERT_EQ(notes.size(), 1) << k;
      EXPECT_THAT(notes[0], StartsWith("the numbers look as if they stood in another order: "));
      EXPECT_EQ(notes[0].find("side by side") != std::string::npos, interleaved) << notes[0];
      const char* const what = rows && columns ? "directions by azimuth, 6 b + a"
                               : rows          ? "incident directions by azimuth"
                               : columns       ? "outgoing directions by azimuth"
                                               : "order: R, G and B";
      EXPECT_THAT(notes[0], HasSubstr(what)) << k;
    }
  }
}

TEST(UtiaFile, NoNoteWhereNoOrderIsBetter) {
  for (const char* name : {"charmeuse", "aniso_ggx_steel", "foam@6x48"}) {
    EXPECT_THAT(
        Parse(UtiaNumbers(LoadMeasurement(std::string("synth:") + name, {.noise = 0.5}))).notes,
        IsEmpty())
        << name;
  }
  EXPECT_THAT(Parse(UtiaNumbers(0)).notes, IsEmpty());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
