#ifndef TRILOBE_MODEL_WEIGHTING_H_
#define TRILOBE_MODEL_WEIGHTING_H_

#include <string>
#include <string_view>
#include <vector>

namespace trilobe {

// A named choice of the weights w of E = sum w (rho - rho*)^2 (docs/method.md). Pure: a weight
// depends on one measurement alone.
struct Weighting {
  std::string name;
  std::string description;  // one line: formula and source
  bool scale_free = false;  // the weight does not depend on the measured value
  // rho_star [1/sr], finite and >= 0; cos_i in (0, 1]. Finite and >= 0.
  double (*weight)(double rho_star, double cos_i) = nullptr;
};

// All of them, the default one first.
const std::vector<Weighting>& Weightings();

// Throws Error that lists the known names.
const Weighting& FindWeighting(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_WEIGHTING_H_
