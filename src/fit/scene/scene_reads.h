#ifndef TRILOBE_FIT_SCENE_SCENE_READS_H_
#define TRILOBE_FIT_SCENE_SCENE_READS_H_

#include <cstdint>
#include <vector>

#include "fit/scene/directions.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// A scene as the values that it reads of a measurement. Each read is a patch of the picture.
//
// Noise of the measurement is no error of a model, so a read is a mean over bins nearby that differ
// in phi_d, along which BRDFs change little.
class SceneReads {
 public:
  // `all`: the samples of the measurement; `used`: UsedSamples of these. A read is a pair of a
  // list, by its BinsAround. Of other directions it is the used bins of a place (one theta_h, two
  // theta_d and a third of the phi_d, exchanged directions being one), by their counts, or by the
  // light that a uniformly lit sphere sends through them; what was measured there is then the mean
  // of all bins within 15 degrees of phi_d.
  SceneReads(const BrdfSamples& all, BrdfSamples used, const SceneDirections& directions);

  // The visible difference of a model and the measurement, in what is read.
  SeenError Compare(const FactorModel& model, int num_threads) const;

 private:
  struct Share {
    int sample;    // of used_
    double share;  // sums to 1 over a read
  };
  struct Read {
    int begin, end;  // in shares_
    double weight;
  };

  void AddPairs(const DirectionList& list);
  void AddCells();
  // Adds none where all shares are 0.
  void AddRead(const std::vector<Share>& shares, double weight);

  void FindNeighbours(const BrdfSamples& all);
  // Measured values at used_: those of a model, `fitted`, times measured over fitted sums around.
  std::vector<Rgb> MeasuredLike(const std::vector<Rgb>& fitted, const FactorModel& model,
                                int num_threads) const;

  BrdfSamples used_, around_;
  // Numbers in around_, for each of used_ in turn; and their ends.
  std::vector<int> neighbours_;
  std::vector<int64_t> neighbours_end_;
  std::vector<Cosines> cosines_;  // of used_
  std::vector<Read> reads_;
  std::vector<Share> shares_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_READS_H_
