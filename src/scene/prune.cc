#include "trilobe/scene/prune.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include "trilobe/base/error.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/merge_lobes.h"
#include "trilobe/model/score.h"
#include "trilobe/scene/lobe_search.h"
#include "trilobe/scene/needed_layout.h"
#include "trilobe/scene/node_elimination.h"
#include "trilobe/scene/reduced_quadratic.h"
#include "trilobe/scene/shapes.h"
#include "trilobe/solvers/joint_step.h"
#include "trilobe/solvers/normal_equations.h"
#include "trilobe/solvers/reduction.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-12;  // of E

// Of the fit in the numbers that are left: it ends when a step gains less than this fraction of the
// budget, or of E where E is what counts; and when so many times what the last step gained would
// not bring it down to the budget.
constexpr int kMaxPolish = 8, kHope = 4;
constexpr double kSmallGain = 0.02, kSmallDecrease = 1e-4;

// Giving up nodes and refitting, again and again from where that led: what the errors of the
// quadratic left of the budget is spent the next time. Where they were too large, a part of it is
// tried, which grows again. It ends when few numbers went for all that was left.
constexpr int kMaxAttempts = 8;
constexpr double kMinCut = 0.1, kMaxCut = 0.6, kGrowth = 1.5;
constexpr double kFewNumbers = 0.04;

// Where lobes that went took more than this share of the budget, it may be better spent on nodes.
constexpr double kDear = 0.5;

// Towards a budget of numbers: this part of those in excess goes at once, if they are more than
// few.
constexpr double kExcessAtOnce = 0.75;
constexpr int kFewInExcess = 10;

// Towards a limit of PSNR: so often, and by this factor, the rise of E that is allowed grows.
constexpr int kStretches = 4;
constexpr double kStretch = 3;

// A model on the way from the full to the pruned one, with its own objective.
struct State {
  std::shared_ptr<const Objective> objective;
  FactorModel model;
  TableLayout layout;
  double E = 0;

  const ModelSpec& spec() const { return model.spec(); }
  int numbers() const { return layout.num_numbers(spec()); }
};

int Lobes(const State& state) { return state.spec().lobes; }

std::string LobesText(int lobes) {
  return lobes == 0 ? "no lobe" : lobes == 1 ? "one lobe" : std::to_string(lobes) + " lobes";
}

class Pruner {
 public:
  Pruner(const Objective& objective, const FactorModel& full, const PruneOptions& options)
      : objective_(objective),
        options_(options),
        may_thin_{options.tables, options.tables, options.shadowing} {
    state_ = MakeState(objective.spec(), full);
    E_full_ = state_.E;
    by_numbers_ = options.max_numbers < std::numeric_limits<int>::max();
    if (!by_numbers_) {
      if (std::isfinite(options.max_psnr_drop_db)) {
        lowest_psnr_ = ScoreModel(objective, full).psnr_db - options.max_psnr_drop_db;
      }
      // Where E is the squared error, PSNR falls by as much at this E; elsewhere it is a start.
      limit_ = E_full_ * (1 + std::max(options.max_relative_rise, -1.0));
      if (options.max_relative_rise > 0) limit_ = std::max(limit_, ExactObjective(objective));
      guide_ = std::min(limit_, E_full_ * std::pow(10, options.max_psnr_drop_db / 10));
    }
  }

  PrunedModel Run() {
    LeaveOutWhatIsFree();
    if (by_numbers_) {
      MeetNumbers();
    } else if (!Keeps(state_)) {
      AddLobes();
    } else if (guide_ > E_full_ * (1 + kRounding)) {
      SpendBudget();
    }
    return Finish();
  }

 private:
  std::shared_ptr<const Objective> ObjectiveFor(const ModelSpec& spec) const {
    if (spec == objective_.spec()) return {std::shared_ptr<const Objective>(), &objective_};
    return std::make_shared<Objective>(objective_, spec);
  }

  State MakeState(const ModelSpec& spec, const FactorModel& model) const {
    State state{.objective = ObjectiveFor(spec), .model = model, .layout = TableLayout::Full(spec)};
    Canonicalize(state.objective->coverage(), &state.model);
    state.E = state.objective->Value(state.model);
    return state;
  }

  // The true test.
  bool Keeps(const State& state) const {
    if (by_numbers_) return true;
    if (!(state.E <= limit_ * (1 + kRounding))) return false;
    return !lowest_psnr_ || ScoreModel(*state.objective, state.model).psnr_db >= *lowest_psnr_;
  }

