#include "core/system/evaluation_count.h"

#include <utility>

namespace trilobe {
namespace {

thread_local EvaluationCount* here = nullptr;

}  // namespace

CountEvaluations::CountEvaluations(EvaluationCount* count) : outer_(std::exchange(here, count)) {}

CountEvaluations::~CountEvaluations() { here = outer_; }

EvaluationCount* CountHere() { return here; }

void CountValues(int64_t count) {
  if (here != nullptr) here->values += count;
}

void CountDerivatives(int64_t count) {
  if (here != nullptr) here->derivatives += count;
}

}  // namespace trilobe
