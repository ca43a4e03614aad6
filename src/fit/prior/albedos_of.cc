#include "fit/prior/albedos_of.h"

#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/evaluate/prepared_model.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe {

std::vector<Rgb> AlbedosOf(const FactorModel& model, std::span<const double> theta_i,
                           int num_threads) {
  const PreparedModel<double> prepared(model);
  return DirectionalAlbedos(
      [&prepared](const DirectionPair& pair) { return prepared.Value(pair.wi, pair.wo); }, theta_i,
      num_threads);
}

}  // namespace trilobe