  void Record(std::string what, const State& to, bool taken, std::string why) {
    decisions_.push_back({.what = std::move(what),
                          .numbers_before = state_.numbers(),
                          .numbers_after = to.numbers(),
                          .E_before = state_.E,
                          .E_after = to.E,
                          .taken = taken,
                          .why = std::move(why)});
  }

  // Records it, and goes on from there if it is taken.
  bool Decide(std::string what, State to, bool taken, std::string why) {
    Record(std::move(what), to, taken, std::move(why));
    if (taken) state_ = std::move(to);
    return taken;
  }

  std::string Against(double E, bool within) const {
    std::ostringstream out;
    out.precision(3);
    if (E_full_ > 0) {
      const double rise = 100 * (E / E_full_ - 1);
      out << "E is " << std::abs(rise) << " % " << (rise < 0 ? "below" : "above")
          << " the full model's";
    } else {
      out << "E is " << E << ", and of the full model 0";
    }
    if (!by_numbers_) out << "; " << (within ? "within" : "beyond") << " the budget";
    return out.str();
  }

  // Lobes that reflect nothing, entries that no data touch and runs of equal values.
  void LeaveOutWhatIsFree() {
    if (options_.lobes) {
      FactorModel model = state_.model;
      for (int m = model.spec().lobes - 1; m >= 0; --m) {
        const auto s = model.s(m);
        if (std::ranges::all_of(s, [](double x) { return x == 0; })) model = WithoutLobe(model, m);
      }
      if (model.spec() != state_.spec()) {
        State to = MakeState(model.spec(), model);
        const std::string what = LobesText(Lobes(to)) + " instead of " + LobesText(Lobes(state_));
        Decide(what, std::move(to), true, "the others reflect nothing");
      }
    }
    ShareWhatIsEqual();
    State to = state_;
    const TableLayout needed =
        NeededLayout(to.model, to.objective->coverage(), may_thin_, /*drop_equal=*/true);
    for (int f = 0; f < 3; ++f) to.layout.nodes[f] = needed.nodes[f];
    if (to.numbers() == state_.numbers()) return;
    ExpandStored(to.layout, &to.model);
    to.E = to.objective->Value(to.model);
    Decide("entries without data and runs of equal entries not stored", std::move(to), true,
           "they change no value");
  }

  // The first shape that changes no number.
  void ShareWhatIsEqual() {
    for (const Shape& shape : Shapes()) {
      if (shape.constant_G || shape.name.empty()) continue;
      const Reduction sharing = Reduction::BySharing(state_.spec(), shape.spec);
      const Reduction reduction =
          sharing.After(Reduction(shape.spec, LayoutOf(shape, TableLayout::Full(shape.spec))));
      const std::span<const double> x = state_.model.parameters();
      if (!std::ranges::equal(reduction.Expand(reduction.Restrict(x)), x)) continue;
      FactorModel model(shape.spec);
      std::ranges::copy(sharing.Restrict(x), model.parameters().begin());
      State to = MakeState(shape.spec, model);
      to.layout = LayoutOf(shape, std::move(to.layout));
      Decide(shape.name, std::move(to), true, "they are equal");
      return;
    }
  }

  std::vector<Shape> Shapes() const {
    return ShapesWithin(state_.spec(), state_.layout, options_.colour, options_.shadowing);
  }

  // Of state_, made once for each model.
  const QuadraticModel& Linearized() {
    if (!linearized_ || linearized_->spec() != state_.spec() ||
        !std::ranges::equal(linearized_->parameters(), state_.model.parameters())) {
      NormalEquations(*state_.objective).Evaluate(state_.model, Hessian::kGaussNewton, &quadratic_);
      linearized_ = state_.model;
    }
    return quadratic_;
  }

  EliminationLimits LimitsFor(double E, int numbers) const {
    EliminationLimits limits;
    limits.max_rise = by_numbers_ ? kInfinity : guide_ - E;
    limits.max_count = by_numbers_ ? std::max(numbers - options_.max_numbers, 0) : numbers;
    limits.may_thin = may_thin_;
    return limits;
  }

