#ifndef TRILOBE_FIT_GREEDY_DESIGN_H_
#define TRILOBE_FIT_GREEDY_DESIGN_H_

#include <Eigen/Core>
#include <vector>

#include "trilobe/core/base/channels.h"

namespace trilobe {

// Greedy A-optimal design of experiments (Fedorov 1972). Unknown numbers z have variance 1 each,
// and are independent. A measurement of candidate c tells its three rows of `reads` times z, each
// with noise of variance 1; what ought to be known is `seen` z. Its total variance, the trace of
// seen C seen' under the covariance C of z, falls by
//   tr (I + X C X')^-1 (X C seen') (X C seen')',  X = the rows of c,
// as c is measured, whatever value that has. C begins as I; X C and X C seen' of all candidates are
// kept, and follow each measurement by rank one for each of its channels.
class GreedyDesign {
 public:
  // reads: [candidates * kChannels][unknowns], seen: [any][unknowns].
  GreedyDesign(Eigen::MatrixXd reads, const Eigen::MatrixXd& seen);

  // The total variance of what ought to be known.
  double variance() const { return variance_; }

  // By how much a measurement lowers it, at least 0.
  double Gain(int candidate) const;

  // The candidate of the largest gain that has not been measured, the first of equal ones; -1 if
  // there is none.
  int Best() const;
  int First() const;  // the first one that has not been measured, or -1

  void Measure(int candidate);

 private:
  const Eigen::MatrixXd reads_;
  Eigen::MatrixXd covariances_;  //  reads C
  Eigen::MatrixXd with_seen_;    //  reads C seen'
  double variance_;
  std::vector<bool> measured_;  // of each candidate
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_GREEDY_DESIGN_H_
