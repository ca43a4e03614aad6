#include "io/pictures/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "tests/error_of.h"
#include "tests/test_directory.h"

// Another decoder of PNG than the encoder's own.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::StartsWith;

std::string Header(int width, int height) {
  return "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y " +
         std::to_string(height) + " +X " + std::to_string(width) + "\n";
}

std::string Bytes(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

// 4 x 2, not packed.
std::string Flat() {
  std::string bytes = Header(4, 2);
  for (int k = 0; k < 8; ++k) bytes += Bytes({128 + k, 10 * k, 200, 128 + k});
  return bytes;
}

// 16 x 8, each row by runs and dumps: red and the exponent are constant, green is a dump, blue
// both.
std::string Packed() {
  std::string bytes = Header(16, 8);
  for (int row = 0; row < 8; ++row) {
    bytes += Bytes({2, 2, 0, 16});
    bytes += Bytes({128 + 16, 100 + row});
    bytes += Bytes({16});
    for (int column = 0; column < 16; ++column) bytes += Bytes({column});
    bytes += Bytes({128 + 5, 9, 1, 7, 128 + 10, 3});
    bytes += Bytes({128 + 16, 129});
  }
  return bytes;
}

std::optional<Error> ErrorOfProbe(const std::string& bytes) {
  return ErrorOf([&] { ParseProbe(bytes, "probe.hdr"); });
}

TEST(ProbeTest, ReadsAPictureThatIsNotPacked) {
  const Environment probe = ParseProbe(Flat(), "probe.hdr");
  EXPECT_EQ(probe.name, "probe.hdr");
  EXPECT_EQ(probe.width, 4);
  EXPECT_EQ(probe.height, 2);
  ASSERT_EQ(probe.radiance.size(), 8U);
  for (int k = 0; k < 8; ++k) {
    const double unit = std::exp2(k - 8);  // 2^(exponent - 128) / 256
    EXPECT_EQ(probe.radiance[k], (Rgb{(128 + k) * unit, 10 * k * unit, 200 * unit})) << k;
  }
}

TEST(ProbeTest, ReadsAPackedPicture) {
  const Environment probe = ParseProbe(Packed(), "probe.hdr");
  ASSERT_EQ(probe.radiance.size(), 128U);
  for (int k = 0; k < 128; ++k) {
    const int row = k / 16, column = k % 16, blue = column < 5 ? 9 : column < 6 ? 7 : 3;
    const double unit = 2.0 / 256;
    EXPECT_EQ(probe.radiance[k], (Rgb{(100 + row) * unit, column * unit, blue * unit})) << k;
  }
}

// Wide pictures may hold rows that are not packed.
TEST(ProbeTest, ReadsRowsOfBothKinds) {
  std::string bytes = Header(16, 8);
  const std::string packed = Packed().substr(Header(16, 8).size());
  const size_t row = packed.size() / 8;
  for (int k = 0; k < 16; ++k) bytes += Bytes({200, 100, 50, 130});
  bytes += packed.substr(row);
  const Environment probe = ParseProbe(bytes, "probe.hdr");
  EXPECT_EQ(probe.radiance[15], (Rgb{200.0 / 64, 100.0 / 64, 50.0 / 64}));
  EXPECT_EQ(probe.radiance[16][0], 101 * 2.0 / 256);
}

TEST(ProbeTest, TheLargestAndTheSmallestNumbersAreFinite) {
  std::string bytes = Header(4, 2) + Bytes({255, 255, 255, 255}) + Bytes({255, 255, 255, 0});
  for (int k = 2; k < 8; ++k) bytes += Bytes({128, 0, 0, 1});
  const Environment probe = ParseProbe(bytes, "probe.hdr");
  EXPECT_EQ(probe.radiance[0][1], std::ldexp(255.0, 255 - 136));
  EXPECT_EQ(probe.radiance[1], Rgb{});
  EXPECT_EQ(probe.radiance[2][0], std::ldexp(128.0, 1 - 136));
}

// At every byte: an error, and one that tells.
TEST(ProbeTest, ACutFileIsAnError) {
  for (const std::string& whole : {Flat(), Packed()}) {
    for (size_t size = 0; size < whole.size(); ++size) {
      const auto message = ErrorOfProbe(whole.substr(0, size));
      ASSERT_THAT(
          message,
          testing::AnyOf(IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "bytes"}),
                         IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "content"})))
          << size;
    }
    ParseProbe(whole + "more", "probe.hdr");
  }
}

