#include "fit/choose_form.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

const ModelSpec& Default() {
  static const ModelSpec spec = ModelSpec::AnisotropicFor(3, 48, DegreesToRadians(75));
  return spec;
}

std::vector<std::string> Names(const std::vector<FormSpec>& forms) {
  std::vector<std::string> names;
  names.reserve(forms.size());
  for (const FormSpec& form : forms) names.push_back(form.name);
  return names;
}

TEST(AnisotropicForms, SpendAsMuchAsTheDefaultOnOtherThings) {
  const int budget = Default().num_parameters();
  const std::vector<FormSpec> forms = AnisotropicForms(Default(), {6, 48}, budget);
  EXPECT_THAT(Names(forms), ElementsAre("as fitted", "4 lobes", "D by channel"));
  EXPECT_EQ(forms[0].spec, Default());
  EXPECT_EQ(forms[1].spec.lobes, 4);
  EXPECT_TRUE(forms[2].spec.D.per_channel);
  for (const FormSpec& form : forms) {
    EXPECT_LE(form.spec.num_parameters(), budget);
    EXPECT_GT(form.spec.num_parameters(), 0.8 * budget);
    EXPECT_TRUE(form.spec.g_axis.reaches_horizon());
    CheckSpec(form.spec);
  }
}

TEST(AnisotropicForms, KeepToTheBudgetAndToTheData) {
  EXPECT_THAT(Names(AnisotropicForms(Default(), {6, 48}, 4500)),
              ElementsAre("as fitted", "finer nodes", "4 lobes", "D by channel"));
  for (const int budget : {150, 400, 1000, 4500}) {
    for (const FormSpec& form : AnisotropicForms(Default(), {6, 12}, budget)) {
      EXPECT_LE(form.spec.num_parameters(), budget) << form.name;
      if (form.name != "as fitted") {
        EXPECT_LE(form.spec.d_axis.phi_nodes, 12) << form.name;
      }
    }
  }
  EXPECT_THAT(ErrorOf([&] {
                AnisotropicForms(Default(), {6, 48}, 50);
              }),
              IsError(ErrorKind::kRange, {.key = "max_parameters", .value = "50"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
