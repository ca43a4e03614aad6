// Every format that is written is read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(WriteMeasurement, IsReadBackInEveryFormatThatIsWritten) {
  const TestDirectory directory;
  int written = 0;
  for (const MeasurementFormat& format : MeasurementFormats()) {
    if (format.write == nullptr) continue;
    ++written;
    const std::string path = directory.Path("x" + format.ending);
    const Measurement measured =
        LoadMeasurement(format.holds_anisotropic ? "synth:linen@6x48" : "synth:felt");
    EXPECT_EQ(&WritableFormat(path), &format);
    const std::string said = WriteMeasurement(measured, path);
    EXPECT_THAT(said, testing::StartsWith(format.written_as + ", "));
    const Measurement back = LoadMeasurement(path);
    EXPECT_EQ(CountsOf(back).valid, CountsOf(measured).valid) << format.name;
    const BrdfSamples before = SamplesOf(measured), after = SamplesOf(back);
    ASSERT_EQ(after.size(), before.size());
    for (int j = 0; j < before.size(); j += 997) {
      for (int c = 0; c < kChannels; ++c) EXPECT_DOUBLE_EQ(after.rho[j][c], before.rho[j][c]);
    }
  }
  EXPECT_EQ(written, 3);
}

TEST(WriteMeasurement, NamesTheEndingsThatThereAre) {
  EXPECT_EQ(WritableFormat("x").name, "merl");
  EXPECT_THAT(
      ErrorOf([] { WritableFormat("x.exr"); }),
      IsError(ErrorKind::kUnsupported, {.file = "x.exr", .key = "ending", .value = ".exr"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
