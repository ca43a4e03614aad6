#ifndef TRILOBE_MODEL_FIT_INFO_H_
#define TRILOBE_MODEL_FIT_INFO_H_

#include <string>

namespace trilobe {

// Provenance of a model. Empty or 0 where unknown.
struct FitInfo {
  std::string solver;
  std::string init;
  std::string weighting;
  double objective = 0;         // E of the stored model, on the measured samples
  double solver_objective = 0;  // E at the end of the solver, before later steps
  double initial_objective = 0;
  std::string stop_reason;
  int iterations = 0;
  double seconds = 0;
  int threads = 0;
  std::string source;              // a path; a model file has the name alone
  std::string source_xxh128 = {};  // checksum of that file, 32 hexadecimal digits
  int valid_samples = 0;
  double max_angle = 0;  // largest theta_i and theta_o of the data [degrees]
  std::string program;   // "trilobe 0.1.0"
  std::string date;      // ISO 8601, UTC
  std::string run = {};  // as in report.json
  std::string key =
      {};  // hash of the measurement, of what flags ask of a model, and of the program
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_FIT_INFO_H_
