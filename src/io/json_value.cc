#include "trilobe/io/json_value.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <system_error>
#include <utility>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

constexpr int kMaxDepth = 64;

// Bytes of the UTF-8 sequence at the start of `text`; 0 if there is none (RFC 3629).
size_t Utf8Length(std::string_view text) {
  const auto byte = [&](size_t k) -> unsigned {
    return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
  };
  const auto follows = [&](size_t k, unsigned low, unsigned high) {
    return byte(k) >= low && byte(k) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1, 0x80, 0xBF) ? 2 : 0;
  // The second byte excludes overlong forms, surrogates, and what is above U+10FFFF.
  const unsigned low = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
  const unsigned high = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
  if (!follows(1, low, high) || !follows(2, 0x80, 0xBF)) return 0;
  if (first >= 0xE0 && first <= 0xEF) return 3;
  return first >= 0xF0 && first <= 0xF4 && follows(3, 0x80, 0xBF) ? 4 : 0;
}

void AppendUtf8(uint32_t code, std::string* text) {
  const auto append = [text](uint32_t byte) { text->push_back(static_cast<char>(byte)); };
  const auto tail = [&](int shift) { append(0x80 | ((code >> shift) & 0x3F)); };
  if (code < 0x80) {
    append(code);
  } else if (code < 0x800) {
    append(0xC0 | (code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    append(0xE0 | (code >> 12));
    tail(6);
    tail(0);
  } else {
    append(0xF0 | (code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

}  // namespace

class JsonParser {
 public:
  JsonParser(std::string_view text, const std::string& what) : text_(text), what_(what) {}

  JsonValue ParseText() {
    JsonValue value = ParseValue(0);
    SkipSpace();
    if (at_ < text_.size()) Fail("the text goes on after its end");
    return value;
  }

 private:
  using Type = JsonValue::Type;

  [[noreturn]] void Fail(const std::string& problem) const {
    const std::string_view before = text_.substr(0, at_);
    const size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
    throw Error(what_ + ": line " + std::to_string(1 + std::ranges::count(before, '\n')) +
                ", column " + std::to_string(at_ - line_begin + 1) + ": " + problem);
  }

  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  bool Take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void SkipSpace() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

  JsonValue ParseValue(int depth) {
    if (depth > kMaxDepth) Fail("more than " + std::to_string(kMaxDepth) + " levels");
    SkipSpace();
    switch (Peek()) {
      case '{':
        return ParseObject(depth);
      case '[':
        return ParseArray(depth);
      case '"': {
        JsonValue value;
        value.type_ = Type::kString;
        value.string_ = ParseString();
        return value;
      }
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
    const char* const end = value.text_.data() + value.text_.size();
    if (std::from_chars(value.text_.data(), end, value.number_).ec != std::errc()) {
      at_ = begin;
      Fail("the number is out of the range of a double");
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

  JsonValue ParseArray(int depth) {
    JsonValue value;
    value.type_ = Type::kArray;
    Take('[');
    SkipSpace();
    if (Take(']')) return value;
    do {
      value.items_.push_back(ParseValue(depth + 1));
      SkipSpace();
    } while (Take(','));
    if (!Take(']')) Fail("expected ',' or ']'");
    return value;
  }

  JsonValue ParseObject(int depth) {
    std::vector<std::pair<std::string, JsonValue>> members;
    Take('{');
    SkipSpace();
    if (!Take('}')) {
      do {
        SkipSpace();
        std::string key = ParseString();
        SkipSpace();
        if (!Take(':')) Fail("expected ':'");
        members.emplace_back(std::move(key), ParseValue(depth + 1));
        SkipSpace();
      } while (Take(','));
      if (!Take('}')) Fail("expected ',' or '}'");
    }
    const auto key_of = [](const auto& member) -> const std::string& { return member.first; };
    std::ranges::sort(members, {}, key_of);
    if (const auto twice = std::ranges::adjacent_find(members, {}, key_of);
        twice != members.end()) {
      Fail("the key '" + twice->first + "' comes twice in the object that ends here");
    }
    JsonValue value;
    value.type_ = Type::kObject;
    for (auto& [key, member] : members) {
      value.keys_.push_back(std::move(key));
      value.items_.push_back(std::move(member));
    }
    return value;
  }

  const std::string_view text_;
  const std::string& what_;
  size_t at_ = 0;
};

JsonValue JsonValue::Parse(std::string_view text, const std::string& what) {
  return JsonParser(text, what).ParseText();
}

const char* JsonValue::type_name() const {
  constexpr const char* kNames[] = {"null", "boolean", "number", "string", "array", "object"};
  return kNames[static_cast<int>(type_)];
}

const JsonValue* JsonValue::Find(std::string_view key) const {
  const auto found = std::ranges::lower_bound(keys_, key);
  return found != keys_.end() && *found == key ? &items_[found - keys_.begin()] : nullptr;
}

}  // namespace trilobe
