#ifndef TRILOBE_SOLVERS_SUMS_CACHED_LOOKUPS_H_
#define TRILOBE_SOLVERS_SUMS_CACHED_LOOKUPS_H_

#include <functional>
#include <vector>

#include "solvers/sums/parameter_kind.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// The lookups D_t, F_t, G_t(theta_i) and G_t(theta_o) of all samples in all tables t of a model,
// kept from sweep to sweep: a table is looked up again only when it has changed. From these follow,
// for a batch of samples, residuals rho - rho* and slopes d rho / d lookup of one kind, without
// reading a table (BatchEvaluator reads all, and keeps none).
class CachedLookups {
 public:
  // Samples that are looked at together.
  static constexpr int kBatch = 64;

  // How the values of one batch move with what they read from tables of one kind. Beyond `size`,
  // numbers are finite and mean nothing.
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

  // The end of the tables of D, from this one on, that are read by one stretch.
  int EndOfStretch(int d_table) const;

  // Reads all tables, or those of a factor [first, last), anew.
  void Read(const FactorModel& model);
  void Read(const FactorModel& model, Factor factor, int first, int last);

  // What a table of G was read as by the first and by the second direction. [samples]
  std::vector<double>& G_i(int table) { return G_i_[table]; }
  std::vector<double>& G_o(int table) { return G_o_[table]; }

  // Samples [begin, end), kBatch at most, of a model with the tables that were read.
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
