#include "fit/finish/search.h"

#include <cmath>
#include <limits>
#include <utility>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

Search::Search(Judge judge, const Rules& rules) : judge_(std::move(judge)), rules_(rules) {
  CheckNotEmpty(judge_, "judge");
  if (rules_.max_parameters < 1) {
    throw Error(ErrorKind::kRange, "a budget of parameters must be at least 1")
        .About("max_parameters", rules_.max_parameters);
  }
}

const Candidate& Search::Try(const std::string& name, const FactorModel& model, int num_parameters,
                             double E) {
  const double seconds = stopwatch_.Lap();
  double score = judge_(model);
  // NaN has no order: it ranks below all others.
  if (std::isnan(score)) score = -std::numeric_limits<double>::infinity();
  candidates_.push_back(
      {.name = name, .num_parameters = num_parameters, .E = E, .score = score, .seconds = seconds});
  stopwatch_.Lap();
  return candidates_.back();
}

bool Search::LastLeads() const {
  const Candidate& last = candidates_.back();
  if (last.num_parameters > rules_.max_parameters) return false;
  if (!has_leader()) return true;
  return last.score > leader().score + rules_.over_leader &&
         last.score > first().score + rules_.over_first;
}

}  // namespace trilobe
