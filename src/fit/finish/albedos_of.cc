#include "fit/finish/albedos_of.h"

#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {

std::vector<Rgb> AlbedosOf(const FactorModel& model, std::span<const double> theta_i,
                           int num_threads) {
  const PreparedModel<double> prepared(model);
  return DirectionalAlbedos(
      [&prepared](const DirectionPair& pair) { return prepared.Value(pair.wi, pair.wo); }, theta_i,
      num_threads);
}

}  // namespace trilobe
