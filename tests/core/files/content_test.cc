#include "trilobe/core/files/content.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "io/pictures/image_file.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/io/model_files/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using Kind = Content::Kind;
using testing::StartsWith;

// ASCII text in UTF-16, after `mark`.
std::string Utf16(const std::string& mark, const std::string& text, bool little_endian) {
  std::string wide = mark;
  for (const char c : text) {
    wide.push_back(little_endian ? c : '\0');
    wide.push_back(little_endian ? '\0' : c);
  }
  return wide;
}

const std::string kJson =
    "{\"format\": \"trilobe-model\", \"version\": 1, \"kind\": \"isotropic\"}";

void Check(const std::string& bytes, Kind kind, const std::string& name) {
  const Content content = RecogniseContent(bytes);
  EXPECT_EQ(content.kind, kind) << bytes.substr(0, 64);
  EXPECT_EQ(content.name, name);
}

TEST(Content, IsRecognisedByItsFirstBytes) {
  const std::string merl("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12);
  Check("", Kind::kUnknown, "");
  Check(merl, Kind::kMerl, "a MERL measurement");
  Check(std::string(kTensorMagic) + "\1", Kind::kTensor, "an RGL measurement");
  Check("NVIDIA ARC MBSDF V1\nname=\"x\"\n", Kind::kMbsdf, "an MBSDF measurement");
  const std::string csv = "# mine\n\n phi_i, theta_i ,r\r\n";
  Check(csv, Kind::kCsv, "samples in CSV");
  Check("\xEF\xBB\xBF" + csv, Kind::kCsv, "samples in CSV");
  Check("a theta_i,phi_i\n", Kind::kText, "text");
  Check("TITLE theta_i\n" + std::string(5000, '-') + "\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n",
        Kind::kAstm, "an ASTM E1392 measurement");
  Check("TITLE VARS theta_i\n", Kind::kText, "text");
  Check("# wls\n31\n\n# nm\n400 410\n", Kind::kCornell, "spectra as Cornell measured them");
  Check("31\n1 2 3\n", Kind::kText, "text");
  Check("1\n400\n", Kind::kText, "text");
  Check(kJson, Kind::kJson, "a JSON file");
  Check("\xEF\xBB\xBF \n" + kJson, Kind::kJson, "a JSON file");
  Check(Utf16("\xFF\xFE", kJson, true), Kind::kForeign, "a JSON file in UTF-16; save it as UTF-8");
  Check(Utf16("\xFE\xFF", kJson, false), Kind::kForeign, "a JSON file in UTF-16; save it as UTF-8");
  Check(Utf16("", kJson, true), Kind::kForeign, "a JSON file in UTF-16; save it as UTF-8");
  Check(Utf16("", kJson, false), Kind::kForeign, "a JSON file in UTF-16; save it as UTF-8");
  Check(Utf16("\xFF\xFE", "notes", true), Kind::kForeign, "text in UTF-16; save it as UTF-8");
  Check("notes on a cheese\n", Kind::kText, "text");
  Check("\xEF\xBB\xBFnotes", Kind::kText, "text");
  const std::string dashes = "---------------------------------------------------------------";
  Check(dashes + "\u00e9, cut in the middle by the look at 64 bytes", Kind::kText, "text");
  Check(dashes + "\xc3", Kind::kUnknown, "");
  // What is wrong further on is for the reader to say.
  Check(csv + std::string("1,\0,2\n", 6), Kind::kCsv, "samples in CSV");
  Check(std::string("31\n400 410\n\0", 12), Kind::kCornell, "spectra as Cornell measured them");
  Check(std::string("notes\n\0", 7), Kind::kUnknown, "");
  Check("\x89PNG\r\n\x1a\n", Kind::kForeign, "a PNG picture");
  Check("\x89HDF\r\n\x1a\n", Kind::kForeign, "an HDF5 file");
  Check("PK\x03\x04", Kind::kForeign, "a ZIP archive; unpack it");
  Check("\x1F\x8B\x08", Kind::kForeign, "a gzip file; unpack it");
  Check("#?RADIANCE\n", Kind::kForeign, "a Radiance picture");
  Check("v/1\x01", Kind::kForeign, "an OpenEXR picture");
  Check(std::string(1990656, '\0'), Kind::kUtia,
        "a UTIA measurement (288 x 288 x 3 doubles, by its size)");
  Check("# by me\nSource \tMeasured\r\nSymmetry\tAsymmetrical\n", Kind::kZemax, "a Zemax BSDF");
  Check("Source\tSimulated\n", Kind::kText, "text");
  Check(std::string(1990655, '\0'), Kind::kUnknown, "");
}

TEST(Content, IsNamedByEveryReader) {
  const auto source_error = [](const std::string& bytes) {
    return ErrorOf([&] { TableOf(Source("f", bytes).Read()); });
  };
  const std::string as_utf16 = Utf16("\xFF\xFE", kJson, true);
  EXPECT_THAT(source_error(as_utf16),
              StartsWith("f: this is a JSON file in UTF-16; save it as UTF-8; a measurement is a"));
  EXPECT_THAT(source_error("\xEF\xBB\xBF" + kJson), StartsWith("f: this is a JSON file; "));
  EXPECT_THAT(source_error("\x89HDF\r\n\x1a\n"), StartsWith("f: this is an HDF5 file; "));
  EXPECT_THAT(source_error("#?RADIANCE\n"), StartsWith("f: this is a Radiance picture; "));
  const auto model_error = [](const std::string& bytes) {
    return ErrorOf([&] { CheckMayBeJson(RecogniseContent(bytes), "f: not a model file"); });
  };
  EXPECT_EQ(model_error(as_utf16),
            "f: not a model file: this is a JSON file in UTF-16; save it as UTF-8");
  EXPECT_EQ(model_error(std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12)),
            "f: not a model file: this is a MERL measurement");
  EXPECT_EQ(model_error(std::string(1990656, '\0')),
            "f: not a model file: this is a UTIA measurement (288 x 288 x 3 doubles, by its size)");
  EXPECT_EQ(ErrorOf([] { ParseProbe("\x89PNG\r\n\x1a\n", "f"); }),
            "f: not a Radiance picture but a PNG picture; give a light probe as a lat-long .hdr "
            "file");
}

// Before its size is looked at, or its bytes are.
TEST(Content, OfALargeFileIsNamed) {
  const TestDirectory directory;
  const std::string path =
      directory.Make("a.binary", std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12));
  std::filesystem::resize_file(path, 34992012);
  EXPECT_EQ(ErrorOf([&] { CheckMayBeJson(RecogniseFile(path), path); }),
            path + ": this is a MERL measurement");
}

TEST(Content, OfAPipeIsNotWaitedFor) {
  const TestDirectory directory;
  ASSERT_EQ(mkfifo(directory.Path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(RecogniseFile(directory.Path("pipe")).kind, Kind::kUnknown);
  EXPECT_THAT(ErrorOf([&] { ReadModel(directory.Path("pipe")); }),
              testing::HasSubstr("it is not a regular file"));
}

TEST(Content, AByteOrderMarkBeforeAModelDoesNoHarm) {
  const std::string text = FormatModel(ModelFile());
  EXPECT_EQ(FormatModel(ParseModel("\xEF\xBB\xBF" + text, "f")),
            FormatModel(ParseModel(text, "f")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
