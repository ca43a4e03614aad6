#ifndef TRILOBE_APP_STRETCH_REPORT_H_
#define TRILOBE_APP_STRETCH_REPORT_H_

#include <nlohmann/json.hpp>
#include <string>

#include "trilobe/app/print.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// As reports and `info` have it: that of all lobes, or a list of those of each.
inline nlohmann::ordered_json StretchesToJson(const ModelSpec& spec) {
  const auto to_json = [](const Stretch& stretch) {
    return nlohmann::ordered_json{{"along", stretch.along}, {"across", stretch.across}};
  };
  if (!spec.stretches.several()) return to_json(spec.stretches.of(0));
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (int m = 0; m < spec.lobes; ++m) list.push_back(to_json(spec.stretches.of(m)));
  return list;
}

// "along 0.5, across -0.2", or that of each lobe where they differ.
inline std::string DescribeStretches(const ModelSpec& spec) {
  const auto describe = [](const Stretch& stretch) {
    return "along " + Text(stretch.along, 3) + ", across " + Text(stretch.across, 3);
  };
  if (!spec.stretches.several()) return describe(spec.stretches.of(0));
  std::string text;
  for (int m = 0; m < spec.lobes; ++m) {
    text += (m > 0 ? "; lobe " : "lobe ") + std::to_string(m + 1) + " " +
            describe(spec.stretches.of(m));
  }
  return text;
}

}  // namespace trilobe

#endif  // TRILOBE_APP_STRETCH_REPORT_H_
