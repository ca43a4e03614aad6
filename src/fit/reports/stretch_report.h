#ifndef TRILOBE_FIT_REPORTS_STRETCH_REPORT_H_
#define TRILOBE_FIT_REPORTS_STRETCH_REPORT_H_

#include <string>

#include "fit/reports/print.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

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

#endif  // TRILOBE_FIT_REPORTS_STRETCH_REPORT_H_
