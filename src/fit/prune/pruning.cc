#include "fit/prune/pruning.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

constexpr double kRounding = 1e-12;  // of E

// Share of the E of a black model that is too little for anything to be relative to it.
constexpr double kPracticallyZero = 1e-9;
// E of a good fit to a measurement, relative to that of a black model.
constexpr double kGoodFit = 1e-4;

// An error by PSNR that is 0 for an exact model.
double ErrorByPsnr(const PruneState& state) {
  return std::pow(10, -ScoreModel(*state.data, state.model).psnr_db / 20);
}

}  // namespace

std::string LobesText(int lobes) {
  return lobes == 0 ? "no lobe" : lobes == 1 ? "one lobe" : std::to_string(lobes) + " lobes";
}

Pruning::Pruning(const Objective& data, const Objective& objective, const FactorModel& full,
                 const PruneOptions& options)
    : data_(data),
      objective_(objective),
      full_(full),
      options_(options),
      state_(MakeState(objective.spec(), full)),
      E_full_(state_.E),
      E_base_(state_.E),
      E_of_prior_(&data == &objective ? 0 : objective.Value(state_.model) - E_full_),
      by_parameters_(options.max_parameters < std::numeric_limits<int>::max()) {
  if (std::isnan(options.max_relative_rise) || std::isnan(options.max_psnr_drop_db) ||
      std::isnan(options.max_error) || options.max_parameters < 1) {
    throw Error(ErrorKind::kRange,
                "a budget must be a number, and at least one number must be left to store: check "
                "max_relative_rise, max_psnr_drop_db, max_error and max_parameters")
        .About("budget");
  }
  if (options.layout) {
    state_.layout = *options.layout;
    ExpandStored(state_.layout, &state_.model);
  }
  if (by_parameters_) return;
  limit_ = E_full_ * (1 + std::max(options.max_relative_rise, -1.0));
  if (options.max_relative_rise > 0) limit_ = std::max(limit_, ExactObjective(data));
  search_limit_ = limit_;
  // If E is the squared error, that reaches its limit at this E; else this is a start.
  if (options.error) {
    error_ = [this](const PruneState& state) { return options_.error(state.model); };
    base_error_ = ErrorOf(state_);
    max_error_ = options.max_error;
    const double growth = base_error_ > 0 ? max_error_ / base_error_ : kInfinity;
    search_limit_ = growth * growth * E_full_;
    // A multiple of the E of an exact model says nothing: the search begins at the E of a good fit.
    if (IsExact(E_full_)) search_limit_ = std::max(search_limit_, kGoodFit * data.MeasuredEnergy());
    search_limit_ = std::min({limit_, search_limit_, data.MeasuredEnergy()});
  } else if (std::isfinite(options.max_psnr_drop_db)) {
    error_ = ErrorByPsnr;
    const double growth = std::pow(10, options.max_psnr_drop_db / 20);
    base_error_ = ErrorOf(state_);
    max_error_ = growth * base_error_;
    search_limit_ = std::min(limit_, growth * growth * E_full_);
  }
  const bool relative = !options.error && options.max_relative_rise > 0;
  if (relative && IsExact(E_full_)) {
    std::ostringstream why;
    why << std::setprecision(2) << "E of the full model is practically 0, "
        << (data.MeasuredEnergy() > 0 ? E_full_ / data.MeasuredEnergy() : 0)
        << " of a black model's, and a fraction of it buys nothing; give a budget in mean_delta_e, "
           "sphere_psnr_db or bytes";
    Record("what can be had for more E", state_, false, why.str());
  }
}

PruneState Pruning::StateFor(const ModelSpec& spec) const {
  const auto made = [&spec](const Objective& objective) -> std::shared_ptr<const Objective> {
    if (spec == objective.spec()) return {std::shared_ptr<const Objective>(), &objective};
    return std::make_shared<Objective>(objective, spec);
  };
  PruneState state{.objective = made(objective_), .data = nullptr};
  state.data = &data_ == &objective_ ? state.objective : made(data_);
  return state;
}

PruneState Pruning::MakeState(const ModelSpec& spec, const FactorModel& model) const {
  PruneState state = StateFor(spec);
  state.model = model;
  state.layout = TableLayout::Full(spec);
  NormalizeScale(state.objective->coverage(), &state.model);
  state.E = state.data->Value(state.model);
  return state;
}

