#include "experiments/stiff/answers.h"

namespace trilobe {

const char* CertifiedAnswers() { return TRILOBE_STIFF_ANSWERS; }

}  // namespace trilobe
