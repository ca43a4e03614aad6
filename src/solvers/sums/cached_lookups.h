#ifndef TRILOBE_SOLVERS_SUMS_CACHED_LOOKUPS_H_
#define TRILOBE_SOLVERS_SUMS_CACHED_LOOKUPS_H_

#include <functional>
#include <vector>

#include "solvers/sums/parameter_kind.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// Caches the lookups D_t, F_t, G_t(theta_i) and G_t(theta_o) of all samples in all tables t of a
// model; only changed tables are read again. Computes residuals rho - rho* and slopes d rho / d
// lookup of batches from them. (BatchEvaluator reads all tables and caches nothing.)
class CachedLookups {
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
  };

  // The samples must outlive this.
  CachedLookups(const FoldedSamples& samples, const ModelSpec& spec, int num_threads);

  // The end of the range of tables of D from this one on that share a stretch.
  int EndOfStretch(int d_table) const;

  // Reads all tables, or tables [first, last) of a factor.
  void Read(const FactorModel& model);
  void Read(const FactorModel& model, Factor factor, int first, int last);

  // Lookups of a table of G at the first and at the second direction. [samples]
  std::vector<double>& G_i(int table) { return G_i_[table]; }
  std::vector<double>& G_o(int table) { return G_o_[table]; }

  // Evaluates samples [begin, end), at most kBatch. The tables of the model must have been read.
  void Evaluate(int begin, int end, const FactorModel& model, Batch* batch) const;

  const FoldedSamples& samples() const { return samples_; }
  const ModelSpec& spec() const { return spec_; }
  int num_threads() const { return num_threads_; }
  // Calls work(begin, end) for all samples, in chunks of whole batches.
  void ForChunks(const std::function<void(int, int)>& work) const;

 private:
  // Reads tables by one of the lookups into to[first .. last).
  void ReadBy(int lookup, const FactorModel& model, int first, int last,
              std::vector<std::vector<double>>* target);

  const FoldedSamples& samples_;
  const ModelSpec spec_;
  const int num_threads_;
  std::vector<std::vector<double>> D_, F_, G_i_, G_o_;  // [num_tables][samples]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_CACHED_LOOKUPS_H_
