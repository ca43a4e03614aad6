// The stiff cases, their certified answers, and the measure of agreement with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "experiments/stiff/agreement.h"
#include "experiments/stiff/anisotropic_cases.h"
#include "experiments/stiff/answers.h"
#include "experiments/stiff/certificate.h"
#include "experiments/stiff/minimize.h"
#include "experiments/stiff/reference_problem.h"
#include "model/objective/gauge.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const Certificate& CertificateOf(const std::string& name) {
  static const std::vector<Certificate> all = ReadCertificates(CertifiedAnswers());
  return *std::ranges::find(all, name, &Certificate::name);
}

template <typename Real>
VectorOf<Real> ToVector(const FactorModel& model) {
  VectorOf<Real> x(model.spec().num_parameters());
  for (int k = 0; k < x.size(); ++k) x(k) = model.parameters()[k];
  return x;
}

TEST(DigitsOfAgreement, CountsThem) {
  EXPECT_EQ(DigitsOfAgreement(1, 1, 1), kMaxDigits);
  EXPECT_EQ(DigitsOfAgreement(0, 0, 0), kMaxDigits);
  EXPECT_NEAR(DigitsOfAgreement(1.001, 1, 1), 3, 1e-9);
  EXPECT_NEAR(DigitsOfAgreement(1e-7, 0, 10), 8, 1e-9);
  EXPECT_EQ(DigitsOfAgreement(1, 0, 0), 0);
  EXPECT_EQ(DigitsOfAgreement(5, 1, 1), 0);
  EXPECT_EQ(DigitsOfAgreement(std::numeric_limits<double>::quiet_NaN(), 1, 1), 0);
  EXPECT_EQ(DigitsOfAgreement(1 + 1e-16, 1, 1), kMaxDigits);
}

TEST(CompareTables, LobesHaveNoOrder) {
  const ModelSpec spec = ModelSpec::SharedFactors(3, {.theta_h = 5, .theta_d = 5, .phi_d = 8});
  const FactorModel right = RandomModel(spec, 1);
  FactorModel turned = right;  // lobes 0, 1, 2 in the places 1, 2, 0
  for (int m = 0; m < 3; ++m) {
    const int target = (m + 1) % 3;
    std::ranges::copy(right.s(m), turned.s(target).begin());
    for (const Factor factor : {Factor::kD, Factor::kG}) {
      std::ranges::copy(right.table(factor, m), turned.table(factor, target).begin());
    }
  }
  const std::vector<bool> all(spec.num_parameters(), true);
  EXPECT_EQ(CompareTables(turned, right, all).entries, kMaxDigits);
  turned.table(Factor::kF, 0)[2] *= 1 + 1e-6;
  EXPECT_NEAR(CompareTables(turned, right, all).entries, 6, 1e-3);
  std::vector<bool> others = all;
  others[right.TableOffset(Factor::kF, 0) + 2] = false;
  EXPECT_EQ(CompareTables(turned, right, others).entries, kMaxDigits);
}

// Central differences of E / 2, whose own error is about h^2 = 1e-24 and eps / h^2 = 1e-26.
class ReferenceDerivatives : public testing::TestWithParam<std::string> {};

