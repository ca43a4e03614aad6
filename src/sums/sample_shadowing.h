#ifndef TRILOBE_SUMS_SAMPLE_SHADOWING_H_
#define TRILOBE_SUMS_SAMPLE_SHADOWING_H_

#include <array>
#include <functional>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/objective/folded_samples.h"
#include "trilobe/objective/sample_reader.h"

namespace trilobe {

// Updates of G from the samples, node by node. With all else held, what a table adds to rho_c is
// a_c G_i G_o, so that of a sample's channels only two sums count,
//   A = sum w a^2,  b = sum w a (rho* - rho),
// and a node that moves by delta, and G_i G_o by p1 delta + p2 delta^2 with it, changes E by
//   A p^2 - 2 b p,  p = p1 delta + p2 delta^2,  and b by -A p.
class SampleShadowing {
 public:
  SampleShadowing(const FoldedSamples& samples, const ModelSpec& spec, int num_threads);

  // Reads the samples by a model. The same bits for any number of threads.
  void Read(const FactorModel& model);

  // Puts every node of a table of that model where E is lowest with the others held; tables may
  // follow each other. `on_element`, if set, sees the model after each.
  void UpdateTable(int t, const std::function<void(const FactorModel&)>& on_element,
                   FactorModel* model);

 private:
  // Samples that read a node: as which entry of their cells of theta_i and theta_o, -1 if not.
  struct Readers {
    int begin, end, i, o;
  };

  // What samples read of a table. [samples]
  struct OfTable {
    std::vector<double> G_i, G_o;
    std::vector<std::vector<double>> a;  // of each channel that it serves
  };

  // Calls work(begin, end) for all samples, in chunks.
  void ForChunks(const std::function<void(int, int)>& work) const;
  void SetSums(int t);

  const FoldedSamples& samples_;
  const int num_threads_;
  SampleReader reader_;
  std::vector<std::vector<Readers>> readers_;            // [node]
  std::array<std::vector<double>, kChannels> residual_;  // rho* - rho. [samples]
  std::vector<OfTable> tables_;
  std::vector<double> A_, b_;  // of the table that is updated. [samples]
};

}  // namespace trilobe

#endif  // TRILOBE_SUMS_SAMPLE_SHADOWING_H_