  // Fits the numbers of the state's layout.
  void Polish(State* state) const {
    const Reduction reduction(state->spec(), state->layout);
    PhaseSeconds phases;
    JointStepper stepper(*state->objective, JointStepper::Curvature::kByProgress,
                         JointStepper::Trial::kAsItIs, &phases, &reduction);
    stepper.Restart(state->model);
    const double small = by_numbers_ ? kSmallDecrease * state->E : kSmallGain * (guide_ - E_full_);
    for (int step = 0; step < kMaxPolish && !stepper.exhausted() && !options_.stop(); ++step) {
      const double before = stepper.E();
      if (!stepper.Step()) continue;
      const double decrease = before - stepper.E();
      if (decrease < small || (!by_numbers_ && stepper.E() - kHope * decrease > guide_)) break;
    }
    state->model = stepper.current();
    state->E = stepper.E();
  }

  // Goes on with the shape that promises the fewest numbers, or the lowest E, once nodes are given
  // up too.
  void ChooseShape() {
    const QuadraticModel& at = Linearized();
    const std::span<const double> x = state_.model.parameters();
    struct Option {
      Shape shape;
      TableLayout layout;
      FactorModel model;
      double E;
      int numbers;
    };
    std::vector<Option> options;
    for (const Shape& shape : Shapes()) {
      const Reduction sharing = Reduction::BySharing(state_.spec(), shape.spec);
      FactorModel model(shape.spec);
      const std::vector<double> coverage = sharing.Transpose(state_.objective->coverage());
      const bool as_it_is = shape.name.empty();
      if (as_it_is && options.empty()) return;  // it has the most numbers, and comes last
      const TableLayout layout = LayoutOf(
          shape, as_it_is ? state_.layout
                          : NeededLayout(model, coverage, may_thin_, /*drop_equal=*/false));
      double rise = 0;
      if (as_it_is) {
        model = state_.model;
      } else {
        const Reduction inner(shape.spec, layout), reduction = sharing.After(inner);
        std::vector<double> y0 = reduction.Transpose(x);
        const std::vector<double> counts = reduction.Transpose(std::vector<double>(x.size(), 1.0));
        for (size_t j = 0; j < y0.size(); ++j) y0[j] /= counts[j];
        const ReducedPoint best = LowestWithin(reduction, at, x, y0, Lobes(state_));
        rise = best.rise;
        std::ranges::copy(inner.Expand(best.y), model.parameters().begin());
      }
      if (!by_numbers_ && state_.E + rise > guide_) continue;
      QuadraticModel there = sharing(at);
      const std::vector<double> moved = sharing.Expand(model.parameters());
      std::vector<double> gradient = GradientChange(at, x, moved);
      for (size_t k = 0; k < x.size(); ++k) gradient[k] += at.gradient[k];
      there.gradient = sharing.Transpose(gradient);
      const double E = state_.E + rise;
      const int numbers = layout.num_numbers(shape.spec);
      const std::vector<Elimination> order =
          OrderOfElimination(there, model, layout, LimitsFor(E, numbers));
      options.push_back({shape, layout, model, E + (order.empty() ? 0 : order.back().rise),
                         numbers - static_cast<int>(order.size())});
    }
    std::ranges::stable_sort(options, [&](const Option& a, const Option& b) {
      if (!by_numbers_) return a.numbers < b.numbers;
      const int excess_a = std::max(a.numbers - options_.max_numbers, 0);
      const int excess_b = std::max(b.numbers - options_.max_numbers, 0);
      return std::pair(excess_a, a.E) < std::pair(excess_b, b.E);
    });
    for (const Option& option : options) {
      if (option.shape.name.empty() || options_.stop()) return;
      State to{.objective = ObjectiveFor(option.shape.spec),
               .model = option.model,
               .layout = option.layout};
      to.E = to.objective->Value(to.model);
      Polish(&to);
      const bool taken = by_numbers_ || (to.E <= guide_ && Keeps(to));
      const std::string why = Against(to.E, taken);
      if (Decide(option.shape.name, std::move(to), taken, why)) return;
    }
  }

  // The state with the first `count` nodes given up, refitted.
  State Without(const std::vector<Elimination>& order, int count, const QuadraticModel& at) const {
    State to = state_;
    for (int k = 0; k < count; ++k) {
      std::erase(to.layout.of(order[k].factor, order[k].table), order[k].entry);
    }
    const Reduction reduction(to.spec(), to.layout);
    const std::vector<double> y0 = reduction.Restrict(state_.model.parameters());
    const ReducedPoint best =
        LowestWithin(reduction, at, state_.model.parameters(), y0, Lobes(state_));
    to.E = kInfinity;
    for (const std::vector<double>& y : {best.y, y0}) {
      FactorModel model(to.spec());
      std::ranges::copy(reduction.Expand(y), model.parameters().begin());
      const double E = to.objective->Value(model);
      if (!(E < to.E)) continue;
      to.E = E;
      to.model = model;
    }
    Polish(&to);
    return to;
  }

