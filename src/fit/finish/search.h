#ifndef TRILOBE_FIT_FINISH_SEARCH_H_
#define TRILOBE_FIT_FINISH_SEARCH_H_

#include <limits>
#include <string>
#include <vector>

#include "core/system/process.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The candidates of a search for a form, and the one that leads. ChooseNodes, ChooseForm and
// ChooseModel make their candidates in different ways, and all keep to this.
class Search {
 public:
  struct Rules {
    int max_parameters = std::numeric_limits<int>::max();
    // Leads that a candidate needs to be taken [dB]: over the one that leads so far, and over the
    // first.
    double over_leader = 0;
    double over_first = -std::numeric_limits<double>::infinity();
  };

  // Throws Error for an empty judge and for a budget below 1.
  Search(Judge judge, const Rules& rules);

  // Judges a model as the next candidate. Its time is that since the one before.
  const Candidate& Try(const std::string& name, const FactorModel& model, int num_parameters,
                       double E);

  // Whether the last candidate keeps to the budget and has the leads that it needs; without a
  // leader it needs none.
  bool LastLeads() const;
  void TakeLast() { chosen_ = static_cast<int>(candidates_.size()) - 1; }

  bool has_leader() const { return chosen_ >= 0; }
  const Candidate& leader() const { return candidates_[chosen_]; }
  const Candidate& first() const { return candidates_.front(); }
  Candidate& last() { return candidates_.back(); }
  const Judge& judge() const { return judge_; }

  const std::vector<Candidate>& candidates() const { return candidates_; }
  int chosen() const { return chosen_; }  // index of the leader, or -1

 private:
  const Judge judge_;
  const Rules rules_;
  std::vector<Candidate> candidates_;
  int chosen_ = -1;
  Stopwatch stopwatch_;  // since the last candidate
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_SEARCH_H_