const QuadraticModel& Pruning::Linearized() {
  if (!linearized_ || linearized_->spec() != state_.spec() ||
      !std::ranges::equal(linearized_->parameters(), state_.model.parameters())) {
    NormalEquations(*state_.objective).Evaluate(state_.model, Hessian::kGaussNewton, &quadratic_);
    linearized_ = state_.model;
  }
  return quadratic_;
}

bool Pruning::IsExact(double E) const { return E <= kPracticallyZero * data_.MeasuredEnergy(); }

bool Pruning::may_rise() const { return search_limit_ > E_base_ * (1 + kRounding); }

bool Pruning::KeepsToBudget(const PruneState& state) const {
  if (by_parameters_) return true;
  if (!(state.E <= limit_ * (1 + kRounding))) return false;
  return !limits_error() || ErrorOf(state) <= max_error_;
}

void Pruning::SettleForState() {
  constexpr double kNearBest = 1.1;
  if (!misses_budget_) given_ = {limit_, max_error_};
  misses_budget_ = true;
  E_base_ = state_.E;
  if (limits_error()) {
    base_error_ = ErrorOf(state_);
    max_error_ = kNearBest * base_error_;
    limit_ = kInfinity;
    search_limit_ = std::min(kNearBest * kNearBest * E_base_, data_.MeasuredEnergy());
  } else {
    limit_ = search_limit_ = kNearBest * E_base_;
  }
}

void Pruning::SettleForBetter() {
  const double cost = Cost(state_), base = limits_error() ? base_error_ : E_base_;
  if (cost < base) SettleForState();
  if (state_.E > given_.limit || (limits_error() && cost > given_.max_error)) return;
  misses_budget_ = false;
  limit_ = given_.limit;
  max_error_ = given_.max_error;
}

std::string Pruning::CompareWithFull(double E, bool within) const {
  std::ostringstream out;
  out.precision(3);
  if (!IsExact(E_full_)) {
    const double rise = 100 * (E / E_full_ - 1);
    out << "E is " << std::abs(rise) << " % " << (rise < 0 ? "below" : "above")
        << " the full model's";
  } else {
    out << "E is " << E << ", and of the full model practically 0";
  }
  if (!by_parameters_) out << "; " << (within ? "within" : "beyond") << " the budget";
  return out.str();
}

void Pruning::Record(std::string what, const PruneState& next, bool taken, std::string why) {
  decisions_.push_back({.what = std::move(what),
                        .parameters_before = state_.num_parameters(),
                        .parameters_after = next.num_parameters(),
                        .E_before = state_.E,
                        .E_after = next.E,
                        .taken = taken,
                        .adds = next.lobes() > state_.lobes(),
                        .why = std::move(why)});
}

bool Pruning::Decide(std::string what, PruneState next, bool taken, std::string why) {
  Record(std::move(what), next, taken, std::move(why));
  if (!taken) return false;
  state_ = std::move(next);
  if (misses_budget_) SettleForBetter();
  return true;
}

PrunedModel Pruning::Result(LobeOrder order) const {
  PrunedModel result{.model = state_.model,
                     .layout = state_.layout,
                     .decisions = decisions_,
                     .num_parameters = state_.num_parameters()};
  if (std::ranges::none_of(decisions_, &PruneDecision::taken)) {
    result.model = full_;
  } else {
    Canonicalize(*state_.objective, &result.model, order);
    ExpandStored(result.layout, &result.model);
    // Values beyond the last nodes of tables count in the integral of D. Coverage is by the data
    // alone: samples of a prior are read, but not measured.
    SetCanonicalScale(state_.data->coverage(), &result.model, state_.data->num_threads());
    ExpandStored(result.layout, &result.model);
  }
  result.E = state_.data->Value(result.model);
  result.misses_budget = misses_budget_;
  return result;
}

void Pruning::Withdraw(size_t begin, size_t end, const std::string& why) {
  for (size_t k = begin; k < end; ++k) {
    if (decisions_[k].taken) decisions_[k].why += "; " + why;
    decisions_[k].taken = false;
  }
}

}  // namespace trilobe
