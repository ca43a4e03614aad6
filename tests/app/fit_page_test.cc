// The page of many fits.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/app/run_program.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// It can be sent around, however many fits there are.
TEST(FitPage, HoldsTheModelsOfAFewFits) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(RunProgram({"fit", "synth:felt@30x30x60", "synth:foam@30x30x60", "--out=" + out,
                        "--solver=awls", "--max_iterations=1", "--lobes=1", "--nodiagnose"})
                .status,
            0);
  const auto page = [&] {
    EXPECT_EQ(RunProgram({"view", out}).status, 0);
    return Contents(out + "/index.html");
  };
  EXPECT_THAT(page(), HasSubstr("\"kind\""));
  for (int k = 0; k < 199; ++k) {
    std::filesystem::copy(out + "/felt", out + "/felt" + std::to_string(k));
  }
  const std::string many = page();
  EXPECT_THAT(many, HasSubstr("<h1>201 of 201"));
  EXPECT_THAT(many, Not(HasSubstr("\"kind\"")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
