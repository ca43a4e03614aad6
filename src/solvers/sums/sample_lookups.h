#ifndef TRILOBE_SOLVERS_SUMS_SAMPLE_LOOKUPS_H_
#define TRILOBE_SOLVERS_SUMS_SAMPLE_LOOKUPS_H_

#include <functional>
#include <vector>

#include "solvers/sums/parameter_kind.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// Residuals rho - rho* and slopes d rho / d lookup of batches of samples, by the lookups D_t, F_t,
// G_t(theta_i) and G_t(theta_o) in all tables t of a model. Each batch reads the tables anew: to
// keep what all samples read takes more memory than the samples. (BatchEvaluator has lanes of lobes
// in the place of those of samples, and rounds otherwise.)
class SampleLookups {
 public:
  // Samples per batch.
  static constexpr int kBatch = 64;

  // Residuals of a batch and their slopes in the lookups of one kind. Numbers beyond the size of
  // the batch are finite and meaningless.
  struct Batch {
    Batch(const ModelSpec& spec, ParameterKind kind);

    const double* Slope(int c, int t) const { return &slope[(c * tables + t) * kBatch]; }
    double* Slope(int c, int t) { return &slope[(c * tables + t) * kBatch]; }

    ParameterKind kind;
    int tables;                    // of amplitudes: d, and s of each lobe
    std::vector<double> residual;  // rho - rho*. [kChannels][kBatch]
    // d rho / d lookup; 1 for d, and of G, d rho / d (G_i G_o). [kChannels][tables][kBatch]
    std::vector<double> slope;
    std::vector<double> D, F, G_i, G_o;  // lookups. [num_tables][kBatch]
  };

  // The samples must outlive this.
  SampleLookups(const FoldedSamples& samples, const ModelSpec& spec, int num_threads);

  // The end of the range of tables of D from this one on that share a stretch.
  int EndOfStretch(int d_table) const;

  // Sets the tables that are read. Amplitudes are those of the model that each function below is
  // given.
  void SetTables(const FactorModel& model);

  // Evaluates samples [begin, end), at most kBatch.
  void Evaluate(int begin, int end, const FactorModel& model, Batch* batch) const;

  // Computes only the slopes of Evaluate in a table of G, which do not depend on G.
  void SlopesInG(int table, int begin, int end, const FactorModel& model, Batch* batch) const;

  // Reads a table of G for all samples, at the first and at the second direction. [samples]
  void ReadG(int table, std::vector<double>* G_i, std::vector<double>* G_o) const;

  const FoldedSamples& samples() const { return samples_; }
  const ModelSpec& spec() const { return spec_; }
  int num_threads() const { return num_threads_; }
  // Calls work(begin, end) for all samples, in chunks of whole batches.
  void ForChunks(const std::function<void(int, int)>& work) const;

 private:
  // At most kVector tables that are read by the same lookup (of G: lookups), side by side.
  struct Group {
    Factor factor;
    int first, last;
    std::vector<double> values;  // [entries][kVector]
  };
  // Reads samples [begin, end) of a group by a lookup; the target of table t of its factor begins
  // at target + (t - first_target) * stride.
  void ReadBy(int lookup, const Group& group, int begin, int end, double* target, int first_target,
              int stride) const;
  void ReadBatch(bool with_G, int begin, int end, Batch* batch) const;

  const FoldedSamples& samples_;
  const ModelSpec spec_;
  const int num_threads_;
  std::vector<Group> groups_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_SAMPLE_LOOKUPS_H_