  // How many nodes go before E has risen by more than this, but one.
  static int CountWithin(const std::vector<Elimination>& order, double rise) {
    const auto end = std::ranges::upper_bound(order, rise, {}, &Elimination::rise);
    return std::max(1, static_cast<int>(end - order.begin()));
  }

  // Gives up nodes until the budget is spent.
  void ThinTables() {
    const State before = state_;
    double share = 1;  // of what is left, to be spent next: less where predictions are too low
    for (int attempt = 0; attempt < kMaxAttempts && !options_.stop();) {
      const int numbers = state_.numbers();
      const QuadraticModel& at = Linearized();
      const std::vector<Elimination> order =
          OrderOfElimination(at, state_.model, state_.layout, LimitsFor(state_.E, numbers));
      int count = static_cast<int>(order.size());
      if (by_numbers_ && count > kFewInExcess) count = static_cast<int>(kExcessAtOnce * count);
      bool taken = false;
      double spent = share;
      for (; !taken && attempt < kMaxAttempts && count > 0; ++attempt) {
        spent = share;
        if (share < 1) count = std::min(count, CountWithin(order, share * (guide_ - state_.E)));
        State to = Without(order, count, at);
        taken = by_numbers_ || (to.E <= guide_ && Keeps(to));
        if (taken) {
          share = std::min(1.0, kGrowth * share);
          state_ = std::move(to);
        } else {
          share *= std::clamp((guide_ - state_.E) / (to.E - state_.E), kMinCut, kMaxCut);
        }
      }
      const bool few = state_.numbers() > (by_numbers_ ? numbers - 1 : (1 - kFewNumbers) * numbers);
      if (!taken || (few && spent >= 1)) break;
    }
    if (state_.numbers() == before.numbers()) return;
    std::ostringstream what;
    what << "nodes of";
    for (const Factor factor : kFactors) {
      size_t from = 0, to = 0;
      for (const auto& nodes : before.layout.nodes[static_cast<int>(factor)]) from += nodes.size();
      for (const auto& nodes : state_.layout.nodes[static_cast<int>(factor)]) to += nodes.size();
      what << (factor == Factor::kD ? " " : ", ") << FactorName(factor) << " from " << from
           << " to " << to;
    }
    State after = std::exchange(state_, before);
    const std::string why = Against(after.E, /*within=*/true);
    Decide(what.str(), std::move(after), true, why);
  }

  // Tries the next number of lobes; true if it was taken.
  bool TryLobes(const std::vector<FactorModel>& starts, double wanted) {
    const ModelSpec& spec = starts.front().spec();
    State to{.objective = ObjectiveFor(spec), .model = {}, .layout = {}};
    FittedModel fitted = FitFrom(starts, *to.objective, wanted, options_.stop);
    to.model = std::move(fitted.model);
    Canonicalize(to.objective->coverage(), &to.model);
    to.layout = NeededLayout(to.model, to.objective->coverage(), may_thin_, /*drop_equal=*/true);
    ExpandStored(to.layout, &to.model);
    to.E = to.objective->Value(to.model);
    if (options_.stop()) return false;
    const bool within = to.E <= wanted && Keeps(to);
    const bool taken = spec.lobes > Lobes(state_) ? to.E < state_.E : within;
    const std::string what = LobesText(spec.lobes) + " instead of " + LobesText(Lobes(state_));
    const std::string why = Against(to.E, within);
    return Decide(what, std::move(to), taken, why);
  }

  // With as few lobes as the budget allows; and with one more where that took most of it.
  void SpendBudget() {
    // The guide says nothing about a PSNR far away, so that E may rise beyond it here.
    const double guide = guide_, wanted = lowest_psnr_ ? limit_ : guide_;
    std::optional<State> with_one_more;
    size_t last_lobe = 0;
    while (options_.lobes && Lobes(state_) > 0) {
      State before = state_;
      if (!TryLobes(WithOneLobeLess(state_.model), wanted)) break;
      last_lobe = decisions_.size() - 1;
      with_one_more.reset();
      if (state_.E - E_full_ > kDear * (wanted - E_full_)) with_one_more = std::move(before);
    }
    ThinWithin(guide);
    if (!with_one_more || options_.stop()) return;
    State fewer = std::exchange(state_, std::move(*with_one_more));
    const size_t end = decisions_.size();
    ThinWithin(guide);
    if (state_.numbers() < fewer.numbers()) {
      Withdraw(last_lobe, end, "with one lobe more fewer numbers are enough");
    } else {
      state_ = std::move(fewer);
      Withdraw(end, decisions_.size(), "with one lobe less fewer numbers are enough");
    }
  }

