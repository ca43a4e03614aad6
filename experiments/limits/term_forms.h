#ifndef TRILOBE_EXPERIMENTS_LIMITS_TERM_FORMS_H_
#define TRILOBE_EXPERIMENTS_LIMITS_TERM_FORMS_H_

#include <string>
#include <vector>

#include "experiments/limits/term_model.h"

namespace trilobe {

// A form that adds a term to that of a fitted model, or changes one, as answers to the limits that
// the paper names (its section 4): diffuse light by Lambert, G without correlation.
struct TermForm {
  std::string name;         // "diffuse_table"
  std::string description;  // one line
  // A model to start from, made of one of the paper's form (TermModel::Of), whose values it has or
  // is close to. Throws Error for one without lobes that needs some.
  TermModel (*from)(const TermModel& paper);
};

// The paper's own form first.
const std::vector<TermForm>& TermForms();

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_LIMITS_TERM_FORMS_H_
