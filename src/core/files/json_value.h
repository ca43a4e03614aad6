#ifndef TRILOBE_CORE_FILES_JSON_VALUE_H_
#define TRILOBE_CORE_FILES_JSON_VALUE_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// The largest useful JSON file here is a model of 8 lobes with 72 different tables of 1024 entries,
// all stored as nodes and listed as unobserved: 221,184 numbers, 2 MB with a table per line, 9 MB
// with a number per line. A scene can have 150,000 single directions; for more, use a histogram.
inline constexpr size_t kMaxJsonBytes = size_t{1} << 24;
inline constexpr size_t kMaxJsonValues = size_t{1} << 20;  // keys count, too

// Limits on the size of a text; files with long tables need higher ones. A value takes 56 bytes of
// memory.
struct JsonLimits {
  size_t bytes = kMaxJsonBytes, values = kMaxJsonValues;
};

// A value of a JSON text (RFC 8259), read with nothing but the standard library, so that a library
// that only evaluates models needs no other. Strict: no comments, no trailing commas, no repeated
// keys, no numbers that a double cannot hold, UTF-8 only (a byte order mark may stand before it),
// and at most 64 levels.
class JsonValue {
 public:
  enum class Type { kNull, kBoolean, kNumber, kString, kArray, kObject };

  // The one value that the text holds. It keeps views of `text`, which must outlive it.
  // Throws Error "FILE: OTHERWISE: line 3, column 7: ..." if the text is not JSON, and "FILE:
  // OTHERWISE: ..." before anything is allocated if it is beyond the limits above. `otherwise` may
  // say what the file is then, as "not a model file".
  static JsonValue Parse(std::string_view text, const std::string& file,
                         const std::string& otherwise = "", const JsonLimits& limits = {});

  Type type() const { return type_; }
  const char* type_name() const;  // "null", "boolean", "number", "string", "array", "object"

  // Each requires a value of its type.
  bool boolean() const { return text_ == "true"; }
  double number() const;
  std::string_view number_text() const { return text_; }  // as it was written
  std::string string() const;

  // The items of an array, or the members of an object in file order.
  size_t size() const { return type_ == Type::kObject ? parts_.size() / 2 : parts_.size(); }
  const JsonValue& operator[](size_t k) const {
    return type_ == Type::kObject ? parts_[2 * k + 1] : parts_[k];
  }
  std::string key(size_t k) const { return parts_[2 * k].string(); }
  const JsonValue* Find(std::string_view key) const;  // null if the object has no such key

 private:
  friend class JsonParser;

  Type type_ = Type::kNull;
  std::string_view text_;         // of a number, a word, or a string with its quotes
  std::vector<JsonValue> parts_;  // of an array; of an object, each key before its value
};

// The text of a file for JsonValue::Parse. Throws Error as ReadFile does, and "PATH: OTHERWISE:
// ..." before it is read if it is beyond the limit above.
std::string ReadJsonText(const std::string& path, const std::string& otherwise);

}  // namespace trilobe

#endif  // TRILOBE_CORE_FILES_JSON_VALUE_H_
