#ifndef TRILOBE_FIT_HELD_OUT_ERROR_H_
#define TRILOBE_FIT_HELD_OUT_ERROR_H_

namespace trilobe {

// Error of a fit on samples that it has not seen (FitOptions::held_out).
struct HeldOutError {
  int samples = 0;
  double objective = 0, relative_objective = 0;  // E of these samples, and over a black model's
  double psnr_db = 0, mean_delta_e = 0;          // as of SeenError, each sample being a patch
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_HELD_OUT_ERROR_H_
