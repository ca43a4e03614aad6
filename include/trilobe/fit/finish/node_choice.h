#ifndef TRILOBE_FIT_FINISH_NODE_CHOICE_H_
#define TRILOBE_FIT_FINISH_NODE_CHOICE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// `spec` on nodes from coarse to fine, for data with these numbers of theta and phi: D from 8r x 24
// to 24r x 72, G from 6 x 16 to 10 x 48. D has at most as many phi as the data, G half of that. The
// second candidate is the default. G has rings towards the horizon if that of `spec` has.
std::vector<FormSpec> NodeLadder(const ModelSpec& spec, int thetas, int phis);

// Whether each sample is held out, about one in five. [n] Depends only on the seed and the
// unordered pair of directions. Throws Error for samples without directions.
std::vector<bool> HeldOut(const BrdfSamples& samples, uint64_t seed);

struct NodeChoiceOptions {
  uint64_t seed = 1;
  double prior = 1;                         // SyntheticPriorOptions::weight, or 0 for no prior
  std::optional<HemisphereGrid> grid = {};  // SyntheticPriorOptions::grid
  double worthwhile = 0.99;                 // of E before, held out: finer nodes must get below
  // SolverOptions::on_iteration of each candidate's fit.
  std::function<bool(const IterationRecord&, const FactorModel&)> on_iteration = nullptr;
  StopCheck stop = {};
};

struct NodeChoice {
  FactorModel model;  // of the chosen nodes, fitted to the other samples
  // The first candidates of the ladder. E is that of the held-out samples, relative to a black
  // model's, and the score -10 log10 E.
  std::vector<Candidate> tried = {};
  int chosen = 0;      // index of the chosen one
  int held_out = 0;    // number of samples
  double seconds = 0;  // total
};

// Tries the candidates in order while the error on held-out pairs of directions falls below the
// share `worthwhile` of what it was. Each is fitted by a few iterations, starting from the one
// before, to the other pairs and to a prior made from them. The result does not depend on the
// number of threads. If stopped, chooses among those tried. Throws Error for an empty ladder,
// samples without directions, and too few samples to hold any out.
NodeChoice ChooseNodes(const Objective& data, const std::vector<FormSpec>& ladder,
                       const NodeChoiceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_NODE_CHOICE_H_
