#ifndef TRILOBE_MODEL_LOBES_SCALE_H_
#define TRILOBE_MODEL_LOBES_SCALE_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"

// What moves scale between s and the tables of a model, and changes none of its values.
namespace trilobe {

// Calls what(lobe, channel) for each that the table serves.
template <typename What>
void ForEachServed(const ModelSpec& spec, Factor factor, int index, const What& what) {
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      if (spec.serves(factor, index, m, c)) what(m, c);
    }
  }
}

bool AnyCovered(std::span<const double> coverage);

// Calls what(factor, index) for each table that has an observed entry. The scale of others, those
// of channels without any data, is that of nothing.
template <typename What>
void ForEachObservedTable(std::span<const double> coverage, const FactorModel& model,
                          const What& what) {
  for (const Factor factor : kFactors) {
    const int size = model.spec().table_size(factor);
    for (int t = 0; t < model.spec().num_tables(factor); ++t) {
      if (AnyCovered(coverage.subspan(model.TableOffset(factor, t), size))) what(factor, t);
    }
  }
}

// Divides a table by its norm, and gives the lost factor to the s that it serves (twice for G,
// which enters squared). A norm that is a power of two but for rounding is taken for one. To divide
// by it rounds nothing: a model that is in canonical form stays the same to the bit, and equal
// tables stay equal.
void Divide(Factor factor, int index, double norm, FactorModel* model);

// If the observed entries of a table are 0, its lobes reflect nothing. It becomes a constant
// instead, which has a norm, and s says that they are dark.
void MoveZeroToS(std::span<const double> coverage, Factor factor, int index, FactorModel* model);

// Solid angle over the projected hemisphere that each entry of D stands for. [axis.size]
std::vector<double> ProjectedAngles(const Axis& axis);

double WeightedSum(std::span<const double> weights, std::span<const double> values);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_SCALE_H_