  // Shape and nodes.
  void ThinWithin(double guide) {
    guide_ = std::max(guide, state_.E);
    ChooseShape();
    ThinTables();
    for (int round = 0; round < kStretches && SparesPsnr(); ++round) {
      guide_ = std::min(limit_, E_full_ + kStretch * (guide_ - E_full_));
      ThinTables();
    }
  }

  // What was decided led to nothing better.
  void Withdraw(size_t begin, size_t end, const std::string& why) {
    for (size_t k = begin; k < end; ++k) {
      if (decisions_[k].taken) decisions_[k].why += "; " + why;
      decisions_[k].taken = false;
    }
  }

  // True where PSNR alone limits, and less than half of what it may fall is spent.
  bool SparesPsnr() const {
    if (!lowest_psnr_ || guide_ >= limit_) return false;
    return ScoreModel(*state_.objective, state_.model).psnr_db >
           *lowest_psnr_ + options_.max_psnr_drop_db / 2;
  }

  void AddLobes() {
    while (!Keeps(state_) && Lobes(state_) < options_.max_lobes) {
      const std::vector<FactorModel> starts = WithOneLobeMore(state_.model);
      if (starts.empty() || !TryLobes(starts, guide_)) break;
    }
    if (!Keeps(state_)) {
      Record("nothing else left out", state_, false,
             "the budget asks for a lower E than was found");
    } else {
      ChooseShape();
      ThinTables();
    }
  }

  // The lowest E that max_numbers reach: with as many lobes as there are, then with fewer as long
  // as that is better.
  void MeetNumbers() {
    while (state_.numbers() <= options_.max_numbers && Lobes(state_) < options_.max_lobes) {
      const std::vector<FactorModel> starts = WithOneLobeMore(state_.model);
      if (starts.empty() || !TryLobes(starts, 0)) break;
    }
    if (state_.numbers() <= options_.max_numbers) return;
    State lobes_kept = state_;
    ChooseShape();
    ThinTables();
    while (options_.lobes && Lobes(lobes_kept) > 0) {
      State best = std::exchange(state_, lobes_kept);
      const size_t decided = decisions_.size();
      const bool met = best.numbers() <= options_.max_numbers;
      const auto back_to_best = [&] {
        state_ = std::move(best);
        Withdraw(decided, decisions_.size(), "with more lobes it ends lower");
      };
      if (!TryLobes(WithOneLobeLess(state_.model), met ? best.E : kInfinity)) {
        back_to_best();
        break;
      }
      lobes_kept = state_;
      ChooseShape();
      ThinTables();
      const bool meets = state_.numbers() <= options_.max_numbers;
      if (met && !(meets && state_.E < best.E)) {
        back_to_best();
        break;
      }
    }
    if (state_.numbers() > options_.max_numbers) {
      Record("nothing else left out", state_, false,
             "what may be left out does not reach the budget");
    }
  }

  PrunedModel Finish() {
    Canonicalize(state_.objective->coverage(), &state_.model);
    ExpandStored(state_.layout, &state_.model);
    PrunedModel result{.model = state_.model,
                       .layout = state_.layout,
                       .decisions = std::move(decisions_),
                       .E = state_.objective->Value(state_.model),
                       .numbers = state_.numbers()};
    return result;
  }

  const Objective& objective_;
  const PruneOptions& options_;
  const ThinnedFactors may_thin_;
  State state_;
  double E_full_ = 0;
  std::optional<double> lowest_psnr_;
  bool by_numbers_ = false;
  double limit_ = kInfinity;  // of E
  double guide_ = kInfinity;  // where E is to go, limit_ or less
  QuadraticModel quadratic_;
  std::optional<FactorModel> linearized_;  // where quadratic_ was made
  std::vector<PruneDecision> decisions_;
};

}  // namespace

PrunedModel Prune(const Objective& objective, const FactorModel& full,
                  const PruneOptions& options) {
  if (std::isnan(options.max_relative_rise) || std::isnan(options.max_psnr_drop_db) ||
      options.max_numbers < 1) {
    throw Error(
        "a budget must be a number, and at least one number must be left to store: check "
        "max_relative_rise, max_psnr_drop_db and max_numbers");
  }
  return Pruner(objective, full, options).Run();
}

}  // namespace trilobe
