#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "solvers/joint/condensed_cost.h"
#include "tests/solvers/joint/noisy_objective.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 10};

SolverOptions Iterations(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = 0;
  options.diagnose = false;
  return options;
}

struct Iterate {
  IterationRecord record;
  FactorModel model;
};

std::vector<Iterate> Iterates(const std::string& solver, const Objective& objective,
                              SolverOptions options, FactorModel model) {
  std::vector<Iterate> iterates;
  options.on_iteration = [&](const IterationRecord& record, const FactorModel& current) {
    iterates.push_back({record, current});
    return true;
  };
  MakeSolver(solver)->Solve(objective, options, &model);
  return iterates;
}

// The condensed block of an objective as Ceres has it: sums are prepared before each evaluation.
class PreparedCost : public ceres::CostFunction {
 public:
  PreparedCost(const Objective& objective, const FactorModel& start, bool active_set)
      : parameters_(objective, start),
        p_(parameters_.Start()),
        sums_(parameters_, p_.parameters(), active_set, &phases_),
        cost_(&sums_) {
    *mutable_parameter_block_sizes() = cost_.parameter_block_sizes();
    set_num_residuals(cost_.num_residuals());
  }

  const CeresParameters& parameters() const { return parameters_; }
  const CondensedSums& sums() const { return sums_; }
  int size() const { return parameter_block_sizes()[0]; }
  std::vector<double> Start() const {
    const FactorModel start = parameters_.Start();
    return {start.parameters().begin(), start.parameters().end()};
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    std::copy_n(parameters[0], size(), p_.parameters().begin());
    sums_.PrepareForEvaluation(jacobians != nullptr, true);
    return cost_.Evaluate(parameters, residuals, jacobians);
  }

  // r^ at p, and J^ by rows if that is wanted.
  std::vector<double> At(const std::vector<double>& p, std::vector<double>* jacobian) const {
    std::vector<double> residuals(num_residuals());
    const double* const blocks[] = {p.data()};
    if (jacobian != nullptr) jacobian->resize(residuals.size() * p.size());
    double* jacobians[] = {jacobian == nullptr ? nullptr : jacobian->data()};
    EXPECT_TRUE(Evaluate(blocks, residuals.data(), jacobian == nullptr ? nullptr : jacobians));
    return residuals;
  }

 private:
  PhaseSeconds phases_;
  CeresParameters parameters_;
  mutable FactorModel p_;
  mutable CondensedSums sums_;
  CondensedCost cost_;
};

double Dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

// A third of the parameters are 0. The others are twice as large, so that E would push some of
// these below.
FactorModel OnBounds(FactorModel model) {
  for (size_t k = 0; k < model.parameters().size(); ++k) {
    model.parameters()[k] *= k > kChannels && k % 3 == 2 ? 0 : 2;
  }
  return model;
}

// It hands out Eigen matrices of the Ceres library, which Eigen cannot free in a program under
// AddressSanitizer.
TEST(Lm, PassesTheGradientCheckerOfCeres) {
  if (kSanitized) GTEST_SKIP() << "Ceres hands out memory that a sanitizer did not see";
  for (const int lobes : {0, 1, 2}) {
    FactorModel start;
    const Objective objective = NoisyObjective(kGrid, lobes, &start);
    for (const bool on_bounds : {false, true}) {
      if (on_bounds) start = OnBounds(start);
      const PreparedCost cost(objective, start, true);
      const std::vector<double> p = cost.Start();
      const double* const blocks[] = {p.data()};
      const std::vector<const ceres::Manifold*> none = {nullptr};
      const ceres::GradientChecker checker(&cost, &none, ceres::NumericDiffOptions());
      ceres::GradientChecker::ProbeResults results;
      EXPECT_TRUE(checker.Probe(blocks, 1e-6, &results)) << lobes << " lobes\n"
                                                         << results.error_log;
      int held = 0;
      for (int k = 0; k < cost.size(); ++k) held += cost.sums().Held(k) ? 1 : 0;
      EXPECT_EQ(held > 0, on_bounds && lobes > 0);
    }
  }
}

// r^ and J^ are n + 1 numbers with E, gradient and Gauss-Newton matrix of all samples. Away from
// where they were linearised they have E; and r^ is one vector whether J^ is asked for or not.
TEST(Lm, CondensesAllSamples) {
  FactorModel start;
  const Objective objective = NoisyObjective(kGrid, 2, &start);
  const PreparedCost cost(objective, start, false);
  const size_t n = cost.size();
  const double unit = cost.parameters().residual_unit();
  std::vector<double> p = cost.Start(), J;
  const std::vector<double> r = cost.At(p, &J), without = cost.At(p, nullptr);
  const double length = std::sqrt(Dot(r, r));
  for (size_t k = 0; k < r.size(); ++k) EXPECT_NEAR(without[k], r[k], 1e-12 * length);

  QuadraticModel all;
  EvaluateReference(objective, start, Hessian::kGaussNewton, &all);
  EXPECT_NEAR(unit * unit * Dot(r, r), all.objective, 1e-12 * all.objective);
  std::vector<std::vector<double>> columns(n);  // J^ by columns, in the model's own units
  for (size_t k = 0; k < n; ++k) {
    const size_t num_in_units = kChannels * (1 + start.spec().lobes);
    const double scale = unit / (k < num_in_units ? cost.parameters().value_unit() : 1);
    for (size_t i = 0; i <= n; ++i) columns[k].push_back(scale * J[i * n + k]);
  }
  for (size_t k = 0; k < n; ++k) {
    const double column = std::sqrt(all.squared_lengths[k]);
    EXPECT_NEAR(unit * Dot(columns[k], r), all.gradient[k], 1e-10 * column * unit * length);
    for (size_t l = 0; l < n; ++l) {
      EXPECT_NEAR(Dot(columns[k], columns[l]), all.H[k * n + l],
                  1e-10 * column * std::sqrt(all.squared_lengths[l]));
    }
  }

  FactorModel moved = start;
  Random random(3);
  for (size_t k = 0; k < n; ++k) {
    const double factor = random.LogNormal(0.5);
    moved.parameters()[k] *= factor;
    p[k] *= factor;
  }
  const std::vector<double> r_moved = cost.At(p, nullptr);
  const double E = objective.Value(moved);
  EXPECT_NEAR(unit * unit * Dot(r_moved, r_moved), E, 1e-12 * E);
}

