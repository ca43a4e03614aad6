#ifndef TRILOBE_FIT_FINISH_CANDIDATE_H_
#define TRILOBE_FIT_FINISH_CANDIDATE_H_

#include <functional>
#include <string>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// A form that a search may try.
struct FormSpec {
  std::string name;  // "as fitted", "4 lobes", "D 12rx36, G 6x24"; r: even steps of the root
  ModelSpec spec;
};

// Score of a model [dB]; the highest wins. Pictures judge, or samples that were held out.
using Judge = std::function<double(const FactorModel&)>;

// A form that a search has tried.
struct Candidate {
  std::string name;           // "as fitted", "stretched", "stretched, thinned", ...
  int num_parameters = 0;     // stored
  double E = 0;               // Objective::Value; approximate for a form that is not stored
  double score = 0;           // of the judge; -infinity for NaN
  bool fails_beyond = false;  // rejected by its score in directions that were not measured
  bool has_rings = false;     // rejected, as even light would show rings
  double seconds = 0;         // to make it from the form that it is derived from
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_CANDIDATE_H_
