#ifndef TRILOBE_EXPERIMENTS_LIMITS_COMPARE_FORMS_H_
#define TRILOBE_EXPERIMENTS_LIMITS_COMPARE_FORMS_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/limits/term_model.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/fit.h"

namespace trilobe {

// Fit of one form (TermForms) to a measurement. E is relative to that of a black model.
struct FormFit {
  std::string form;
  TermModel model;  // fitted to all samples that are used
  double objective = 0;
  // E on a fifth of the blocks of 2 degrees by 2 (HeldOutPart), when fitted to the rest.
  double held_out = 0;
  int steps = 0;
  bool converged = false;
  double seconds = 0;
};

struct CompareFormsOptions {
  std::vector<std::string> forms;  // names of TermForms; the paper's is added in front
  bool bands = false;              // channels are the wavelengths of the samples
  uint64_t seed = 1;               // of the blocks
  StopCheck stop = {};
  std::function<void(const FormFit&)> on_form = nullptr;  // after each
};

// Fits each form from `start`, a model of the paper's form (TermModel::Of), by FitTerms, to the
// samples of the problem, with a prior's if there is one and channels are R, G and B; of a table to
// some 32 samples a parameter, in all its places. Forms that cannot be made of the start are an
// Error, as are unknown names and too few samples to hold out some. If stopped, those that are
// finished.
std::vector<FormFit> CompareForms(const FitProblem& problem, const TermModel& start,
                                  const CompareFormsOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_LIMITS_COMPARE_FORMS_H_
