#include "experiments/limits/term_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "experiments/limits/term_forms.h"
#include "tests/error_of.h"
#include "tests/model/spectral_materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 7, .phi_d = 12};

TEST(TermProblem, OfThePapersFormIsTheObjective) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    SCOPED_TRACE(name);
    const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, "compressive");
    const FactorModel model = RandomModel(spec, 4);
    const TermModel terms = TermModel::Of(model);
    const TermProblem problem(objective, terms.spec());
    EXPECT_NEAR(problem.Value(terms), objective.Value(model), 1e-11 * objective.Value(model));
    EXPECT_NEAR(problem.MeasuredEnergy(), objective.MeasuredEnergy(),
                1e-12 * problem.MeasuredEnergy());
    QuadraticModel actual, expected;
    problem.Linearize(terms, &actual);
    EvaluateReference(objective, model, Hessian::kGaussNewton, &expected);
    const size_t n = expected.gradient.size();
    ASSERT_EQ(actual.gradient.size(), n);
    int wrong = 0;
    for (size_t k = 0; k < n; ++k) {
      const double scale = 1e-10 * std::sqrt(expected.squared_lengths[k]);
      wrong += !(std::abs(actual.gradient[k] - expected.gradient[k]) <=
                 scale * std::sqrt(expected.objective));
      for (size_t l = 0; l < n; ++l) {
        wrong += !(std::abs(actual.H[k * n + l] - expected.H[k * n + l]) <=
                   scale * std::sqrt(expected.squared_lengths[l]));
      }
    }
    EXPECT_EQ(wrong, 0);
  }
}

// Checks the gradients of all forms by differences of E.
TEST(TermProblem, GradientIsThatOfE) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 3), spec, "compressive");
  for (const TermForm& form : TermForms()) {
    SCOPED_TRACE(form.name);
    TermModel model = form.from(TermModel::Of(RandomModel(spec, 4)));
    const TermProblem problem(objective, model.spec());
    QuadraticModel at;
    problem.Linearize(model, &at);
    const std::span<double> x = model.parameters();
    for (size_t k = 0; k < x.size(); ++k) {
      const double was = x[k], step = 1e-5 * (was + 1e-3);
      x[k] = was + step;
      const double above = problem.Value(model);
      x[k] = was - step;
      const double below = problem.Value(model);
      x[k] = was;
      const bool is_fixed = form.name == "coupled_diffuse" && k >= x.size() - 90;
      const double expected = is_fixed ? 0 : (above - below) / (4 * step);
      EXPECT_NEAR(at.gradient[k], expected, 1e-5 * at.objective + 1e-6 * std::abs(expected)) << k;
    }
  }
}

// A material of the form itself, from the paper's: E of a black model falls to nothing, and never
// rises on the way.
TEST(FitTerms, FindsMaterialsOfEachForm) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  for (const TermForm& form : TermForms()) {
    if (form.name == "own_f") continue;  // needs two lobes
    SCOPED_TRACE(form.name);
    TermModel truth = form.from(TermModel::Of(AnalyticModel(spec, 0.2, 0.3)));
    const TermModel start = truth;
    Random random(5);
    for (const auto& [begin, size] : truth.Parts()) {
      // Smooth changes; those of fixed tables would change what the form is.
      const double slope = random.Uniform(-0.3, 0.3);
      const bool is_fixed = form.name == "coupled_diffuse" && size == 90;
      for (int k = 0; k < size && !is_fixed; ++k) {
        truth.parameters()[begin + k] *= std::exp(slope * k / size);
      }
    }
    BrdfTable table = MakeInvalidTable("of the form", kGrid);
    const std::vector<bool> above = BinsAboveSurface(kGrid);
    for (int bin = 0; bin < kGrid.size(); ++bin) {
      if (!above[bin]) continue;
      const std::vector<double> rho = Evaluate(truth, ToDirections(kGrid.Center(bin)));
      for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, rho[c]);
    }
    const Objective objective = MakeObjective(table, spec, "compressive");
    const TermProblem problem(objective, truth.spec());
    const TermFit fit = FitTerms(problem, start, {.max_steps = 200, .tolerance = 1e-9});
    EXPECT_TRUE(std::ranges::is_sorted(fit.trace, std::greater<>()));
    EXPECT_GT(fit.trace.front(), 1e-3 * problem.MeasuredEnergy());
    EXPECT_LT(fit.trace.back(), 1e-6 * problem.MeasuredEnergy());
  }
}

TEST(FitTerms, SameBitsForAnyNumberOfThreads) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const TermModel start = TermForms()[1].from(TermModel::Of(RandomModel(spec, 4)));
  std::vector<std::vector<double>> found;
  for (const int threads : {1, 3}) {
    const Objective objective(ValidSamples(RandomTable(kGrid, 3)), spec,
                              FindWeighting("compressive"), threads);
    const TermFit fit = FitTerms(TermProblem(objective, start.spec()), start, {.max_steps = 3});
    found.emplace_back(fit.model.parameters().begin(), fit.model.parameters().end());
  }
  EXPECT_EQ(found[0], found[1]);
}

// D and G see all wavelengths, and each has d, s and F of its own.
TEST(FitTerms, FitsWavelengthsTogether) {
  ModelSpec spec = ModelSpec::SharedFactors(1);
  spec.d_axis.size = 12;
  spec.f_axis.size = spec.g_axis.size = 6;
  const SpectralModel truth = AnalyticSpectralModel(spec, VisibleWavelengths(7));
  const Measurement measured = MeasureSpectra(truth, 2000);
  const Objective objective(measured.samples, spec, FindWeighting("compressive"));
  TermModel start = TermModel::Of(truth);
  for (double& x : start.parameters()) x = 0.5 + 0.3 * x;
  const TermProblem problem(objective, start.spec(), /*bands=*/true);
  const TermFit fit = FitTerms(problem, start, {.max_steps = 200, .tolerance = 1e-9});
  EXPECT_LT(fit.trace.back(), 1e-6 * problem.MeasuredEnergy());
  EXPECT_THAT(ErrorOf([&] { TermProblem(objective, start.spec()); }),
              IsError(ErrorKind::kMismatch,
                      {.key = "channels", .value = "7"}));  // seven channels are not three
}

// An entry that nothing reads goes on as its neighbour.
TEST(FitTerms, UnreadEntriesFollowTheirNeighbours) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  BrdfTable table = TableOf(AnalyticModel(spec, 0.2, 0.3), kGrid);
  InvalidateThetaH(5, 0, &table);
  const Objective objective = MakeObjective(table, spec, "compressive");
  const TermModel start = TermModel::Of(RandomModel(spec, 4, 0.1));
  const TermFit fit = FitTerms(TermProblem(objective, start.spec()), start);
  const auto factor = [&](int k) { return fit.model.table(0, 0, 0)[k] / start.table(0, 0, 0)[k]; };
  EXPECT_NE(factor(4), 1);
  EXPECT_NEAR(factor(5), factor(4), 1e-12 * factor(4));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
