#ifndef TRILOBE_FIT_PRUNE_PRUNING_H_
#define TRILOBE_FIT_PRUNE_PRUNING_H_

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fit/prune/prune_options.h"
#include "fit/prune/stored_layouts.h"
#include "model/lobes/gauge.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// "no lobe", "one lobe", "2 lobes".
std::string LobesText(int lobes);

// A model on the way from the full to the pruned one, with its own objectives.
struct PruneState {
  std::shared_ptr<const Objective> objective;  // that its fits lower
  std::shared_ptr<const Objective> data;       // by which it is judged; the same without a prior
  FactorModel model = {};
  TableLayout layout = {};
  double E = 0;  // of the data

  // `fitted`: E of the objective.
  double Judged(const FactorModel& judged, double fitted) const {
    return data.get() == objective.get() ? fitted : data->Value(judged);
  }

  const ModelSpec& spec() const { return model.spec(); }
  int lobes() const { return model.spec().lobes; }
  int num_parameters() const { return layout.num_parameters(spec()); }
};

// What the parts of Prune share: the budget, where the model has got to, and what was decided.
class Pruning {
 public:
  // All must outlive it. `objective` has the samples of `data`, or these and a prior's.
  Pruning(const Objective& data, const Objective& objective, const FactorModel& full,
          const PruneOptions& options);

  const PruneOptions& options() const { return options_; }
  ThinnedFactors may_thin() const { return {options_.tables, options_.tables, options_.shadowing}; }

  const PruneState& state() const { return state_; }
  // Goes on from another state, without a decision; returns that which was left.
  PruneState GoOnFrom(PruneState state) { return std::exchange(state_, std::move(state)); }
  // With the objectives for this spec, and no model yet.
  PruneState StateFor(const ModelSpec& spec) const;
  // Of a model with all its parameters, brought to canonical form.
  PruneState MakeState(const ModelSpec& spec, const FactorModel& model) const;
  // The quadratic of E at the state's model, made once for each model.
  const QuadraticModel& Linearized();

  // True where the budget is one of parameters, and E is to be low; else E has a limit.
  bool by_parameters() const { return by_parameters_; }
  double E_full() const { return E_full_; }
  // Whether E is 0 but for rounding, so that nothing can be relative to it.
  bool IsExact(double E) const;
  bool may_rise() const;  // by more than rounding
  double limit() const { return limit_; }
  // Where E is to go, limit() or less: by a limit of the error that is known only roughly.
  double search_limit() const { return search_limit_; }
  void set_search_limit(double limit) { search_limit_ = limit; }
  // Where E of fits is to go, of the data and of the prior's samples, for that of the data to be E.
  double GoalOfFits(double E) const { return E + E_of_prior_; }
  // Besides E: how far off the state's model is in what options() or a PSNR limit, and how far it
  // may be; 0 where nothing but E counts.
  bool limits_error() const { return error_ != nullptr; }
  double ErrorOf(const PruneState& state) const { return error_ ? error_(state) : 0; }
  double full_error() const { return full_error_; }
  double max_error() const { return max_error_; }
  // The true test, of E and error.
  bool KeepsToBudget(const PruneState& state) const;
  // E against the full model's, in words.
  std::string CompareWithFull(double E, bool within) const;

  void Record(std::string what, const PruneState& next, bool taken, std::string why);
  // Records it, and goes on from there if it is taken; returns whether.
  bool Decide(std::string what, PruneState next, bool taken, std::string why);
  const std::vector<PruneDecision>& decisions() const { return decisions_; }
  // The state's model in canonical form, or the full one as it is if nothing was left out; and how
  // it came about.
  PrunedModel Result(LobeOrder order) const;
  // Decisions that led to nothing better.
  void Withdraw(size_t begin, size_t end, const std::string& why);

 private:
  const Objective &data_, &objective_;
  const FactorModel& full_;
  const PruneOptions& options_;
  PruneState state_;
  double E_full_ = 0, E_of_prior_ = 0;
  std::function<double(const PruneState&)> error_;
  double full_error_ = 0, max_error_ = 0;
  bool by_parameters_ = false;
  double limit_ = kInfinity;
  double search_limit_ = kInfinity;
  QuadraticModel quadratic_;
  std::optional<FactorModel> linearized_;  // where quadratic_ was made
  std::vector<PruneDecision> decisions_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNING_H_
