#include "core/files/content.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "tests/core/files/first_bytes.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using Kind = Content::Kind;

void Check(const std::string& bytes, Kind kind, const std::string& name) {
  const Content content = RecogniseContent(bytes);
  EXPECT_EQ(content.kind, kind) << bytes.substr(0, 64);
  EXPECT_EQ(content.name, name);
}

TEST(Content, IsRecognisedByItsFirstBytes) {
  Check("", Kind::kUnknown, "");
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
  Check(dashes + "\xc3", Kind::kText, "text");  // in Latin-1
  Check(dashes + "\x80", Kind::kUnknown, "");
  Check(std::string("notes\n\0", 7), Kind::kUnknown, "");
  Check("\x89PNG\r\n\x1a\n", Kind::kForeign, "a PNG picture");
  Check("\x89HDF\r\n\x1a\n", Kind::kForeign, "an HDF5 file");
  Check("PK\x03\x04", Kind::kForeign, "a ZIP archive; unpack it");
  Check("\x1F\x8B\x08", Kind::kForeign, "a gzip file; unpack it");
  Check("#?RADIANCE\n", Kind::kForeign, "a Radiance picture");
  Check("v/1\x01", Kind::kForeign, "an OpenEXR picture");
}

TEST(Content, IsAskedOfTheBeginningOfAFile) {
  const TestDirectory directory;
  EXPECT_EQ(BeginningOf(directory.Make("long", std::string(1000, 'x'))), std::string(256, 'x'));
  EXPECT_EQ(BeginningOf(directory.Make("short", kJson)), kJson);
  EXPECT_EQ(BeginningOf(directory.Path("missing")), "");
}

TEST(Content, OfAPipeIsNotWaitedFor) {
  const TestDirectory directory;
  ASSERT_EQ(mkfifo(directory.Path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(BeginningOf(directory.Path("pipe")), "");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
