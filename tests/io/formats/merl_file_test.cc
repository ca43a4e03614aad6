#include "io/formats/databases/merl_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

constexpr size_t kBins = 1458000;
constexpr size_t kFileSize = 12 + 3 * 8 * kBins;

std::string Header(int32_t a, int32_t b, int32_t c) {
  const std::array<int32_t, 3> dimensions = {a, b, c};
  std::string bytes(12, '\0');
  std::memcpy(bytes.data(), dimensions.data(), 12);
  return bytes;
}

// A whole file with the same number everywhere.
std::string FileOf(double value) {
  const std::vector<double> numbers(3 * kBins, value);
  return Header(90, 90, 180) +
         std::string(reinterpret_cast<const char*>(numbers.data()), 8 * numbers.size());
}

void SetNumber(size_t index, uint64_t bits, std::string* bytes) {
  std::memcpy(bytes->data() + 12 + 8 * index, &bits, 8);
}

std::optional<Error> ParseError(const std::string& bytes) {
  return ErrorOf([&] { ParseMerl(bytes, "chrome.binary"); });
}

TEST(MerlFile, PutsPlanesAndBinsWhereTheFormatSays) {
  std::string bytes = FileOf(-1);
  const int h = 3, d = 50, p = 170;  // index = phi_d + 180 (theta_d + 90 theta_h)
  const size_t bin = 170 + 180 * (50 + 90 * 3);
  for (size_t plane = 0; plane < 3; ++plane) {
    SetNumber(plane * kBins + bin, std::bit_cast<uint64_t>(1500.0 * static_cast<double>(plane + 1)),
              &bytes);
  }
  const BrdfTable table = ParseMerl(bytes, "chrome.binary");
  EXPECT_EQ(table.source, "chrome.binary");
  EXPECT_EQ(table.grid, MerlGrid());
  const int index = table.grid.Index(h, d, p);
  EXPECT_DOUBLE_EQ(table.Value(0, index), 1);
  EXPECT_DOUBLE_EQ(table.Value(1, index), 2 * 1.15);
  EXPECT_DOUBLE_EQ(table.Value(2, index), 3 * 1.66);
  EXPECT_LT(table.Value(0, index + 1), 0);
}

constexpr MerlGrid kSmall{.theta_h = 5, .theta_d = 4, .phi_d = 8};

// A file of this grid; the value of a channel and a bin is that of `value`.
template <typename Number, typename Value>
std::string SmallFile(const MerlGrid& grid, const Value& value) {
  std::string bytes = Header(grid.theta_h, grid.theta_d, grid.phi_d);
  for (int c = 0; c < 3; ++c) {
    for (int bin = 0; bin < grid.size(); ++bin) {
      const auto number = static_cast<Number>(value(c, bin));
      bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
    }
  }
  return bytes;
}

double Counted(int channel, int bin) { return 1000 * channel + bin % 97 + 0.5; }

void ReverseNumbers(size_t begin, size_t size, std::string* bytes) {
  for (size_t at = begin; at < bytes->size(); at += size) {
    std::reverse(bytes->begin() + static_cast<std::ptrdiff_t>(at),
                 bytes->begin() + static_cast<std::ptrdiff_t>(at + size));
  }
}

TEST(MerlFile, ReadsTheBinsThatTheHeaderSays) {
  const std::string bytes = SmallFile<double>(kSmall, Counted);
  const Measurement measurement = Source("tiny", bytes).Read();
  ASSERT_TRUE(measurement.table);
  EXPECT_EQ(measurement.table->grid, kSmall);
  EXPECT_EQ(measurement.table->stored[1][7], Counted(1, 7));
  EXPECT_THAT(measurement.notes, testing::Contains("read as: 5 x 4 x 8 bins"));
  EXPECT_THAT(ParseError(bytes + "x"),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "5 x 4 x 8"}));
}

