#include "trilobe/model/objective/parameter_blocks.h"

namespace trilobe {

ParameterBlocks::ParameterBlocks(const ModelSpec& spec) : spec_(spec), begin_{0} {
  const FactorModel layout(spec);
  const auto end_block = [this] { begin_.push_back(static_cast<int>(parameter_.size())); };
  for (int k = 0; k < kChannels; ++k) parameter_.push_back(k);
  end_block();
  if (spec.lobes > 0) {
    for (int k = 0; k < kChannels * spec.lobes; ++k) parameter_.push_back(kChannels + k);
    end_block();
    for (const Factor factor : kFactors) {
      first_row_[static_cast<int>(factor)] = num_blocks();
      for (int k = 0; k < spec.table_size(factor); ++k) {
        for (int t = 0; t < spec.num_tables(factor); ++t) {
          parameter_.push_back(layout.TableOffset(factor, t) + k);
        }
        end_block();
      }
    }
  }
  values_.resize(parameter_.size());
}

void ParameterBlocks::Read(const FactorModel& model) {
  CheckSameSpec(model.spec(), spec_);
  for (size_t k = 0; k < values_.size(); ++k) values_[k] = model.parameters()[parameter_[k]];
}

void ParameterBlocks::Write(FactorModel* model) const {
  CheckSameSpec(NotNull(model, "the model").spec(), spec_);
  for (size_t k = 0; k < values_.size(); ++k) model->parameters()[parameter_[k]] = values_[k];
}

}  // namespace trilobe
