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
#include "model/objective/gauge.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// "no lobe", "one lobe", "2 lobes".
std::string LobesText(int lobes);

// Texts of a plan if no form meets the budget (SettleForState).
inline constexpr const char* kWithinBudget = "a fit within the budget";
inline constexpr const char* kSoughtInstead =
    "the smallest that is within 10 % of the best was sought instead";

// An intermediate model of pruning, with the objectives of its spec.
struct PruneState {
  std::shared_ptr<const Objective> objective;  // minimised by fits
  std::shared_ptr<const Objective> data;       // judges models; the same without a prior
  FactorModel model = {};
  TableLayout layout = {};
  double E = 0;  // of the data

  // E of the data for a model whose E of the objective is `fitted`.
  double Judged(const FactorModel& judged, double fitted) const {
    return data.get() == objective.get() ? fitted : data->Value(judged);
  }

  const ModelSpec& spec() const { return model.spec(); }
  int lobes() const { return model.spec().lobes; }
  int num_parameters() const { return layout.num_parameters(spec()); }
};

// State shared by the parts of Prune: the budget, the current model, and the decisions.
class Pruning {
 public:
  // The arguments must outlive it. `objective` has the samples of `data`, or these and a prior's.
  Pruning(const Objective& data, const Objective& objective, const FactorModel& full,
          const PruneOptions& options);

  const PruneOptions& options() const { return options_; }
  ThinnedFactors may_thin() const { return {options_.tables, options_.tables, options_.shadowing}; }

  const PruneState& state() const { return state_; }
  // Replaces the state without a decision and returns the old one.
  PruneState GoOnFrom(PruneState state) { return std::exchange(state_, std::move(state)); }
  // A state with the objectives of this spec and no model.
  PruneState StateFor(const ModelSpec& spec) const;
  // A state with a model in canonical form that stores all parameters.
  PruneState MakeState(const ModelSpec& spec, const FactorModel& model) const;
  // The quadratic model of E at the state's model, computed once for each model.
  const QuadraticModel& Linearized();

  // Whether the budget is in parameters and E is minimised; else E has a limit.
  bool by_parameters() const { return by_parameters_; }
  double E_full() const { return E_full_; }
  // E of what the search began from: of the full model, or of what came nearest to the budget.
  double E_base() const { return E_base_; }
  // Whether E is 0 up to rounding.
  bool IsExact(double E) const;
  bool may_rise() const;  // by more than rounding
  double limit() const { return limit_; }
  // Target of E in the search, at most limit(): an estimate of the E at which the error reaches its
  // limit.
  double search_limit() const { return search_limit_; }
  void set_search_limit(double limit) { search_limit_ = limit; }
  // Target of E with the prior's samples that corresponds to this E of the data.
  double GoalOfFits(double E) const { return E + E_of_prior_; }
  // The error besides E (PruneOptions::error, or by PSNR) and its limit; 0 if only E is limited.
  bool limits_error() const { return error_ != nullptr; }
  double ErrorOf(const PruneState& state) const { return error_ ? error_(state) : 0; }
  double base_error() const { return base_error_; }  // as E_base
  double max_error() const { return max_error_; }
  void set_max_error(double error) { max_error_ = error; }
  // Whether a state's E and error are within the budget.
  bool KeepsToBudget(const PruneState& state) const;
  // Limited quantity: the error, or else E.
  double Cost(const PruneState& state) const { return error_ ? error_(state) : state.E; }
  double max_cost() const { return error_ ? max_error_ : limit_; }
  // Replaces a budget that nothing meets by 1.1 times the state's cost.
  void SettleForState();
  bool misses_budget() const { return misses_budget_; }
  // Text that compares E with the full model's.
  std::string CompareWithFull(double E, bool within) const;

  void Record(std::string what, const PruneState& next, bool taken, std::string why);
  // Records a decision and, if `taken`, replaces the state. Returns `taken`.
  bool Decide(std::string what, PruneState next, bool taken, std::string why);
  const std::vector<PruneDecision>& decisions() const { return decisions_; }
  // The state's model in canonical form, or the full model unchanged if nothing was left out, with
  // the decisions.
  PrunedModel Result(LobeOrder order) const;
  // Marks decisions [begin, end) as not taken, since they led to nothing better.
  void Withdraw(size_t begin, size_t end, const std::string& why);

 private:
  // Settles for the state after a step to a better one, which may even meet the budget.
  void SettleForBetter();

  const Objective &data_, &objective_;
  const FactorModel& full_;
  const PruneOptions& options_;
  PruneState state_;
  double E_full_ = 0, E_base_ = 0, E_of_prior_ = 0;
  bool misses_budget_ = false;
  struct {
    double limit, max_error;
  } given_ = {};  // before SettleForState
  std::function<double(const PruneState&)> error_;
  double base_error_ = 0, max_error_ = 0;
  bool by_parameters_ = false;
  double limit_ = kInfinity;
  double search_limit_ = kInfinity;
  QuadraticModel quadratic_;
  std::optional<FactorModel> linearized_;  // where quadratic_ was made
  std::vector<PruneDecision> decisions_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNING_H_
