#ifndef TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_
#define TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_

#include <span>
#include <vector>

#include "trilobe/core/base/check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// The parameters of a model in blocks, as Ceres' parameter blocks are: what a sample reads together
// lies together. FactorModel keeps a table in one piece; a sample reads one entry, or a few, of all
// tables of a factor. So the blocks are
//   0                d                                      [3]          [1/sr]
//   1                s, kChannels numbers a lobe            [3 x lobes]
//   row(factor, k)   entry k of each table of the factor    [tables of the factor]
// with the rows of D first, then those of F and of G. A model without lobes has block 0 alone. s
// and tables have no unit of their own: only their product, in 1/sr, is measured.
//
//   ParameterBlocks blocks(model.spec());
//   blocks.Read(model);
//   const int peak = blocks.row(Factor::kD, 0);
//   problem.SetParameterBlockConstant(blocks.block(peak).data());
class ParameterBlocks {
 public:
  // All parameters zero. Throws Error if the spec is out of range.
  explicit ParameterBlocks(const ModelSpec& spec);

  const ModelSpec& spec() const { return spec_; }
  int num_blocks() const { return static_cast<int>(begin_.size()) - 1; }

  // The parameters of a block, at the same place in memory as long as this lives. Throws Error if
  // there is no such block.
  std::span<double> block(int b) { return {values_.data() + Begin(b), Size(b)}; }
  std::span<const double> block(int b) const { return {values_.data() + Begin(b), Size(b)}; }

  // Indices of the block's elements in FactorModel::parameters(). Throws Error if there is no such
  // block.
  std::span<const int> parameters(int b) const { return {parameter_.data() + Begin(b), Size(b)}; }

  // The blocks by what they hold. There are s and rows only where the spec has lobes; row throws
  // Error for an entry that the tables do not have.
  static constexpr int kD = 0;
  static constexpr int kS = 1;
  int row(Factor factor, int entry) const {
    CheckIndex(entry, spec_.lobes > 0 ? spec_.table_size(factor) : 0, "the entry of a table");
    return first_row_[static_cast<int>(factor)] + entry;
  }

  // Copies from and to a model of the same spec. Throws Error for another one.
  void Read(const FactorModel& model);
  void Write(FactorModel* model) const;

 private:
  int Begin(int b) const {
    CheckIndex(b, num_blocks(), "the parameter block");
    return begin_[b];
  }
  size_t Size(int b) const { return begin_[b + 1] - begin_[b]; }

  ModelSpec spec_;
  int first_row_[3] = {0, 0, 0};
  std::vector<int> begin_;  // of each block in values_, and the end of the last
  std::vector<int> parameter_;
  std::vector<double> values_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_PARAMETER_BLOCKS_H_
