#ifndef TRILOBE_IO_FORMATS_STRETCH_JSON_H_
#define TRILOBE_IO_FORMATS_STRETCH_JSON_H_

#include "trilobe/model/model_spec.h"

namespace trilobe {

// JSON of stretches in model files, reports and `info`: an object for one; of a spec one for all
// lobes, or a list with one per lobe. Json is nlohmann::ordered_json, a parameter so that library
// users do not need it.
template <typename Json>
Json StretchToJson(const Stretch& stretch) {
  return {{"along", stretch.along}, {"across", stretch.across}};
}

template <typename Json>
Json StretchesToJson(const ModelSpec& spec) {
  if (!spec.stretches.several()) return StretchToJson<Json>(spec.stretches.of(0));
  Json list = Json::array();
  for (int m = 0; m < spec.lobes; ++m) {
    list.push_back(StretchToJson<Json>(spec.stretches.of(m)));
  }
  return list;
}

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_STRETCH_JSON_H_
