#include "trilobe/io/formats/trace_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_directory.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::IsEmpty;

const std::string kHeader = "iteration,seconds,objective,filtered,accepted,step,optimality\n";

std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { ParseTrace(text, "trace.csv"); });
}

TEST(TraceFile, IsPlainCsv) {
  const std::vector<IterationRecord> records = {{0, 0, 12.5, false},
                                                {1, 0.25, 1e-300, true, false, 0.125, 0.5}};
  EXPECT_EQ(FormatTrace(records), kHeader + "0,0,12.5,0,1,0,\n1,0.25,1e-300,1,0,0.125,0.5\n");
  EXPECT_EQ(FormatTrace({}), kHeader);
}

TEST(TraceFile, ReadsBackTheSameBits) {
  using Limits = std::numeric_limits<double>;
  const std::vector<IterationRecord> records = {
      {0, 0.1, 1.0 / 3, false},
      {1, 0.1 + 0.2, Limits::max(), true, true, 1.0 / 7, 0.0},
      {std::numeric_limits<int>::max(), Limits::denorm_min(), Limits::min(), false, false, 0, 1e-9},
      {4, 12345678.901234567, 0x1.fffffffffffffp-2, true, false, Limits::max(), std::nullopt}};
  const TestDirectory directory;
  WriteTrace(directory.Path("trace.csv"), records);
  EXPECT_EQ(ReadTrace(directory.Path("trace.csv")), records);
}

// With a prior the solver lowers another E than that of the data; both are told.
TEST(TraceFile, OfAFitWithAPriorHasBothObjectives) {
  const std::vector<IterationRecord> records = {
      {.iteration = 0, .objective = 9, .objective_with_prior = 12},
      {.iteration = 1,
       .objective = 9.5,
       .step = 0.5,
       .optimality = 0.1,
       .objective_with_prior = 11}};
  const std::string with_prior_header =
      kHeader.substr(0, kHeader.size() - 1) + ",objective_with_prior\n";
  EXPECT_EQ(FormatTrace(records), with_prior_header + "0,0,9,0,1,0,,12\n1,0,9.5,0,1,0.5,0.1,11\n");
  EXPECT_EQ(ParseTrace(FormatTrace(records), ""), records);
  const std::string former_header = kHeader.substr(0, kHeader.size() - 1) + ",guided_objective\n";
  EXPECT_EQ(ParseTrace(former_header + "0,0,9,0,1,0,,12\n", "").front(), records.front());
  EXPECT_THAT(ParseError(with_prior_header + "0,0,9,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "columns", .value = "7"}));
  EXPECT_THAT(ParseError(with_prior_header + "0,0,9,0,1,0,,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "objective_with_prior"}));
}

TEST(TraceFile, TellsProcessorSecondsWhereTheyAreKnown) {
  const std::vector<IterationRecord> records = {
      {.iteration = 0, .objective = 9, .processor_seconds = 0.5, .objective_with_prior = 12}};
  EXPECT_EQ(FormatTrace(records), kHeader.substr(0, kHeader.size() - 1) +
                                      ",processor_seconds,objective_with_prior\n"
                                      "0,0,9,0,1,0,,0.5,12\n");
  EXPECT_EQ(ParseTrace(FormatTrace(records), ""), records);
}

TEST(TraceFile, AcceptsWhatASpreadsheetSaves) {
  std::string text = kHeader + "1,2,3,1,0,4,\n";
  for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, "\r");
  }
  EXPECT_EQ(ParseTrace(text, ""),
            (std::vector<IterationRecord>{{1, 2, 3, true, false, 4, std::nullopt}}));
  EXPECT_EQ(ParseTrace(kHeader + "1,2,3,0,1,4,5", ""),  // no newline at the end
            (std::vector<IterationRecord>{{1, 2, 3, false, true, 4, 5}}));
  EXPECT_THAT(ParseTrace(kHeader, ""), IsEmpty());
}

TEST(TraceFile, ErrorsNameTheLine) {
  EXPECT_THAT(ParseError(""),
              IsError(ErrorKind::kFormat, {.file = "trace.csv", .line = 1, .key = "header"}));
  EXPECT_THAT(ParseError("1,2,3,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 1, .key = "header"}));
  EXPECT_THAT(ParseError("iteration,seconds,objective,filtered\n"),
              IsError(ErrorKind::kFormat, {.line = 1, .key = "header"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,0,\nx,0,1,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 3, .key = "iteration", .value = "x"}));
  EXPECT_THAT(ParseError(kHeader + "\n0,0,1,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "columns", .value = "1"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,0\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "columns", .value = "6"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,0,,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "columns", .value = "8"}));
  EXPECT_THAT(ParseError(kHeader + "0,,1,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "seconds"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,2,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "filtered", .value = "2"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "accepted"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,01,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "accepted", .value = "01"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "step"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,0,x\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "optimality", .value = "x"}));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,1,0,-1\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "optimality", .value = "-1"}));
}

TEST(TraceFile, RefusesNumbersThatAreNone) {
  for (const char* number : {"nan", "inf", "-1", "1e999", "0x10", "1.5.2", " 1", "1 ", "1;"}) {
    EXPECT_THAT(ParseError(kHeader + "0,0," + number + ",0,1,0,\n"),
                IsError(ErrorKind::kFormat, {.line = 2, .key = "objective", .value = number}))
        << number;
  }
  EXPECT_THAT(ParseError(kHeader + "99999999999,0,1,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "iteration", .value = "99999999999"}));
  EXPECT_THAT(ParseError(kHeader + "1.5,0,1,0,1,0,\n"),
              IsError(ErrorKind::kFormat, {.line = 2, .key = "iteration", .value = "1.5"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
