#include "trilobe/solvers/solver_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// All values of all options, in their order.
std::vector<OptionValue> Values(const SolverOptions& options) {
  std::vector<OptionValue> values;
  for (const SolverOption& option : AllSolverOptions()) values.push_back(option.get(options));
  return values;
}

// Another value than the default, in the range.
OptionValue OtherValue(const SolverOption& option) {
  const OptionValue value = option.get({});
  if (const auto* const choice = std::get_if<std::string>(&value)) {
    return *choice == "active_set" ? "bounds" : *choice == "auto" ? "cgnr" : "dogleg";
  }
  return std::visit(
      [](const auto& of_type) -> OptionValue {
        using T = std::decay_t<decltype(of_type)>;
        if constexpr (std::is_same_v<T, bool>) {
          return !of_type;
        } else if constexpr (std::is_same_v<T, std::string>) {
          return of_type;
        } else {
          return static_cast<T>(7);
        }
      },
      value);
}

TEST(SolverOptions, EachIsItsMemberAndNoOther) {
  const std::vector<SolverOption>& all = AllSolverOptions();
  const std::vector<OptionValue> defaults = Values({});
  for (size_t k = 0; k < all.size(); ++k) {
    const OptionValue other = OtherValue(all[k]);
    ASSERT_NE(other, defaults[k]) << all[k].name;
    SolverOptions options;
    all[k].set(other, &options);
    EXPECT_NO_THROW(CheckSolverOptions(options)) << all[k].name;
    std::vector<OptionValue> expected = defaults;
    expected[k] = other;
    EXPECT_EQ(Values(options), expected) << all[k].name;
  }
}

TEST(SolverOptions, HaveNamesAndFlagsOfTheirOwn) {
  std::set<std::string> names, flags;
  for (const SolverOption& option : AllSolverOptions()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_TRUE(flags.insert(option.flag).second) << option.flag;
    EXPECT_EQ(&FindSolverOption(option.name), &option);
  }
  EXPECT_THAT(ErrorOf([] { FindSolverOption("x"); }),
              IsError(ErrorKind::kUnknown, {.key = "option of solvers", .value = "x"}));
}

// Flags in another unit begin at the member's default, too.
TEST(SolverOptions, FlagsStandForTheDefaults) {
  const ModelSpec spec = ModelSpec::SharedFactors(1);
  int units = 0;
  for (const SolverOption& option : AllSolverOptions()) {
    if (!option.unit) continue;
    ++units;
    const double flag = option.unit->default_value;
    EXPECT_NO_THROW(CheckInRange(option.flag, flag, option.unit->range));
    const bool same = option.unit->to_member == nullptr;
    EXPECT_EQ(OptionValue(same ? flag : option.unit->to_member(flag, spec)), option.get({}))
        << option.name;
  }
  EXPECT_GT(units, 0);
}

TEST(SolverOptions, ChoicesAreKnownByName) {
  SolverOptions options;
  FindSolverOption("positivity").set("bounds", &options);
  EXPECT_EQ(options.positivity, Positivity::kBounds);
  EXPECT_STREQ(PositivityName(options.positivity), "bounds");
  EXPECT_STREQ(TrustRegionName(TrustRegion::kDogleg), "dogleg");
  EXPECT_EQ(FindSolverOption("positivity").help,
            "how parameters are kept >= 0: active_set or bounds");
  EXPECT_THAT(ErrorOf([&] { FindSolverOption("positivity").set("x", &options); }),
              IsError(ErrorKind::kUnknown, {.key = "positivity", .value = "x"}));
}

TEST(SolverOptions, OutOfRangeNameTheValueAndTheRange) {
  SolverOptions options;
  options.starts = 0;
  EXPECT_THAT(ErrorOf([&] { CheckSolverOptions(options); }),
              IsError(ErrorKind::kRange, {.key = "starts", .value = "0"}));
}

TEST(SolverOptions, OfASolverAreThoseThatItReads) {
  SolverOptions options;
  options.positivity = Positivity::kBounds;
  options.seed = 0xffffffffffffffff;
  const std::vector<std::string> particular = {"seed", "positivity"};
  std::vector<std::string> texts;
  for (const SolverOption* option : OptionsReadBy(particular)) {
    texts.push_back(option->name + "=" + ToText(option->get(options)));
  }
  EXPECT_THAT(texts, testing::ElementsAre("max_iterations=100", "max_seconds=inf",
                                          "relative_decrease_tolerance=1e-05",
                                          "optimality_tolerance=1e-10", "diagnose=true",
                                          "positivity=bounds", "seed=18446744073709551615"));
}

TEST(SolverOptions, AreThereWhereASolverNamesThem) {
  for (const SolverEntry& entry : Solvers()) {
    for (const std::string& name : entry.options) {
      EXPECT_FALSE(FindSolverOption(name).common) << entry.name << ", " << name;
    }
  }
  SolverEntry entry = FindSolver("awls");
  entry.name = "own";
  entry.options = {"x"};
  EXPECT_THAT(ErrorOf([&] { RegisterSolver(entry); }),
              IsError(ErrorKind::kUnknown, {.key = "option of solvers", .value = "x"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
