#ifndef TRILOBE_IO_MODEL_FILES_STRETCH_JSON_H_
#define TRILOBE_IO_MODEL_FILES_STRETCH_JSON_H_

#include "trilobe/model/model_spec.h"

namespace trilobe {

// As model files, reports and `info` have it: that of all lobes, or a list of those of each. Json:
// nlohmann::ordered_json, which users of the library need not have.
template <typename Json>
Json StretchesToJson(const ModelSpec& spec) {
  const auto to_json = [](const Stretch& stretch) {
    return Json{{"along", stretch.along}, {"across", stretch.across}};
  };
  if (!spec.stretches.several()) return to_json(spec.stretches.of(0));
  Json list = Json::array();
  for (int m = 0; m < spec.lobes; ++m) list.push_back(to_json(spec.stretches.of(m)));
  return list;
}

}  // namespace trilobe

#endif  // TRILOBE_IO_MODEL_FILES_STRETCH_JSON_H_
