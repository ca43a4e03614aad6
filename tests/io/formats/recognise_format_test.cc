// Formats are recognised by content and size, and readers name a file that is not theirs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "core/files/content.h"
#include "io/pictures/image_file.h"
#include "tests/core/files/first_bytes.h"
#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Name of the format; "" if no format recognises the bytes.
std::string FormatOf(const std::string& bytes) {
  const MeasurementFormat* const format = RecogniseFormat(bytes);
  return format == nullptr ? "" : format->name;
}

TEST(RecogniseFormat, GoesByTheFirstBytes) {
  const std::string merl("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12);
  EXPECT_EQ(FormatOf(""), "");
  EXPECT_EQ(FormatOf(merl), "merl");
  EXPECT_EQ(FormatOf(merl.substr(0, 11)), "");
  EXPECT_EQ(FormatOf(std::string("tensor_file\0\1", 13)), "rgl");
  EXPECT_EQ(FormatOf("NVIDIA ARC MBSDF V1\nname=\"x\"\n"), "mbsdf");
  EXPECT_EQ(FormatOf("\x89PNG\r\n\x1a\n"), "");
  EXPECT_EQ(FormatOf(kJson), "");
  EXPECT_EQ(FormatOf("notes on a cheese\n"), "");
}

TEST(RecogniseFormat, GoesByTheFirstLinesOfAText) {
  const std::string csv = "# mine\n\n phi_i, theta_i ,r\r\n";
  EXPECT_EQ(FormatOf(csv), "csv");
  EXPECT_EQ(FormatOf("\xEF\xBB\xBF" + csv), "csv");
  EXPECT_EQ(FormatOf("a theta_i,phi_i\n"), "");
  EXPECT_EQ(FormatOf("TITLE theta_i\n" + std::string(5000, '-') +
                     "\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n"),
            "astm");
  EXPECT_EQ(FormatOf("TITLE VARS theta_i\n"), "");
  EXPECT_EQ(FormatOf("# wls\n31\n\n# nm\n400 410\n"), "cornell");
  EXPECT_EQ(FormatOf("31\n1 2 3\n"), "");
  EXPECT_EQ(FormatOf("1\n400\n"), "");
  EXPECT_EQ(FormatOf("# by me\nSource \tMeasured\r\nSymmetry\tAsymmetrical\n"), "zemax");
  EXPECT_EQ(FormatOf("Source\tSimulated\n"), "");
  EXPECT_EQ(FormatOf("Source Measured\nSymmetry Asymmetric\n"), "lighttools");
  // Errors further on are left to the reader.
  EXPECT_EQ(FormatOf(csv + std::string("1,\0,2\n", 6)), "csv");
  EXPECT_EQ(FormatOf(std::string("31\n400 410\n\0", 12)), "cornell");
}

TEST(RecogniseFormat, GoesByTheSizeOfAUtiaTable) {
  EXPECT_EQ(FormatOf(std::string(1990656, '\0')), "utia");
  EXPECT_EQ(FormatOf(std::string(1990655, '\0')), "");
  EXPECT_EQ(FormatOf(std::string(1990656, 'x')), "");
  const std::string csv = "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
  EXPECT_EQ(FormatOf(csv + std::string(1990656 - csv.size(), '\0')), "csv");
}

TEST(RecogniseFormat, IsWhatEveryReaderNames) {
  const auto source_error = [](const std::string& bytes) {
    return ErrorOf([&] { Source("f", bytes).Read(); });
  };
  const std::string as_utf16 = Utf16("\xFF\xFE", kJson, true);
  EXPECT_THAT(
      source_error(as_utf16),
      IsError(ErrorKind::kUnsupported,
              {.file = "f", .key = "content", .value = "a JSON file in UTF-16; save it as UTF-8"}));
  EXPECT_THAT(
      source_error("\xEF\xBB\xBF" + kJson),
      IsError(ErrorKind::kUnsupported, {.file = "f", .key = "content", .value = "a JSON file"}));
  EXPECT_THAT(
      source_error("\x89HDF\r\n\x1a\n"),
      IsError(ErrorKind::kUnsupported, {.file = "f", .key = "content", .value = "an HDF5 file"}));
  EXPECT_THAT(source_error("#?RADIANCE\n"),
              IsError(ErrorKind::kUnsupported,
                      {.file = "f", .key = "content", .value = "a Radiance picture"}));
  const auto model_error = [](const std::string& bytes) {
    return ErrorOf([&] { CheckMayBeJson(bytes, "f", "not a model file"); });
  };
  EXPECT_THAT(
      model_error(as_utf16),
      IsError(ErrorKind::kFormat,
              {.file = "f", .key = "content", .value = "a JSON file in UTF-16; save it as UTF-8"}));
  EXPECT_THAT(
      model_error(std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12)),
      IsError(ErrorKind::kFormat, {.file = "f", .key = "content", .value = "a MERL .binary file"}));
  EXPECT_THAT(
      model_error(std::string(1990656, '\0')),
      IsError(ErrorKind::kFormat, {.file = "f", .key = "content", .value = "a UTIA .bin file"}));
  EXPECT_THAT(
      ErrorOf([] { ParseProbe("\x89PNG\r\n\x1a\n", "f"); }),
      IsError(ErrorKind::kFormat, {.file = "f", .key = "content", .value = "a PNG picture"}));
}

// The file is named before its size or its bytes are looked at.
TEST(RecogniseFormat, NamesALargeFile) {
  const TestDirectory directory;
  const std::string path =
      directory.Make("a.binary", std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12));
  std::filesystem::resize_file(path, 34992012);
  EXPECT_THAT(ErrorOf([&] { CheckMayBeJson(BeginningOf(path), path); }),
              IsError(ErrorKind::kFormat,
                      {.file = path, .key = "content", .value = "a MERL .binary file"}));
}

TEST(RecogniseFormat, APipeIsNotWaitedFor) {
  const TestDirectory directory;
  ASSERT_EQ(mkfifo(directory.Path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(
      ErrorOf([&] { ReadModel(directory.Path("pipe")); }),
      IsError(ErrorKind::kFile,
              {.file = directory.Path("pipe"), .key = "read", .value = "not a regular file"}));
}

TEST(RecogniseFormat, AByteOrderMarkBeforeAModelDoesNoHarm) {
  const std::string text = FormatModel(ModelFile());
  EXPECT_EQ(FormatModel(ParseModel("\xEF\xBB\xBF" + text, "f")),
            FormatModel(ParseModel(text, "f")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
