#ifndef TRILOBE_EXPERIMENTS_STIFF_ANSWERS_H_
#define TRILOBE_EXPERIMENTS_STIFF_ANSWERS_H_

namespace trilobe {

// The file of the certified answers in the tree that this was built from. Only answers.cc is
// compiled with that path, so that a compiler's cache can serve another checkout.
const char* CertifiedAnswers();

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_ANSWERS_H_