TEST(MerlFile, ReadsSmallNumbersAndThoseOfOtherMachines) {
  const BrdfTable usual = ParseMerl(SmallFile<double>(kSmall, Counted), "tiny");
  std::string bytes = SmallFile<float>(kSmall, Counted);
  EXPECT_EQ(ParseMerl(bytes, "tiny").stored, usual.stored);
  ReverseNumbers(0, 4, &bytes);
  EXPECT_EQ(ParseMerl(bytes, "tiny").stored, usual.stored);
  EXPECT_THAT(Source("tiny", bytes).Read().notes,
              testing::Contains("read as: 5 x 4 x 8 bins, float32, big-endian numbers"));
  bytes = SmallFile<double>(kSmall, Counted);
  ReverseNumbers(0, 4, &bytes);  // swaps halves of the float64, too
  for (size_t at = 12; at < bytes.size(); at += 8) {
    std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + 4),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + 4));
  }
  EXPECT_EQ(ParseMerl(bytes, "tiny").stored, usual.stored);
}

TEST(MerlFile, FoldsAFullCircleOfPhiD) {
  MerlGrid round = kSmall;
  round.phi_d *= 2;
  const auto at_half = [&](int c, int bin) {
    const int row = bin / round.phi_d, p = bin % round.phi_d % kSmall.phi_d;
    return Counted(c, kSmall.phi_d * row + p);
  };
  const auto unlike = [&](int c, int bin) {  // the exchanged one is 0.2 brighter
    return at_half(c, bin) + (bin % round.phi_d < kSmall.phi_d ? 0 : 0.2);
  };
  const BrdfTable half = ParseMerl(SmallFile<double>(kSmall, Counted), "tiny");
  EXPECT_EQ(ParseMerl(SmallFile<double>(round, at_half), "tiny").stored, half.stored);
  const BrdfTable mean = ParseMerl(SmallFile<double>(round, unlike), "tiny");
  EXPECT_EQ(mean.grid, kSmall);
  EXPECT_NEAR(mean.stored[2][17], half.stored[2][17] + 0.1, 1e-12);
  // Finer bins of half a circle are no full one.
  const auto finer = [&](int c, int bin) { return at_half(c, bin) + 40 * (bin % round.phi_d); };
  EXPECT_EQ(ParseMerl(SmallFile<double>(round, finer), "tiny").grid, round);
}

TEST(MerlFile, KeepsEveryBit) {
  std::string bytes = FileOf(-1);
  const std::vector<uint64_t> patterns = {
      0x7ff8000000001234,  // quiet NaN with a payload
      0xfff0000000000001,  // signalling NaN
      0x7ff0000000000000,  // infinity
      0xfff0000000000000,  // -infinity
      0x8000000000000000,  // -0
      0x0000000000000001,  // the smallest number
      0x7fefffffffffffff,  // the largest
      0x3ff0000000000001,
  };
  for (size_t k = 0; k < patterns.size(); ++k) SetNumber(k * 540001, patterns[k], &bytes);
  const TestDirectory directory;
  const std::string path = directory.Make("in.binary", bytes);
  const std::string copy = directory.Path("out.binary");
  WriteMerl(ReadMerl(path), copy);
  EXPECT_TRUE(TestDirectory::Content(copy) == bytes);
  EXPECT_THAT(directory.Names(), ElementsAre("in.binary", "out.binary"));
}

TEST(MerlFile, RefusesAnotherGridOnWriting) {
  const TestDirectory directory;
  const BrdfTable table = MakeInvalidTable("small", {.theta_h = 8, .theta_d = 9, .phi_d = 10});
  EXPECT_THAT(
      ErrorOf([&] { WriteMerl(table, directory.Path("out.binary")); }),
      IsError(ErrorKind::kMismatch,
              {.file = directory.Path("out.binary"), .key = "bins", .value = "8 x 9 x 10"}));
  EXPECT_THAT(directory.Names(), testing::IsEmpty());
}

TEST(MerlFile, RefusesWrongLengths) {
  EXPECT_THAT(ParseError(""),
              IsError(ErrorKind::kFormat, {.file = "chrome.binary", .key = "bytes", .value = "0"}));
  EXPECT_THAT(ParseError(Header(90, 90, 180).substr(0, 11)),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "11"}));
  EXPECT_THAT(ParseError(Header(90, 90, 180)),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "12"}));
  std::string bytes = FileOf(0);
  ASSERT_EQ(bytes.size(), kFileSize);
  bytes += "xyz";
  EXPECT_THAT(ParseError(bytes),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "34992015"}));
  bytes.resize(kFileSize - 1);
  EXPECT_THAT(ParseError(bytes),
              IsError(ErrorKind::kFormat, {.key = "bytes", .value = "34992011"}));
}