// lm takes the same steps, but for rounding errors, as Ceres with a residual block for each sample.
void ExpectSameWay(const Objective& objective, const FactorModel& start,
                   const SolverOptions& options, const std::string& what) {
  constexpr double kTolerance = 1e-6;
  const std::vector<Iterate> condensed = Iterates("lm", objective, options, start);
  const std::vector<Iterate> plain = Iterates("lm_plain", objective, options, start);
  ASSERT_EQ(plain.size(), static_cast<size_t>(options.max_iterations) + 1) << what;
  ASSERT_EQ(condensed.size(), plain.size()) << what;
  EXPECT_LT(plain.back().record.objective, 0.2 * plain.front().record.objective) << what;
  for (size_t k = 0; k < plain.size(); ++k) {
    SCOPED_TRACE(what + ", iteration " + std::to_string(k));
    const double E = plain[k].record.objective;
    EXPECT_NEAR(condensed[k].record.objective, E, kTolerance * E);
    EXPECT_EQ(condensed[k].record.accepted, plain[k].record.accepted);
    // The E that the solver caches is exact.
    EXPECT_EQ(condensed[k].record.objective, objective.Value(condensed[k].model));
  }
}

// Here lm_plain works by QR: it never forms J'J.
TEST(Lm, GoesWhereLmPlainGoes) {
  for (const int lobes : {1, 2}) {
    FactorModel start;
    const Objective objective = NoisyObjective(kGrid, lobes, &start);
    for (const TrustRegion trust_region :
         {TrustRegion::kLevenbergMarquardt, TrustRegion::kDogleg}) {
      SolverOptions options = Iterations(6);
      options.positivity = Positivity::kBounds;
      options.trust_region = trust_region;
      ExpectSameWay(objective, start, options,
                    std::to_string(lobes) + " lobes, " + TrustRegionName(trust_region));
    }
  }
}

// Here the whole Jacobian takes more than 64 MiB, and lm_plain works by sparse normal equations.
TEST(Lm, GoesWhereLmPlainGoesOnALargeProblem) {
  constexpr MerlGrid kLargeGrid{.theta_h = 32, .theta_d = 32, .phi_d = 32};
  FactorModel start;
  const Objective objective = NoisyObjective(kLargeGrid, 2, &start);
  ASSERT_GT(8.0 * kChannels * objective.samples().size() * objective.spec().num_parameters(),
            64 << 20);
  SolverOptions options = Iterations(2);
  options.positivity = Positivity::kBounds;
  ExpectSameWay(objective, start, options, "bounds");
}

// Parameters that a step has put on their bound, and that E holds there, do not spoil the steps of
// the others: of a material that the model can represent nothing is left. Bounds alone promise a
// lower E, and no more.
TEST(Lm, GoesOnWhereNumbersAreOnTheirBounds) {
  constexpr MerlGrid kSmallGrid{.theta_h = 6, .theta_d = 6, .phi_d = 8};
  FactorModel truth = RandomModel(ModelSpec::SharedFactors(2, kSmallGrid), 3, 0.3);
  for (int k = 0; k < kSmallGrid.theta_h; ++k) {
    truth.table(Factor::kD, 0)[k] *= std::pow(10, -k);
    truth.table(Factor::kD, 1)[k] *= std::pow(10, -0.5 * k);
  }
  const Objective objective = MakeObjective(TableOf(truth, kSmallGrid), truth.spec());
  for (const Positivity positivity : {Positivity::kActiveSet, Positivity::kBounds}) {
    FactorModel model = InitialModels().front().make(objective, 1);
    SolverOptions options = Iterations(500);
    options.optimality_tolerance = 0;
    options.positivity = positivity;
    const SolverSummary run = MakeSolver("lm")->Solve(objective, options, &model);
    EXPECT_LT(run.final_objective, 0.1 * run.initial_objective) << run.BriefReport();
    EXPECT_GE(std::ranges::min(model.parameters()), 0);
    EXPECT_EQ(run.used.positivity, positivity);
    if (positivity == Positivity::kActiveSet) {
      EXPECT_EQ(run.stop_reason, StopReason::kExactFit) << run.BriefReport();
      EXPECT_TRUE(run.notes.empty());
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
