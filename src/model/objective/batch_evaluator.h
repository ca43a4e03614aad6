#ifndef TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_
#define TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_

#include <array>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// Numbers of several lobes or tables are adjacent in vectors, padded to whole vectors.
inline constexpr int kVector = 4;
constexpr int PaddedToVectors(int size) { return (size + kVector - 1) / kVector * kVector; }

// The lanes of a factor's tables: lobes are consecutive, once or for each channel.
struct LaneLayout {
  bool per_lobe = false, per_channel = false;
  int stride = 0;  // from one channel's lanes to the next one's
  int size = 0;    // of all, padded

  // First lane of a channel: one lane per lobe, or one for all.
  int First(int channel) const { return per_channel ? channel * stride : 0; }
  bool operator==(const LaneLayout&) const = default;
};

// The lane of each table.
struct TableLanes : LaneLayout {
  TableLanes() = default;
  TableLanes(const ModelSpec& spec, Factor factor);

  std::vector<int> of_table;  // [num_tables]
};

// Values of models of a spec at folded samples, in each channel c
//   rho_c = d_c + sum over lobes m of s_mc D_m F_mc G_m(theta_i) G_m(theta_o) / (cos cos),
// a batch of samples at a time: the lookups D, F, G, the residual rho - rho*, and the slopes of rho
// by d, s and each lookup. Nothing is kept from call to call.
class BatchEvaluator {
 public:
  static constexpr int kBatch = 64;

  // One batch. Arrays are [kBatch][...] with lanes as in TableLanes; unused lanes are finite and
  // have no meaning.
  struct Batch {
    explicit Batch(const BatchEvaluator& reader);

    std::vector<double> residual;  // rho - rho*. [kChannels]
    // d rho / d (s of each lobe, d), padded. [kChannels][amplitude_lanes]
    std::vector<double> amplitude;
    std::vector<double> D, F, G_i, G_o;  // [lanes]
    // d rho / d lookup, of each channel; in the place of those of G, the number that both share:
    // d rho / d G_i = G_o shadow and d rho / d G_o = G_i shadow. [kChannels][lanes]
    std::vector<double> D_slope, F_slope, shadow;
  };

  BatchEvaluator(const FoldedSamples& samples, const ModelSpec& spec);

  // Sets the parameters from a model, which is not kept.
  void SetModel(const FactorModel& model);

  // Whether to compute slopes in addition to residuals and lookups.
  enum class Slopes { kNone, kAll };

  // Evaluates samples [begin, end), at most kBatch.
  void Read(int begin, int end, Slopes slopes, Batch* batch) const;

  const FoldedSamples& samples() const { return samples_; }
  const ModelSpec& spec() const { return spec_; }
  const TableLanes& lanes(Factor factor) const { return lanes_[static_cast<int>(factor)]; }
  int lobe_lanes() const { return lobe_lanes_; }
  // Whether the lobes, and each factor's tables, fit into one vector.
  bool one_vector() const { return one_vector_; }
  const double* s() const { return s_.data(); }  // of the model. [kChannels][lobe_lanes]
  int amplitude_lanes() const { return PaddedToVectors(1 + spec_.lobes); }

 private:
  // Index of the lookup of a table of D or F, or the first lookup of G.
  int LookupOf(Factor factor, int table) const;

  const FoldedSamples& samples_;
  const ModelSpec spec_;
  const int lobe_lanes_;
  bool one_vector_;
  std::array<TableLanes, 3> lanes_;
  // Tables of D for each stretch, with zeros for lobes of other stretches; then of F and G.
  std::vector<std::vector<double>> tables_;  // [entry][lanes]
  std::array<double, kChannels> d_{};
  std::vector<double> s_;  // [kChannels][lobe_lanes]
};

// E of a model. The same bits for any number of threads.
double FoldedValue(const FoldedSamples& samples, const FactorModel& model, int num_threads);
double FoldedValue(const FoldedPart& part, const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_
