#ifndef TRILOBE_FIT_SCENE_SCENE_READS_H_
#define TRILOBE_FIT_SCENE_SCENE_READS_H_

#include <vector>

#include "fit/scene/directions.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// A scene as the values that it reads of a measurement. Each read is a patch of the picture, in
// which noise cancels as it does in a renderer.
class SceneReads {
 public:
  // `all`: the samples of the measurement; `used`: UsedSamples of these. A read is
  // - a pair of a list, interpolated between the bins around it; or else
  // - the used bins of one theta_h, two theta_d and a third of the phi_d, whose exchanged
  // directions
  //   are the same: by their counts, or by the light that a uniformly lit sphere sends through
  //   them. The measured colour is the fitted one times the ratio of measured to fitted values over
  //   all bins of that place, used or not.
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
  void AddCells(const BrdfSamples& all);
  // Adds none, and returns false, where all shares are 0.
  bool AddRead(const std::vector<Share>& shares, double weight);
  SeenPatch PatchOf(const Read& read, const std::vector<Rgb>& fitted) const;

  BrdfSamples used_, around_;
  std::vector<Cosines> cosines_;  // of used_
  std::vector<Read> reads_;
  std::vector<Share> shares_;
  std::vector<int> read_of_around_;  // the read whose place it tells
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_READS_H_
