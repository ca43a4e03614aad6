#ifndef TRILOBE_FIT_PRIOR_NODE_CHOICE_H_
#define TRILOBE_FIT_PRIOR_NODE_CHOICE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Nodes of D and G that a fit could have.
struct NodeCandidate {
  std::string name;  // "D 12rx36, G 6x24": an r for even steps of the root of theta
  ModelSpec spec;
  double error = 0;  // E on the held-out samples, over the black model's
  double seconds = 0;
};

// `spec` on nodes from coarse to fine, for data with so many theta and phi: D from 8r x 24 to
// 24r x 72, G from 6 x 16 to 10 x 48, no more phi of D than the data have, and half of these of G.
// The second is what such data get by default. G has rings towards the horizon if that of `spec`
// has. `error` and `seconds` are 0.
std::vector<NodeCandidate> NodeLadder(const ModelSpec& spec, int thetas, int phis);

// About every fifth pair of directions, [n] of the samples: whether it is held out. A function of
// the pair and the seed alone, whichever of the two directions is wi. Throws Error for samples
// without directions.
std::vector<bool> HeldOut(const BrdfSamples& samples, uint64_t seed);

struct NodeChoiceOptions {
  uint64_t seed = 1;
  double prior = 1;                         // SyntheticPriorOptions::weight, or 0 for no prior
  std::optional<HemisphereGrid> grid = {};  // SyntheticPriorOptions::grid
  // As of SolverOptions, of each candidate's fit; returns false to stop.
  std::function<bool(const IterationRecord&, const FactorModel&)> on_iteration = nullptr;
  StopCheck stop = {};
};

struct NodeChoice {
  FactorModel model;                      // the chosen one, as fitted to what was not held out
  std::vector<NodeCandidate> tried = {};  // from the first of the ladder on
  int chosen = 0;                         // which of them
  int held_out = 0;                       // samples
  double seconds = 0;                     // of all
};

// Climbs the ladder as long as the error on held-out pairs of directions falls, each time by 1 % or
// more. Every candidate is fitted, in few iterations, to the other pairs and to a prior made from
// these; each starts from the one before. Deterministic, for any number of threads; stopped, it
// chooses among what it has tried. Throws Error where there is no ladder, where the samples know no
// directions, and where there are too few to hold any out.
NodeChoice ChooseNodes(const Objective& data, const std::vector<NodeCandidate>& ladder,
                       const NodeChoiceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_NODE_CHOICE_H_
