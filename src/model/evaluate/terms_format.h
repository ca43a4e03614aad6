#ifndef TRILOBE_MODEL_EVALUATE_TERMS_FORMAT_H_
#define TRILOBE_MODEL_EVALUATE_TERMS_FORMAT_H_

namespace trilobe {

// Shared by the reader and the writer of models of terms.

inline constexpr const char* kTermsFormat = "trilobe-terms";
inline constexpr int kTermsVersion = 1;
// Names of Axis::Rule, in its order; kPolar is not of these models.
inline constexpr const char* kAxisRules[] = {"root_theta", "theta", "spline"};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_TERMS_FORMAT_H_
