#ifndef TRILOBE_FIT_ANISOTROPIC_FORMS_H_
#define TRILOBE_FIT_ANISOTROPIC_FORMS_H_

#include <string>
#include <vector>

#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// A form that --model=auto tries.
struct AnisotropicForm {
  std::string name;  // "as fitted", "4 lobes", "D by channel"
  ModelSpec spec;
};

// Forms of at most so many parameters, `by_default` or what comes nearest to it first: each with D
// and G on the finest nodes that keep to the budget. What another lobe or tables by channel cost is
// saved on nodes. None are finer than those of `by_default` but where the budget is above its size,
// nor than what data at so many directions tell apart. Throws Error where no nodes are few enough.
std::vector<AnisotropicForm> AnisotropicForms(const ModelSpec& by_default,
                                              const HemisphereGrid& data, int max_parameters);

}  // namespace trilobe

#endif  // TRILOBE_FIT_ANISOTROPIC_FORMS_H_
