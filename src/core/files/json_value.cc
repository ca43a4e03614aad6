#include "core/files/json_value.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "core/base/text.h"
#include "core/files/file.h"
#include "core/files/utf16.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

constexpr int kMaxDepth = 64;

// The file, and what it is if this error is thrown.
std::string JsonErrorBegin(const std::string& file, const std::string& otherwise) {
  return otherwise.empty() ? file : file + ": " + otherwise;
}

void CheckSize(size_t bytes, size_t most, const std::string& file, const std::string& otherwise) {
  if (bytes > most) {
    throw Error(ErrorKind::kLimit, JsonErrorBegin(file, otherwise) + ": it has " +
                                       std::to_string(bytes) + " bytes; at most " +
                                       std::to_string(most) + " can be read")
        .At(file)
        .About("bytes", bytes);
  }
}

}  // namespace

class JsonParser {
 public:
  JsonParser(std::string_view text, const std::string& file, const std::string& otherwise)
      : text_(text), file_(file), otherwise_(otherwise) {}

  JsonValue ParseText() {
    JsonValue value = ParseValue(0);
    SkipSpace();
    if (at_ < text_.size()) Fail("the text goes on after its end");
    return value;
  }

  std::string ParseString() {
    if (!Take('"')) Fail("expected a string");
    std::string string;
    while (!Take('"')) {
      if (at_ >= text_.size()) Fail("a string does not end");
      if (Take('\\')) {
        ParseEscape(&string);
        continue;
      }
      if (static_cast<unsigned char>(Peek()) < ' ') Fail("a control character in a string");
      const size_t length = Utf8Length(text_.substr(at_));
      if (length == 0) Fail("not UTF-8");
      string.append(text_, at_, length);
      at_ += length;
    }
    return string;
  }

