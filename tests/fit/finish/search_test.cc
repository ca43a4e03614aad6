#include "fit/finish/search.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/model/model_spec.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Scores in the order of the candidates.
class Scores {
 public:
  explicit Scores(std::vector<double> scores) : scores_(std::move(scores)) {}
  double operator()(const FactorModel& /*model*/) { return scores_.at(next_++); }

 private:
  std::vector<double> scores_;
  size_t next_ = 0;
};

// The number of the candidate that is taken in the end.
int ChosenOf(const std::vector<double>& scores, const Search::Rules& rules,
             const std::vector<int>& parameters = {}) {
  const FactorModel model(ModelSpec::SharedFactors(1));
  Search search(Scores(scores), rules);
  for (size_t k = 0; k < scores.size(); ++k) {
    search.Try(std::to_string(k), model, parameters.empty() ? 1 : parameters[k], 0);
    if (search.LastLeads()) search.TakeLast();
  }
  return search.chosen();
}

TEST(Search, TheBestWithinTheBudgetLeads) {
  EXPECT_EQ(ChosenOf({1, 3, 2}, {}), 1);
  EXPECT_EQ(ChosenOf({3, 3, 3}, {}), 0);  // the first of equals
  EXPECT_EQ(ChosenOf({1, 3, 2}, {.max_parameters = 10}, {9, 11, 10}), 2);
  EXPECT_EQ(ChosenOf({5, 1}, {.max_parameters = 10}, {11, 9}), 1);  // the first was too large
  EXPECT_EQ(ChosenOf({5, 1}, {.max_parameters = 8}, {11, 9}), -1);
}

TEST(Search, ANeededLeadDecides) {
  EXPECT_EQ(ChosenOf({1, 1.4, 1.6}, {.over_first = 0.5}), 2);
  EXPECT_EQ(ChosenOf({1, 1.6, 1.7}, {.over_first = 0.5}), 2);
  EXPECT_EQ(ChosenOf({1, 1.6, 1.7}, {.over_leader = 0.5}), 1);
}

TEST(Search, NoNumberRanksBelowAll) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ChosenOf({nan, -1e9, nan}, {}), 1);
  EXPECT_EQ(ChosenOf({1, nan}, {}), 0);
}

TEST(Search, BadArgumentsAreErrors) {
  EXPECT_THROW(Search(nullptr, {}), Error);
  EXPECT_THROW(Search(Scores({}), {.max_parameters = 0}), Error);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
