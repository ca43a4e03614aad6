#include "core/base/file_names.h"

#include <gtest/gtest.h>

#include <string>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(FileNameOf, IsTheLastPart) {
  EXPECT_EQ(FileNameOf("/a/b c/paint.bsdf"), "paint.bsdf");
  EXPECT_EQ(FileNameOf("paint.bsdf"), "paint.bsdf");
  EXPECT_EQ(FileNameOf("synth:copper@30x30x60"), "synth:copper@30x30x60");
  EXPECT_EQ(FileNameOf(""), "");
}

TEST(WithoutFolders, LeavesTheNamesOfFiles) {
  const std::string message = "cannot read '/home/ann/a b/x.csv': it is beside '/home/ann/y.csv'";
  EXPECT_EQ(WithoutFolders(message, {"/home/ann/a b", "/home/ann/"}),
            "cannot read 'x.csv': it is beside 'y.csv'");
  EXPECT_EQ(WithoutFolders("data/x.csv: no data/ of olddata/x", {"data"}),
            "x.csv: no  of olddata/x");
  EXPECT_EQ(WithoutFolders("/x and a/b", {"", "/"}), "/x and a/b");
  // Messages show names with escaped control characters.
  EXPECT_EQ(WithoutFolders("/a\\nb/x: bad", {"/a\nb"}), "x: bad");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