 private:
  using Type = JsonValue::Type;

  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kFormat) const {
    const std::string_view before = text_.substr(0, at_);
    const size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    const auto line = static_cast<int>(1 + std::ranges::count(before, '\n'));
    const std::string column = std::to_string(at_ - line_begin + 1);
    throw Error(kind, JsonErrorBegin(file_, otherwise_) + ": line " + std::to_string(line) +
                          ", column " + column + ": " + problem)
        .At(file_, line)
        .About("column", column);
  }

  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool Take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void SkipSpace() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  JsonValue ParseValue(int depth) {
    if (depth > kMaxDepth) {
      Fail("more than " + std::to_string(kMaxDepth) + " levels", ErrorKind::kLimit);
    }
    SkipSpace();
    switch (Peek()) {
      case '{':
        return ParseObject(depth);
      case '[':
        return ParseArray(depth);
      case '"':
        return ParseStringValue();
      case 't':
        return ParseWord("true", Type::kBoolean);
      case 'f':
        return ParseWord("false", Type::kBoolean);
      case 'n':
        return ParseWord("null", Type::kNull);
      default:
        return ParseNumber();
    }
  }

  JsonValue ParseWord(std::string_view word, Type type) {
    if (!text_.substr(at_).starts_with(word)) Fail("expected a value");
    JsonValue value;
    value.type_ = type;
    value.text_ = text_.substr(at_, word.size());
    at_ += word.size();
    return value;
  }

  void SkipDigits() {
    if (Peek() < '0' || Peek() > '9') Fail("expected a digit");
    while (Peek() >= '0' && Peek() <= '9') ++at_;
  }

  JsonValue ParseNumber() {
    const size_t begin = at_;
    if (Peek() != '-' && (Peek() < '0' || Peek() > '9')) Fail("expected a value");
    Take('-');
    if (!Take('0')) SkipDigits();
    if (Take('.')) SkipDigits();
    if (Take('e') || Take('E')) {
      if (!Take('+')) Take('-');
      SkipDigits();
    }
    JsonValue value;
    value.type_ = Type::kNumber;
    value.text_ = text_.substr(begin, at_ - begin);
    double number = 0;
    if (std::from_chars(value.text_.data(), value.text_.data() + value.text_.size(), number).ec !=
        std::errc()) {
      at_ = begin;
      Fail("the number is out of the range of a double", ErrorKind::kRange);
    }
    return value;
  }

  uint32_t ParseFourHexDigits() {
    uint32_t code = 0;
    const std::string_view digits = text_.substr(at_, 4);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (error != std::errc() || end != digits.data() + 4) Fail("expected four hexadecimal digits");
    at_ += 4;
    return code;
  }

  void ParseEscape(std::string* string) {
    constexpr std::string_view kEscapes = "\"\\/bfnrt", kMeanings = "\"\\/\b\f\n\r\t";
    if (const size_t k = kEscapes.find(Peek()); k != std::string_view::npos) {
      string->push_back(kMeanings[k]);
      ++at_;
      return;
    }
    if (!Take('u')) Fail("unknown escape sequence");
    uint32_t code = ParseFourHexDigits();
    if (code >= 0xD800 && code <= 0xDBFF && Take('\\') && Take('u')) {
      const uint32_t low = ParseFourHexDigits();
      if (low < 0xDC00 || low > 0xDFFF) Fail("half of a surrogate pair");
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    }
    if (code >= 0xD800 && code <= 0xDFFF) Fail("half of a surrogate pair");
    AppendUtf8(code, string);
  }

  JsonValue ParseStringValue(std::string* decoded = nullptr) {
    const size_t begin = at_;
    const std::string string = ParseString();
    JsonValue value;
    value.type_ = Type::kString;
    value.text_ = text_.substr(begin, at_ - begin);
    if (decoded != nullptr) *decoded = string;
    return value;
  }

  JsonValue ParseArray(int depth) {
    JsonValue value;
    value.type_ = Type::kArray;
    Take('[');
    SkipSpace();
    if (Take(']')) return value;
    do {
      value.parts_.push_back(ParseValue(depth + 1));
      SkipSpace();
    } while (Take(','));
    if (!Take(']')) Fail("expected ',' or ']'");
    return value;
  }

  JsonValue ParseObject(int depth) {
    JsonValue value;
    value.type_ = Type::kObject;
    Take('{');
    SkipSpace();
    if (Take('}')) return value;
    std::vector<std::string> keys;
    do {
      SkipSpace();
      value.parts_.push_back(ParseStringValue(&keys.emplace_back()));
      SkipSpace();
      if (!Take(':')) Fail("expected ':'");
      value.parts_.push_back(ParseValue(depth + 1));
      SkipSpace();
    } while (Take(','));
    if (!Take('}')) Fail("expected ',' or '}'");
    std::ranges::sort(keys);
    if (const auto twice = std::ranges::adjacent_find(keys); twice != keys.end()) {
      Fail("the key '" + *twice + "' comes twice in the object that ends here; keep one",
           ErrorKind::kConflict);
    }
    return value;
  }

  const std::string_view text_;
  const std::string& file_;
  const std::string& otherwise_;
  size_t at_ = 0;
};

JsonValue JsonValue::Parse(std::string_view text, const std::string& file,
                           const std::string& otherwise, const JsonLimits& limits) {
  CheckSize(text.size(), limits.bytes, file, otherwise);
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  // Each value but the first comes after one of these.
  const auto values = 1 + std::ranges::count_if(text, [](char c) {
                        return c == ',' || c == ':' || c == '[' || c == '{';
                      });
  if (static_cast<size_t>(values) > limits.values) {
    throw Error(ErrorKind::kLimit, JsonErrorBegin(file, otherwise) + ": it has about " +
                                       std::to_string(values) + " values; at most " +
                                       std::to_string(limits.values) + " can be read")
        .At(file)
        .About("values", values);
  }
  return JsonParser(text, file, otherwise).ParseText();
}

const char* JsonValue::type_name() const {
  constexpr const char* kNames[] = {"null", "boolean", "number", "string", "array", "object"};
  return kNames[static_cast<int>(type_)];
}

double JsonValue::number() const {
  double number = 0;
  std::from_chars(text_.data(), text_.data() + text_.size(), number);
  return number;
}

std::string JsonValue::string() const { return JsonParser(text_, "", "").ParseString(); }

const JsonValue* JsonValue::Find(std::string_view key) const {
  for (size_t k = 0; k < size(); ++k) {
    if (this->key(k) == key) return &(*this)[k];
  }
  return nullptr;
}

std::string ReadJsonText(const std::string& path, const std::string& otherwise) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (!error) CheckSize(size, kMaxJsonBytes, path, otherwise);
  return ReadFile(path);
}

}  // namespace trilobe
