#ifndef TRILOBE_IO_MODEL_FILES_STRETCH_JSON_H_
#define TRILOBE_IO_MODEL_FILES_STRETCH_JSON_H_

#include "trilobe/model/model_spec.h"

namespace trilobe {

// JSON of stretches in model files, reports and `info`: one object for all lobes, or a list with
// one per lobe. Json is nlohmann::ordered_json, a parameter so that library users do not need it.
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