TEST(ProbeTest, WhatIsNoProbeIsAnError) {
  for (const std::string& bytes :
       {std::string(), std::string("#?"), std::string("PNG"), std::string("#?RADIANCE\n\n"),
        std::string("#?RADIANCE\n\n-Y 2 +X 4\n") + std::string(32, '\x80'),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 4\n") + std::string(32, '\x80'),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+Y 2 +X 4\n") + std::string(32, '\x80'),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999999 +X 4\n"),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n\n")}) {
    EXPECT_THAT(ErrorOfProbe(bytes),
                IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "content"}))
        << bytes;
  }
}

TEST(ProbeTest, OtherShapesAreErrors) {
  for (const auto& [width, height] :
       {std::pair(4, 4), std::pair(4, 3), std::pair(2, 1), std::pair(5, 2), std::pair(0, 0),
        std::pair(-4, -2), std::pair(200000, 100000), std::pair(2147483646, 1073741823),
        std::pair(8194, 4097)}) {
    EXPECT_THAT(ErrorOfProbe(Header(width, height) + std::string(64, '\x80')),
                IsError(ErrorKind::kRange,
                        {.file = "probe.hdr",
                         .key = "pixels",
                         .value = std::to_string(width) + " x " + std::to_string(height)}));
  }
}

// A header is soon written; the pixels are not made before they can be there.
TEST(ProbeTest, AHugeHeaderWithoutPixelsIsAnError) {
  EXPECT_THAT(ErrorOfProbe(Header(8192, 4096) + Bytes({2, 2, 32, 0})),
              IsError(ErrorKind::kFormat, {.key = "bytes"}));
}

TEST(ProbeTest, BrokenRowsAreErrors) {
  const size_t at = Header(16, 8).size();
  const auto with = [&](size_t offset, int value) {
    std::string bytes = Packed();
    bytes[at + offset] = static_cast<char>(value);
    return ErrorOfProbe(bytes);
  };
  EXPECT_THAT(with(3, 17),
              IsError(ErrorKind::kMismatch, {.file = "probe.hdr", .key = "width", .value = "0"}));
  EXPECT_THAT(with(4, 128 + 17),
              IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "runs", .value = "0"}));
  EXPECT_THAT(with(4, 0),
              IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "runs", .value = "0"}));
  EXPECT_THAT(with(4, 17),
              IsError(ErrorKind::kFormat, {.file = "probe.hdr", .key = "runs", .value = "0"}));
  std::string old = Flat();
  old.replace(Header(4, 2).size() + 4, 4, Bytes({1, 1, 1, 3}));
  EXPECT_THAT(ErrorOfProbe(old),
              IsError(ErrorKind::kUnsupported, {.key = "packing", .value = "0"}));
}

TEST(ProbeTest, ABlackProbeIsAnError) {
  EXPECT_THAT(ErrorOfProbe(Header(4, 2) + std::string(32, '\0')),
              IsError(ErrorKind::kData, {.file = "probe.hdr", .key = "radiance", .value = "0"}));
}

TEST(ProbeTest, ReadsAFile) {
  const TestDirectory directory;
  const std::string path = directory.Make("probe.hdr", Flat());
  const Environment probe = ReadProbe(path);
  EXPECT_EQ(probe.name, path);
  EXPECT_EQ(probe.radiance, ParseProbe(Flat(), "x").radiance);
  EXPECT_THAT(ErrorOf([&] { ReadProbe(directory.Path("missing.hdr")); }),
              IsError(ErrorKind::kFile, {.file = directory.Path("missing.hdr"),
                                         .key = "read",
                                         .value = "No such file or directory"}));
}

TEST(WritePngTest, AnotherDecoderReadsItBack) {
  const TestDirectory directory;
  std::string pixels;
  for (int k = 0; k < 31 * 17 * 3; ++k) pixels += static_cast<char>(k * k % 251);
  WritePng(directory.Path("a.png"), 31, 17, pixels);
  EXPECT_EQ(directory.Names(), std::vector<std::string>{"a.png"});
  const std::string bytes = TestDirectory::Content(directory.Path("a.png"));
  EXPECT_THAT(bytes, StartsWith("\x89PNG\r\n\x1a\n"));
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> read(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                            static_cast<int>(bytes.size()), &width, &height, &channels, 0),
      stbi_image_free);
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(width, 31);
  EXPECT_EQ(height, 17);
  ASSERT_EQ(channels, 3);
  EXPECT_TRUE(std::string(reinterpret_cast<const char*>(read.get()), pixels.size()) == pixels);
}

TEST(WritePngTest, NoFolderIsAnError) {
  EXPECT_THAT(ErrorOf([] { WritePng("/nonexistent/folder/a.png", 1, 1, "rgb"); }),
              IsError(ErrorKind::kFile,
                      {.key = "write",
                       .value = "there is no folder '/nonexistent/folder'; make it first"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
