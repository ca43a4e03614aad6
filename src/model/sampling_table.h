#ifndef TRILOBE_MODEL_SAMPLING_TABLE_H_
#define TRILOBE_MODEL_SAMPLING_TABLE_H_

#include <array>
#include <mutex>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/half_vector_table.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

// Reflected light of the lobes at each of several wi, by which Bsdf draws half vectors. The first
// call of Of computes it, which takes up to some seconds. Thread-safe.
template <typename Real>
class SamplingTable {
 public:
  // Throws Error if a value that is tabulated might overflow.
  explicit SamplingTable(const FactorModel& model);

  // `prepared` is the same model.
  const HalfVectorTable<Real>& Of(const PreparedModel<Real>& prepared) {
    std::call_once(made_, [&] { table_ = Make(prepared); });
    return table_;
  }

  Real diffuse_albedo() const { return diffuse_albedo_; }  // mean over the channels

 private:
  using Vector = std::array<Real, 3>;
  using Colour = std::array<Real, kChannels>;

  HalfVectorTable<Real> Make(const PreparedModel<Real>& prepared) const;
  std::vector<float> TabulatedLobes(const PreparedModel<Real>& prepared,
                                    const HalfVectorNodes& nodes) const;

  const FactorModel model_;
  Real diffuse_albedo_;
  std::once_flag made_;
  HalfVectorTable<Real> table_;
};

extern template class SamplingTable<double>;
extern template class SamplingTable<float>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SAMPLING_TABLE_H_
