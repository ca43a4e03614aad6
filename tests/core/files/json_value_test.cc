#include "core/files/json_value.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/system/process.h"
#include "tests/error_of.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using Type = JsonValue::Type;

nlohmann::json Converted(const JsonValue& value) {
  nlohmann::json json;
  switch (value.type()) {
    case Type::kNull:
      return nullptr;
    case Type::kBoolean:
      return value.boolean();
    case Type::kNumber:
      return value.number();
    case Type::kString:
      return value.string();
    case Type::kArray:
      json = nlohmann::json::array();
      for (size_t k = 0; k < value.size(); ++k) json.push_back(Converted(value[k]));
      return json;
    case Type::kObject:
      json = nlohmann::json::object();
      for (size_t k = 0; k < value.size(); ++k) {
        json[value.key(k)] = Converted(value[k]);
        EXPECT_EQ(value.Find(value.key(k)), &value[k]);
      }
      EXPECT_EQ(value.Find("none"), nullptr);
      return json;
  }
  return json;
}

// nlohmann's parser is the reference.
TEST(JsonValue, ReadsWhatAnotherParserReads) {
  const std::vector<std::string> good = {"null",
                                         "true",
                                         " false\r\n",
                                         "0",
                                         "-0",
                                         "12.5e-3",
                                         "1E+2",
                                         "0.1",
                                         "-7e0",
                                         "5e-324",
                                         "1.7976931348623157e308",
                                         R"("")",
                                         R"("\"\\\/\b\f\n\r\t\u0041\u00e9\u20ac\ud834\udd1e")",
                                         "\"\u00e9\u20ac\U0001d11e\x7f\"",
                                         "[]",
                                         "[ ]",
                                         "[1,[2,[]],{}]",
                                         "{}",
                                         "{ }",
                                         R"({"b": [1, 2], "a": {"key": null}, "": "x"})",
                                         "{\"\u00e9\":1,\"\\ud834\\udd1e\":2}",
                                         "\t[\n1 ,\r2 ]\n"};
  for (const std::string& text : good) {
    const nlohmann::json expected = nlohmann::json::parse(text);
    EXPECT_EQ(Converted(JsonValue::Parse(text, "t")), expected) << text;
  }
  EXPECT_EQ(JsonValue::Parse("[1.50]", "t")[0].number_text(), "1.50");
}

TEST(JsonValue, RefusesWhatIsNone) {
  const std::vector<std::string> bad = {"",
                                        " ",
                                        "nul",
                                        "nullx",
                                        "tru",
                                        "True",
                                        "+1",
                                        "01",
                                        "1.",
                                        ".5",
                                        "1e",
                                        "1e+",
                                        "--1",
                                        "0x1",
                                        "NaN",
                                        "1 2",
                                        R"(")",
                                        R"("\")",
                                        R"("\x")",
                                        R"("\u12g4")",
                                        R"("\u12")",
                                        R"("\ud834")",
                                        R"("\ud834x")",
                                        R"("\ud834\u0041")",
                                        R"("\udd1e")",
                                        "\"\n\"",
                                        "\"\x1f\"",
                                        "[",
                                        "[1",
                                        "[1,",
                                        "[1,]",
                                        "[,1]",
                                        "[1 2]",
                                        "]",
                                        "{",
                                        R"({"a")",
                                        R"({"a":)",
                                        R"({"a":1)",
                                        R"({"a":1,)",
                                        R"({"a":1,})",
                                        "{a:1}",
                                        "{1:1}",
                                        R"({"a" 1})",
                                        R"({"a":1 "b":2})",
                                        "// x\n1",
                                        "\"\xff\"",
                                        "\"\xc0\x80\"",
                                        "\"\xed\xa0\x80\"",
                                        "\"\xf4\x90\x80\x80\"",
                                        "\"\xe2\x82\"",
                                        std::string("1\0", 2),
                                        std::string("\"\0\"", 3)};
  for (const std::string& text : bad) {
    EXPECT_FALSE(nlohmann::json::accept(text) && text.find('\0') == std::string::npos) << text;
    EXPECT_THAT(ErrorOf([&] { JsonValue::Parse(text, "t"); }),
                IsError(ErrorKind::kFormat, {.file = "t", .line = 1, .key = "column"}))
        << text;
  }
  // Other parsers accept duplicate keys, numbers out of range and any depth.
  EXPECT_THAT(
      ErrorOf([] { JsonValue::Parse(R"({"a": 1, "b": 2, "a": 3})", "t"); }),
      IsError(ErrorKind::kConflict, {.file = "t", .line = 1, .key = "column", .value = "25"}));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse("1e999", "t"); }),
              IsError(ErrorKind::kRange, {.file = "t", .line = 1, .key = "column", .value = "1"}));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse(std::string(100000, '['), "t"); }),
              IsError(ErrorKind::kLimit, {.file = "t", .line = 1, .key = "column", .value = "66"}));
}