TEST_P(ReferenceDerivatives, AreThoseOfItsValue) {
  const StiffProblem stiff = FindStiffCase(GetParam()).make();
  const ReferenceProblem<Big> problem(stiff.samples, stiff.spec, stiff.weighting);
  VectorOf<Big> x = ToVector<Big>(RandomModel(stiff.spec, 3));
  const Derivatives<Big> at = problem.Evaluate(x);
  EXPECT_LT(static_cast<double>(abs(at.objective / problem.Value(x) - 1)), 1e-45);
  const Big h(1e-12);
  for (int k = 0; k < x.size(); k += 7) {
    const auto slope = [&](int l, const Big& step) {
      VectorOf<Big> moved = x;
      moved(l) += step;
      return problem.Evaluate(moved).gradient(k);
    };
    VectorOf<Big> up = x, down = x;
    up(k) += h;
    down(k) -= h;
    const Big difference = (problem.Value(up) - problem.Value(down)) / (4 * h);
    const double scale = static_cast<double>(at.gradient.cwiseAbs().maxCoeff());
    EXPECT_NEAR(static_cast<double>(difference), static_cast<double>(at.gradient(k)),
                1e-20 * scale);
    for (int l = k % 5; l <= k; l += 9) {
      const Big second = (slope(l, h) - slope(l, -h)) / (2 * h);
      EXPECT_NEAR(static_cast<double>(second), static_cast<double>(at.hessian(k, l)),
                  1e-18 * std::abs(static_cast<double>(at.hessian(k, k))) + 1e-20 * scale)
          << k << ", " << l;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, ReferenceDerivatives,
                         testing::Values("lost_99_random", "one_azimuth"));

class Stiff : public testing::TestWithParam<std::string> {};

TEST_P(Stiff, IsAProblem) {
  const StiffProblem problem = FindStiffCase(GetParam()).make();
  const Objective objective = MakeObjective(problem);
  for (const Rgb& rho : problem.samples.rho) {
    for (const double value : rho) EXPECT_TRUE(std::isfinite(value) && value >= 0) << value;
  }
  const FactorModel start = StartOf(problem, objective);
  EXPECT_TRUE(start.spec() == problem.spec);
  EXPECT_TRUE(std::isfinite(objective.Value(start)));
  // The library's E and coverage are those of the definition, each sum to within its rounding.
  const ReferenceProblem<long double> reference(problem.samples, problem.spec, problem.weighting);
  const auto E = static_cast<double>(reference.Value(ToVector<long double>(start)));
  if (E > 1e-290) {  // below, squares lose digits
    EXPECT_NEAR(objective.Value(start) / E, 1, 1e-11);
  }
  for (int k = 0; k < problem.spec.num_parameters(); ++k) {
    const auto coverage = static_cast<double>(reference.coverage()(k));
    EXPECT_NEAR(objective.coverage()[k], coverage, 1e-11 * coverage) << k;
  }
}

TEST_P(Stiff, HasItsAnswer) {
  const StiffProblem problem = FindStiffCase(GetParam()).make();
  const Objective objective = MakeObjective(problem);
  const Certificate& right = CertificateOf(GetParam());
  ASSERT_NO_THROW(CheckCertifies(right, objective));
  EXPECT_EQ(right.descent_directions, 0);
  // The certified model, rounded to doubles, has the certified E.
  const ReferenceProblem<long double> reference(problem.samples, problem.spec, problem.weighting);
  const auto E = static_cast<double>(reference.Value(ToVector<long double>(right.model)));
  const double rounding = 1e-25 * right.measured_energy;
  EXPECT_NEAR(E, right.objective, 1e-11 * right.objective + rounding);
  // It is canonical for the library, too.
  FactorModel canonical = right.model;
  NormalizeScale(objective.coverage(), &canonical);
  const std::vector<bool> all(problem.spec.num_parameters(), true);
  EXPECT_GT(CompareTables(canonical, right.model, all).tables, 11);
}

std::vector<std::string> CaseNames() {
  std::vector<std::string> names;
  for (const StiffCase& stiff_case : StiffCases()) names.push_back(stiff_case.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Cases, Stiff, testing::ValuesIn(CaseNames()), [](const auto& test) {
  std::string name = test.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(Certify, FindsTheAnswerAgain) {
  for (const char* name : {"black", "weight_decades", "one_azimuth"}) {
    const Certificate right = CertificateOf(name), again = Certify(FindStiffCase(name), 0);
    EXPECT_NEAR(again.objective, right.objective,
                1e-12 * right.objective + 1e-27 * right.measured_energy)
        << name;
    EXPECT_EQ(again.rank, right.rank) << name;
  }
}

// Turned data have the turned answer, with the same E.
TEST(Turned, HaveTheTurnedAnswer) {
  for (const auto& [name, original, nodes] : Twins()) {
    const Certificate &turned = CertificateOf(name), &right = CertificateOf(original);
    EXPECT_NEAR(turned.objective / right.objective, 1, 1e-12) << name;
    EXPECT_EQ(turned.undetermined.size(), right.undetermined.size()) << name;
    EXPECT_GT(CompareTables(turned.model, Turned(right.model, nodes), turned.Determined()).tables,
              9)
        << name;
  }
}

TEST(CheckCertifies, RefusesOtherSamples) {
  const StiffProblem problem = FindStiffCase("regular").make();
  EXPECT_THAT(ErrorOf([&] { CheckCertifies(CertificateOf("quantised"), MakeObjective(problem)); }),
              IsError(ErrorKind::kMismatch, {.key = "case", .value = "quantised"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
