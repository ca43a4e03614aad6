#include "trilobe/io/trace_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/io/test_directory.h"

namespace trilobe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::string kHeader = "iteration,seconds,objective,filtered\n";

std::string ParseError(const std::string& text) {
  return ErrorOf([&] { ParseTrace(text, "trace.csv"); });
}

TEST(TraceFile, IsPlainCsv) {
  const std::vector<IterationRecord> records = {{0, 0, 12.5, false}, {1, 0.25, 1e-300, true}};
  EXPECT_EQ(FormatTrace(records), kHeader + "0,0,12.5,0\n1,0.25,1e-300,1\n");
  EXPECT_EQ(FormatTrace({}), kHeader);
}

TEST(TraceFile, ReadsBackTheSameBits) {
  using Limits = std::numeric_limits<double>;
  const std::vector<IterationRecord> records = {
      {0, 0.1, 1.0 / 3, false},
      {1, 0.1 + 0.2, Limits::max(), true},
      {std::numeric_limits<int>::max(), Limits::denorm_min(), Limits::min(), false},
      {4, 12345678.901234567, 0x1.fffffffffffffp-2, true}};
  const TestDirectory directory;
  WriteTrace(directory.Path("trace.csv"), records);
  EXPECT_EQ(ReadTrace(directory.Path("trace.csv")), records);
}

TEST(TraceFile, AcceptsWhatASpreadsheetSaves) {
  EXPECT_EQ(ParseTrace("iteration,seconds,objective,filtered\r\n1,2,3,1\r\n", ""),
            (std::vector<IterationRecord>{{1, 2, 3, true}}));
  EXPECT_EQ(ParseTrace(kHeader + "1,2,3,0", ""), (std::vector<IterationRecord>{{1, 2, 3, false}}));
  EXPECT_THAT(ParseTrace(kHeader, ""), IsEmpty());
}

TEST(TraceFile, ErrorsNameTheLine) {
  EXPECT_THAT(ParseError(""), HasSubstr("trace.csv: line 1: not a trace"));
  EXPECT_THAT(ParseError("1,2,3,0\n"), HasSubstr("line 1"));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0\nx,0,1,0\n"), HasSubstr("line 3: iteration"));
  EXPECT_THAT(ParseError(kHeader + "\n0,0,1,0\n"), HasSubstr("line 2: iteration"));
  EXPECT_THAT(ParseError(kHeader + "0,,1,0\n"), HasSubstr("line 2: seconds"));
  EXPECT_THAT(ParseError(kHeader + "0,0\n"), HasSubstr("line 2: objective"));
  EXPECT_THAT(ParseError(kHeader + "0,0,1\n"), HasSubstr("line 2: filtered"));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,2\n"), HasSubstr("line 2: filtered"));
  EXPECT_THAT(ParseError(kHeader + "0,0,1,0,9\n"), HasSubstr("line 2: more than 4"));
}

TEST(TraceFile, RefusesNumbersThatAreNone) {
  for (const char* number : {"nan", "inf", "-1", "1e999", "0x10", "1.5.2", " 1", "1 ", "1;"}) {
    EXPECT_THAT(ParseError(kHeader + "0,0," + number + ",0\n"), HasSubstr("line 2: objective"))
        << number;
  }
  EXPECT_THAT(ParseError(kHeader + "99999999999,0,1,0\n"), HasSubstr("line 2: iteration"));
  EXPECT_THAT(ParseError(kHeader + "1.5,0,1,0\n"), HasSubstr("line 2: iteration"));
}

}  // namespace
}  // namespace trilobe