TEST(JsonValue, AByteOrderMarkMayStandInFront) {
  EXPECT_EQ(JsonValue::Parse("\xef\xbb\xbf{}", "t").type(), Type::kObject);
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse("\xef\xbb\xbf", "t"); }),
              IsError(ErrorKind::kFormat, {.file = "t", .line = 1, .key = "column", .value = "1"}));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse("{\xef\xbb\xbf}", "t"); }),
              IsError(ErrorKind::kFormat, {.file = "t", .line = 1, .key = "column", .value = "2"}));
}

// How much `call` raises the resident memory at most [bytes].
int64_t PeakOf(const std::function<void()>& call) {
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak is what is resident now
  const int64_t before = PeakMemory().value();
  call();
  return PeakMemory().value() - before;
}

// The greatest number of values takes about a hundred megabytes; more are refused at no cost.
TEST(JsonValue, LimitsAreCheckedBeforeAnythingIsAllocated) {
  std::string most = "[0";
  for (size_t k = 2; k < kMaxJsonValues; ++k) most += ",0";
  const std::string text = most + "]";
  const int64_t peak =
      PeakOf([&] { EXPECT_EQ(JsonValue::Parse(text, "t").size(), kMaxJsonValues - 1); });
  EXPECT_GT(peak, 40 << 20);  // so that the test sees what it looks for
  EXPECT_LT(peak, 200 << 20);
  const auto error_of = [](const std::string& refused) {
    std::optional<Error> error;
    EXPECT_LT(PeakOf([&] { error = ErrorOf([&] { JsonValue::Parse(refused, "t"); }); }),
              4 << 20);  // allowance for the process and its sanitizers
    return error;
  };
  EXPECT_THAT(error_of(most + ",0]"),
              IsError(ErrorKind::kLimit, {.file = "t", .key = "values", .value = "1048577"}));
  EXPECT_THAT(error_of(std::string(kMaxJsonBytes + 1, ' ')),
              IsError(ErrorKind::kLimit, {.file = "t", .key = "bytes", .value = "16777217"}));
}

TEST(JsonValue, AFileThatIsTooLargeIsNotRead) {
  const TestDirectory directory;
  const std::string path = directory.Make("huge.json", "{}");
  EXPECT_EQ(ReadJsonText(path, "not a t"), "{}");
  // The first error takes room of its own.
  EXPECT_THAT(ErrorOf([&] { ReadJsonText(directory.Path("none"), "not a t"); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("none"),
                                         .key = "read",
                                         .value = "No such file or directory"}));
  std::filesystem::resize_file(path, size_t{1} << 29);  // sparse: zeros that take no room
  const int64_t peak = PeakOf([&] {
    EXPECT_THAT(ErrorOf([&] { ReadJsonText(path, "not a t"); }),
                IsError(ErrorKind::kLimit, {.file = path, .key = "bytes", .value = "536870912"}));
  });
  EXPECT_LT(peak, 1 << 20);
}

TEST(JsonValue, ErrorsSayWhere) {
  EXPECT_THAT(
      ErrorOf([] { JsonValue::Parse("{\n  \"a\": 1,\n  \"b\": x\n}", "file.json"); }),
      IsError(ErrorKind::kFormat, {.file = "file.json", .line = 3, .key = "column", .value = "8"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
