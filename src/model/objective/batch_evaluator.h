#ifndef TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_
#define TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_

#include <array>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/folded_samples.h"

namespace trilobe {

// Numbers of several lobes or tables lie side by side in vectors, padded to whole ones.
inline constexpr int kVector = 4;
constexpr int PaddedToVectors(int size) { return (size + kVector - 1) / kVector * kVector; }

// How the tables of a factor lie in lanes: those of the lobes follow each other, once or channel by
// channel.
struct LaneLayout {
  bool per_lobe = false, per_channel = false;
  int stride = 0;  // from one channel's lanes to the next one's
  int size = 0;    // of all, padded

  // The first of the lanes that serve a channel: one a lobe, or one for all of them.
  int First(int channel) const { return per_channel ? channel * stride : 0; }
  bool operator==(const LaneLayout&) const = default;
};

// And which lane each of them has.
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

  // One batch. Each array is [kBatch][...], lanes as TableLanes has them; lanes that belong to no
  // table are finite and mean nothing.
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

  // From now on, this model's parameters are read. It is not kept.
  void SetModel(const FactorModel& model);

  // Whether slopes are wanted, besides residuals and lookups.
  enum class Slopes { kNone, kAll };

  // Samples [begin, end), kBatch at most.
  void Read(int begin, int end, Slopes slopes, Batch* batch) const;

  const FoldedSamples& samples() const { return samples_; }
  const ModelSpec& spec() const { return spec_; }
  const TableLanes& lanes(Factor factor) const { return lanes_[static_cast<int>(factor)]; }
  int lobe_lanes() const { return lobe_lanes_; }
  // Whether the lobes, and the tables of each factor, have their lanes in one vector.
  bool one_vector() const { return one_vector_; }
  const double* s() const { return s_.data(); }  // of the model. [kChannels][lobe_lanes]
  int amplitude_lanes() const { return PaddedToVectors(1 + spec_.lobes); }

 private:
  // The number of the lookup that reads a table of D, F or, of both, the first of G.
  int LookupOf(Factor factor, int table) const;

  const FoldedSamples& samples_;
  const ModelSpec spec_;
  const int lobe_lanes_;
  bool one_vector_;
  std::array<TableLanes, 3> lanes_;
  // Of D for each stretch, with zeros for the lobes that have another; then of F and G.
  std::vector<std::vector<double>> tables_;  // [entry][lanes]
  std::array<double, kChannels> d_{};
  std::vector<double> s_;  // [kChannels][lobe_lanes]
};

// E of a model. The same bits for any number of threads.
double FoldedValue(const FoldedSamples& samples, const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_BATCH_EVALUATOR_H_
