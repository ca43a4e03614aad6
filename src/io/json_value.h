#ifndef TRILOBE_IO_JSON_VALUE_H_
#define TRILOBE_IO_JSON_VALUE_H_

#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// A value of a JSON text (RFC 8259), read with nothing but the standard library, so that a library
// that only evaluates models needs no other. Strict: no comments, no trailing commas, no repeated
// keys, no numbers that a double cannot hold, UTF-8 only, and at most 64 levels.
class JsonValue {
 public:
  enum class Type { kNull, kBoolean, kNumber, kString, kArray, kObject };

  // The one value that the text holds. It keeps views of `text`, which must outlive it.
  // Throws Error "WHAT: line 3, column 7: ..." if the text is not JSON.
  static JsonValue Parse(std::string_view text, const std::string& what);

  Type type() const { return type_; }
  const char* type_name() const;  // "null", "boolean", "number", "string", "array", "object"

  // Each for values of its type alone.
  bool boolean() const { return text_ == "true"; }
  double number() const { return number_; }
  std::string_view number_text() const { return text_; }  // as it was written
  const std::string& string() const { return string_; }
  const std::vector<JsonValue>& items() const { return items_; }
  const JsonValue* Find(std::string_view key) const;  // null if the object has no such key

 private:
  friend class JsonParser;

  Type type_ = Type::kNull;
  double number_ = 0;
  std::string_view text_;  // of a number, or a word
  std::string string_;
  std::vector<JsonValue> items_;   // of an array; of an object, in the order of its keys
  std::vector<std::string> keys_;  // of an object, sorted
};

}  // namespace trilobe

#endif  // TRILOBE_IO_JSON_VALUE_H_
