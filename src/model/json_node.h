#ifndef TRILOBE_MODEL_JSON_NODE_H_
#define TRILOBE_MODEL_JSON_NODE_H_

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/files/json_value.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

// A value of a model file with its path, such as `D[2][17]`, for messages.
class JsonNode {
 public:
  JsonNode(const JsonValue& json, std::string key, const std::string& source)
      : json_(json), key_(std::move(key)), source_(source) {}

  // Throws Error about the path.
  [[noreturn]] void Fail(const std::string& problem, ErrorKind kind = ErrorKind::kRange,
                         std::string_view value = "") const {
    throw ErrorIn(kind, source_, "key '" + key_ + "' " + problem).About(key_, value);
  }

  bool has(const std::string& key) const { return json_.Find(key) != nullptr; }
  bool is_object() const { return json_.type() == Type::kObject; }
  bool is_array() const { return json_.type() == Type::kArray; }

  JsonNode operator[](const std::string& key) const {
    const std::string path = key_.empty() ? key : key_ + "." + key;
    const JsonValue* const found = json_.Find(key);
    if (found == nullptr) JsonNode(json_, path, source_).Fail("is missing", ErrorKind::kMissing);
    return {*found, path, source_};
  }

  JsonNode operator[](size_t index) const {
    return {json_[index], key_ + "[" + std::to_string(index) + "]", source_};
  }

  const std::string& source() const { return source_; }

  const JsonNode& CheckObject() const {
    CheckType(Type::kObject, "an object");
    return *this;
  }

  size_t ArraySize() const {
    CheckType(Type::kArray, "an array");
    return json_.size();
  }

  void CheckArraySize(size_t size) const {
    if (ArraySize() != size) {
      Fail("must have " + std::to_string(size) + " entries, not " + std::to_string(ArraySize()),
           ErrorKind::kMismatch, std::to_string(ArraySize()));
    }
  }

  double Number() const {
    CheckType(Type::kNumber, "a number");
    if (json_.number() < 0) {
      Fail("must be finite and >= 0, not " + NumberText(), ErrorKind::kRange, NumberText());
    }
    return json_.number();
  }

  // An exponent, from -2 to 2.
  double Exponent() const {
    CheckType(Type::kNumber, "a number");
    if (!(std::abs(json_.number()) <= 2)) {
      Fail("must be from -2 to 2, not " + NumberText(), ErrorKind::kRange, NumberText());
    }
    return json_.number();
  }

  int Integer(int max) const {
    const double value = Number();
    if (value != std::floor(value) || value > max) {
      Fail("must be an integer from 0 to " + std::to_string(max) + ", not " + NumberText(),
           ErrorKind::kRange, NumberText());
    }
    return static_cast<int>(value);
  }

  bool Bool() const {
    CheckType(Type::kBoolean, "true or false");
    return json_.boolean();
  }

  std::string String() const {
    CheckType(Type::kString, "a string");
    return json_.string();
  }

  void Numbers(std::span<double> values) const {
    CheckArraySize(values.size());
    for (size_t k = 0; k < values.size(); ++k) values[k] = (*this)[k].Number();
  }

 private:
  using Type = JsonValue::Type;

  void CheckType(Type type, const std::string& expected) const {
    if (json_.type() != type) {
      Fail("must be " + expected + ", not " + json_.type_name(), ErrorKind::kFormat,
           json_.type_name());
    }
  }
  std::string NumberText() const { return std::string(json_.number_text()); }

  const JsonValue& json_;
  std::string key_;
  const std::string& source_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_JSON_NODE_H_
