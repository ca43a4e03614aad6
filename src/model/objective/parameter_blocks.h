#ifndef TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_
#define TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// The parameters of a model in the blocks in which a sample reads them. FactorModel keeps a table
// together; a sample reads one entry, or a few, of all tables of a factor. So the blocks are
//   [ d (3) | s (lobes x 3) | rows of D | rows of F | rows of G ],
// where row k of a factor is entry k of each of its tables, in their order. A model without lobes
// has the block d alone.
class ParameterBlocks {
 public:
  // All parameters zero. Throws Error if the spec is out of range.
  explicit ParameterBlocks(const ModelSpec& spec);

  const ModelSpec& spec() const { return spec_; }
  int num_blocks() const { return static_cast<int>(begin_.size()) - 1; }

  // The parameters of a block. Their place in memory stays.
  std::span<double> block(int b) { return {values_.data() + begin_[b], size(b)}; }
  std::span<const double> block(int b) const { return {values_.data() + begin_[b], size(b)}; }

  // Where each of them is in FactorModel::parameters().
  std::span<const int> parameters(int b) const { return {parameter_.data() + begin_[b], size(b)}; }

  // The blocks by what they hold; s and rows only where the spec has lobes.
  static constexpr int kD = 0;
  static constexpr int kS = 1;
  int row(Factor factor, int entry) const { return first_row_[static_cast<int>(factor)] + entry; }

  // Copies from and to a model of the same spec. Throws Error for another one.
  void Read(const FactorModel& model);
  void Write(FactorModel* model) const;

 private:
  size_t size(int b) const { return begin_[b + 1] - begin_[b]; }

  ModelSpec spec_;
  int first_row_[3] = {0, 0, 0};
  std::vector<int> begin_;  // of each block in values_, and the end of the last
  std::vector<int> parameter_;
  std::vector<double> values_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_
