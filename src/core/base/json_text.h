#ifndef TRILOBE_CORE_BASE_JSON_TEXT_H_
#define TRILOBE_CORE_BASE_JSON_TEXT_H_

#include <string>

#include "core/base/text.h"

namespace trilobe {

// The text of an nlohmann::json, in valid UTF-8 whatever its strings hold (ValidUtf8). Numbers that
// are not finite are null. `indent` -1: on one line.
template <typename Json>
std::string JsonText(Json json, int indent = -1) {
  const auto make_valid = [](const auto& self, Json* value) -> void {
    if (value->is_string()) *value = ValidUtf8(value->template get_ref<const std::string&>());
    if (!value->is_structured()) return;
    for (Json& inner : *value) self(self, &inner);
  };
  make_valid(make_valid, &json);
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_JSON_TEXT_H_