TEST(MerlFile, RefusesOtherDimensions) {
  const std::string body(24, '\0');
  EXPECT_THAT(ParseError(Header(90, 90, 360) + body),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "90 x 90 x 360"}));
  EXPECT_THAT(ParseError(Header(1, 2, 3) + std::string(144, '\0')),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "1 x 2 x 3"}));
  EXPECT_THAT(ParseError(Header(0, 0, 0)),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "0 x 0 x 0"}));
  EXPECT_THAT(ParseError(Header(-90, -90, 180) + body),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "-90 x -90 x 180"}));
  // Products far past the file, past 2^32 and past 2^64.
  constexpr int32_t kMax = std::numeric_limits<int32_t>::max();
  EXPECT_THAT(ParseError(Header(180, 90, 90) + body),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "180 x 90 x 90"}));
  EXPECT_THAT(ParseError(Header(65536, 65536, 1) + body),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "65536 x 65536 x 1"}));
  EXPECT_THAT(ParseError(Header(kMax, kMax, kMax) + body),
              IsError(ErrorKind::kFormat,
                      {.key = "bins", .value = "2147483647 x 2147483647 x 2147483647"}));
  // The right number of bins does not make the right dimensions.
  EXPECT_THAT(ParseError(Header(180, 90, 90) + FileOf(0).substr(12)),
              IsError(ErrorKind::kFormat, {.key = "bins", .value = "180 x 90 x 90"}));
}

TEST(MerlFile, RecognisesText) {
  EXPECT_THAT(ParseError("{\"format\": \"trilobe-model\"}"),
              IsError(ErrorKind::kFormat, {.key = "content", .value = "a JSON file"}));
  EXPECT_THAT(ParseError("hi\n"), IsError(ErrorKind::kFormat, {.key = "content", .value = "text"}));
  EXPECT_THAT(ParseError(std::string(kFileSize, 'x')),
              IsError(ErrorKind::kFormat, {.key = "content", .value = "text"}));
}

TEST(MerlFile, NonFiniteAndNegativeBinsAreJustInvalid) {
  std::string bytes = FileOf(300);
  const BrdfTable clean = ParseMerl(bytes, "clean");
  const int valid = ValidSamples(clean).size();
  EXPECT_EQ(valid, 1096216);  // all with both directions above the surface
  const size_t bin = clean.grid.Index(10, 10, 90);
  SetNumber(bin, std::bit_cast<uint64_t>(std::numeric_limits<double>::quiet_NaN()), &bytes);
  SetNumber(kBins + bin + 1, std::bit_cast<uint64_t>(std::numeric_limits<double>::infinity()),
            &bytes);
  SetNumber(2 * kBins + bin + 2, std::bit_cast<uint64_t>(-0.5), &bytes);
  SetNumber(bin + 3, std::bit_cast<uint64_t>(-std::numeric_limits<double>::infinity()), &bytes);
  EXPECT_EQ(ValidSamples(ParseMerl(bytes, "spoilt")).size(), valid - 4);
}

TEST(MerlFile, AFileNeedsOneValidBin) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string bytes = FileOf(nan);
  EXPECT_THAT(ErrorOf([&] { ValidSamples(ParseMerl(bytes, "chrome.binary")); }),
              IsError(ErrorKind::kData, {.file = "chrome.binary", .key = "bins"}));
  const size_t bin = MerlGrid().Index(10, 10, 90);
  for (size_t plane = 0; plane < 3; ++plane) {
    SetNumber(plane * kBins + bin, std::bit_cast<uint64_t>(1.0), &bytes);
  }
  EXPECT_THAT(ValidSamples(ParseMerl(bytes, "one")).bins, ElementsAre(static_cast<int>(bin)));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
