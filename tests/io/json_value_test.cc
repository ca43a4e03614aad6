#include "trilobe/io/json_value.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/test_directory.h"

namespace trilobe {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Type = JsonValue::Type;

nlohmann::json Converted(const JsonValue& value, const std::vector<std::string>& keys) {
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
      for (const JsonValue& item : value.items()) json.push_back(Converted(item, keys));
      return json;
    case Type::kObject:
      json = nlohmann::json::object();
      for (const std::string& key : keys) {
        if (const JsonValue* const found = value.Find(key)) json[key] = Converted(*found, keys);
      }
      EXPECT_EQ(json.size(), value.items().size());
      return json;
  }
  return json;
}

// nlohmann's parser is the reference.
TEST(JsonValue, ReadsWhatAnotherParserReads) {
  const std::vector<std::string> keys = {"", "a", "b", "key", "\u00e9", "\U0001d11e"};
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
    EXPECT_EQ(Converted(JsonValue::Parse(text, "t"), keys), expected) << text;
  }
  EXPECT_EQ(JsonValue::Parse("[1.50]", "t").items()[0].number_text(), "1.50");
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
    EXPECT_THAT(ErrorOf([&] { JsonValue::Parse(text, "t"); }), StartsWith("t: line ")) << text;
  }
  // What others let pass.
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse("\xef\xbb\xbf{}", "t"); }),  // a byte order mark
              HasSubstr("line 1, column 1"));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse(R"({"a": 1, "b": 2, "a": 3})", "t"); }),
              HasSubstr("the key 'a' comes twice"));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse("1e999", "t"); }), HasSubstr("out of the range"));
  EXPECT_THAT(ErrorOf([] { JsonValue::Parse(std::string(100000, '['), "t"); }),
              HasSubstr("more than 64 levels"));
}

TEST(JsonValue, ErrorsSayWhere) {
  EXPECT_EQ(ErrorOf([] { JsonValue::Parse("{\n  \"a\": 1,\n  \"b\": x\n}", "file.json"); }),
            "file.json: line 3, column 8: expected a value");
}

}  // namespace
}  // namespace trilobe
