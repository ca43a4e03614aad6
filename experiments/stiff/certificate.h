#ifndef TRILOBE_EXPERIMENTS_STIFF_CERTIFICATE_H_
#define TRILOBE_EXPERIMENTS_STIFF_CERTIFICATE_H_

#include <string>
#include <string_view>
#include <vector>

#include "experiments/stiff/cases.h"

namespace trilobe {

// The answer to a case, and how certain it is. All but `model` and the counts come from fifty-digit
// arithmetic.
struct Certificate {
  std::string name;
  int samples = 0, parameters = 0;

  double objective = 0;        // the lowest E found
  std::string objective_text;  // the same, 30 digits
  double measured_energy = 0;  // sum w rho*^2
  bool exact = false;          // E is 0 but for the rounding of the measured values

  // Why to believe it.
  double relative_decrease = 0;  // relative decrease of E that a further Newton step promises
  double optimality = 0;         // scaled projected gradient (docs/solvers.md)
  int starts = 0, agreeing = 0;  // how many were tried, how many came to this E
  struct StationaryPoint {
    double objective = 0;
    int starts = 0;
  };
  std::vector<StationaryPoint> others;  // ends of the other starts, lowest E first

  // Second order, of the parameters that are free (> 0, or 0 without a force that holds them).
  int free_parameters = 0;
  int flat_directions = 0;     // along which E does not change: scale between factors, and more
  int descent_directions = 0;  // along which E curves down: 0 at a minimum
  // For J with columns of length 1, columns of 0 left out: how many singular values are not 0, and
  // the largest over the smallest of them.
  int rank = 0;
  double condition = 0;

  FactorModel model;  // the minimiser in canonical form
  // Entries that no data touch, or that differ between minimisers, by index in parameters().
  std::vector<int> undetermined;
  // The largest difference of the others between minimisers from different starts, relative to the
  // largest entry of the table.
  double spread = 0;

  // Per parameter: whether all minimisers have the same.
  std::vector<bool> Determined() const;
};

// Finds the answer: minimises in extended precision from the truth, the case's own start, the
// library's deterministic starts and `random_starts` random ones; then the best few in fifty
// digits.
Certificate Certify(const StiffCase& stiff_case, int random_starts);

// All certificates of a file. Throws Error: unreadable, or of other cases than the program's.
std::vector<Certificate> ReadCertificates(const std::string& path);
void WriteCertificates(const std::vector<Certificate>& certificates, const std::string& path);

// Throws Error if a problem is not the one that was certified.
void CheckCertifies(const Certificate& certificate, const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_CERTIFICATE_H_
