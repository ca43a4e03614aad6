#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiments/limits/compare_forms.h"
#include "tests/error_of.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A measurement, and a fit of one lobe to it.
struct Fitted {
  Measurement measured = LoadMeasurement("synth:foam@16x15x24");
  FitProblem problem =
      ProblemFor(measured, {.compare = false}, ModelSpec::SharedFactors(1, measured.table->grid));
  FactorModel model{problem.data.spec()};

  Fitted() {
    model = FindInitialModel("roughness").make(problem.data, /*seed=*/1);
    MakeSolver("awls")->Solve(problem.data, {.max_iterations = 5}, &model);
  }
};

TEST(CompareForms, MoreNumbersFitNoWorse) {
  const Fitted fitted;
  std::vector<std::string> seen;
  const std::vector<FormFit> forms =
      CompareForms(fitted.problem, TermModel::Of(fitted.model),
                   {.forms = {"diffuse_table", "retro"},
                    .on_form = [&](const FormFit& form) { seen.push_back(form.form); }});
  ASSERT_EQ(forms.size(), 3u);
  EXPECT_THAT(seen, testing::ElementsAre("paper", "diffuse_table", "retro"));
  EXPECT_LT(forms[1].objective, 1.01 * forms[0].objective);
  EXPECT_EQ(forms[1].model.num_parameters(), forms[0].model.num_parameters() + 12);
  EXPECT_EQ(forms[2].model.spec().terms.back().name, "retroreflection");
}

TEST(CompareForms, WhatCannotBeIsSaid) {
  const Fitted fitted;
  const auto error_of = [&](const std::string& form) {
    return ErrorOf(
        [&] { CompareForms(fitted.problem, TermModel::Of(fitted.model), {.forms = {form}}); });
  };
  EXPECT_THAT(error_of("harmonic"),
              IsError(ErrorKind::kUnknown, {.key = "form", .value = "harmonic"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
